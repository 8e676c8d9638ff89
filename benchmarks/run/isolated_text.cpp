// Text from a child process: through a pipe, whole or not at all. The child's end decides, whoever
// else still holds the pipe.
#include "benchmarks/run/isolated_text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "benchmarks/run/isolate.h"
#include "benchmarks/run/process_group.h"
#include "core/clock.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

// An answer says first what it is and how long, so that one that breaks off is none.
struct Heading {
  enum class Kind : std::int64_t { text = 1, thrown, memory } kind;
  std::int64_t size;
};

constexpr std::size_t kMostAnswer = std::size_t{1} << 30;

void write_whole(std::string_view bytes, int descriptor) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) _exit(1);
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void answer(Heading::Kind kind, std::string_view text, int descriptor) {
  const Heading heading{kind, static_cast<std::int64_t>(text.size())};
  write_whole({reinterpret_cast<const char*>(&heading), sizeof heading}, descriptor);
  write_whole(text, descriptor);
}

void answer_by(const std::function<std::string()>& work, int descriptor) {
  try {
    answer(Heading::Kind::text, work(), descriptor);
  } catch (const std::bad_alloc&) {
    answer(Heading::Kind::memory, "", descriptor);
  } catch (const std::exception& error) {
    answer(Heading::Kind::thrown, error.what(), descriptor);
  } catch (...) {
    answer(Heading::Kind::thrown, "something that is no std::exception", descriptor);
  }
}

// Nothing where the child left, or was ended, before its answer was whole.
std::optional<IsolatedText> read_answer(std::string bytes) {
  Heading heading{.kind = Heading::Kind::thrown, .size = 0};
  if (bytes.size() < sizeof heading) return std::nullopt;
  std::memcpy(&heading, bytes.data(), sizeof heading);
  bytes.erase(0, sizeof heading);
  if (static_cast<std::int64_t>(bytes.size()) != heading.size) return std::nullopt;
  switch (heading.kind) {
    case Heading::Kind::text:
      return IsolatedText{std::move(bytes), ""};
    case Heading::Kind::thrown:
      return IsolatedText{{}, fmt::format("it threw: {}", valid_utf8(bytes))};
    case Heading::Kind::memory:
      return IsolatedText{{}, "it ran out of memory"};
  }
  return std::nullopt;
}

class Question {
 public:
  Question(double seconds, std::int64_t memory_bytes)
      : seconds_(seconds),
        watch_({.startup_seconds = seconds,
                .hard_seconds = seconds,
                .idle_seconds = seconds,
                .memory_bytes = memory_bytes},
               1, monotonic_nanoseconds()) {}
  ~Question() {
    for (const int end : {read_end_, write_end_})
      if (end >= 0) close(end);
  }
  Question(const Question&) = delete;
  Question& operator=(const Question&) = delete;

  void ask(const std::function<std::string()>& work) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw std::runtime_error(fmt::format("no pipe to it could be made: {}", strerror(errno)));
    read_end_ = ends[0];
    write_end_ = ends[1];
    fcntl(read_end_, F_SETFL, O_NONBLOCK);
    output_.open();
    group_.start([&] {
      output_.redirect();
      SharedMemory::keep_only({});
      limit_memory(watch_.limits().memory_bytes);
      answer_by(work, write_end_);
      leave();
    });
    output_.close_child_end();
    close(std::exchange(write_end_, -1));
  }

  IsolatedText wait() {
    constexpr int kMilliseconds = 20;  // how often limits are looked at
    for (;;) {
      std::array<pollfd, 2> events{pollfd{group_.descriptor(), POLLIN, 0},
                                   pollfd{read_end_, POLLIN, 0}};
      ::poll(events.data(), is_open_ ? 2 : 1, kMilliseconds);
      drain();
      if (const auto end = group_.collect()) return judged(end->wait_status);
      enforce();
    }
  }

 private:
  void drain() {
    output_.drain();
    std::array<char, 1 << 16> chunk;
    ssize_t got = 0;
    while (bytes_.size() <= kMostAnswer && (got = read(read_end_, chunk.data(), chunk.size())) > 0)
      bytes_.append(chunk.data(), static_cast<std::size_t>(got));
    if (got == 0) is_open_ = false;
  }

  void enforce() {
    const std::int64_t now = monotonic_nanoseconds();
    if (!breach_.empty() || !watch_.is_due(now)) return;
    const auto usage = group_.usage(watch_.limits().memory_bytes);
    if (const auto breach = watch_.check(usage, true, now))
      breach_ = breach->status == Status::memory ? "it ran out of memory"
                                                 : fmt::format("it took more than {} s", seconds_);
    if (bytes_.size() > kMostAnswer) breach_ = "its answer has more than 1 GiB";
    if (!breach_.empty()) group_.kill();
  }

  IsolatedText judged(int wait_status) {
    drain();  // what it wrote last
    if (!breach_.empty()) return {{}, breach_};
    if (auto found = read_answer(std::move(bytes_))) return std::move(*found);
    const std::string words = output_.last_words();
    return {{}, end_of_answerer(wait_status) + (words.empty() ? "" : "; it last wrote: " + words)};
  }

  const double seconds_;
  LimitWatch watch_;
  ProcessGroup group_;
  CapturedOutput output_;
  int read_end_ = -1, write_end_ = -1;
  bool is_open_ = true;
  std::string bytes_, breach_;
};

}  // namespace

IsolatedText isolated_text(const std::function<std::string()>& work, double seconds,
                           std::int64_t memory_bytes) {
  try {
    Question question(seconds, memory_bytes);
    question.ask(work);
    return question.wait();
  } catch (const std::runtime_error& error) {  // of the system, out of processes or of files
    return {{}, error.what()};
  }
}

}  // namespace isoline::benchmarks
