// The output of a child process, through a pipe that its parent empties.
#include "benchmarks/run/captured_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "core/text.h"

namespace isoline::benchmarks {
namespace {

constexpr std::size_t kTail = 200;  // bytes of the end that are remembered
constexpr int kWidePipe = 1 << 20;  // bytes: who writes much is not held up at each look
constexpr int kMostReads = 64;      // at one look: who never stops writing ends no look

void close_one(int& descriptor) {
  if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

}  // namespace

void CapturedOutput::open() {
  close();
  kept_.clear();
  tail_.clear();
  left_out_ = 0;
  is_widened_ = false;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;  // then the output is lost, and the work is not
  read_end_ = ends[0];
  write_end_ = ends[1];
  fcntl(read_end_, F_SETFL, O_NONBLOCK);
}

void CapturedOutput::redirect() const {
  const int out = write_end_ >= 0 ? write_end_ : ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  static char lines[BUFSIZ];  // written line by line, or a crash would take the last ones with it
  std::setvbuf(stdout, lines, _IOLBF, sizeof lines);
}

void CapturedOutput::close_child_end() { close_one(write_end_); }

void CapturedOutput::drain() {
  if (read_end_ < 0) return;
  std::array<char, 1 << 14> chunk;
  for (int i = 0; i < kMostReads; ++i) {
    const ssize_t got = read(read_end_, chunk.data(), chunk.size());
    if (got <= 0) return;
    if (!is_widened_) is_widened_ = fcntl(read_end_, F_SETPIPE_SZ, kWidePipe) >= 0;
    take(chunk.data(), static_cast<std::size_t>(got));
  }
}

void CapturedOutput::take(const char* bytes, std::size_t count) {
  const std::size_t room = kMost - kept_.size(), kept = std::min(room, count);
  kept_.append(bytes, kept);
  left_out_ += static_cast<std::int64_t>(count - kept);
  tail_.append(bytes, count);
  if (tail_.size() > kTail) tail_.erase(0, tail_.size() - kTail);
}

void CapturedOutput::close() {
  close_one(read_end_);
  close_one(write_end_);
}

std::string CapturedOutput::text() const {
  std::string text = valid_utf8(cut(kept_, left_out_ > 0 ? kMost - 1 : kMost));
  if (left_out_ > 0) text += fmt::format("\n… and {} bytes more\n", left_out_);
  return text;
}

std::string CapturedOutput::last_words() const {
  std::string_view words = tail_;
  const std::size_t end = words.find_last_not_of("\n\r\t ");
  if (end == std::string_view::npos) return "";
  words = words.substr(0, end + 1);
  const std::size_t line = words.find_last_of('\n');
  if (line != std::string_view::npos) words.remove_prefix(line + 1);
  return valid_utf8(words);
}

}  // namespace isoline::benchmarks
