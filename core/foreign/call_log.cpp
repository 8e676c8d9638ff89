// The file of calls: a line that names its run, then for each call a head and its bytes.
#include "core/foreign/call_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/text.h"

namespace isoline {
namespace {

constexpr double kSlowSeconds = 0.1;  // a call from which on a file is worth its bytes

std::string heading_of(const std::string& identity) { return "isoline.calls/1 " + identity + "\n"; }

void add(std::vector<char>& bytes, const void* data, std::size_t count) {
  const char* const from = static_cast<const char*>(data);
  bytes.insert(bytes.end(), from, from + count);
}

// FNV-1a by words of eight bytes: a file that was cut short does not have it.
std::uint64_t checksum_of(std::span<const char> bytes) {
  std::uint64_t state = 0xcbf29ce484222325;
  for (std::size_t i = 0; i < bytes.size(); i += sizeof state) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], std::min(sizeof word, bytes.size() - i));
    state = (state ^ word) * 0x100000001b3;
    state ^= state >> 29;
  }
  return state;
}

}  // namespace

struct CallLog::Head {
  std::uint32_t verb = 0, point = 0;
  std::uint64_t request = 0, answer = 0, why = 0;  // bytes of each
  std::uint64_t checksum = 0;
};

CallLog::CallLog(std::filesystem::path path, std::string identity, bool is_forced)
    : path_(std::move(path)), identity_(heading_of(identity)), is_forced_(is_forced) {
  file_.reset(std::fopen(path_.c_str(), "r+be"));
  if (!file_) return;
  std::string heading(identity_.size(), '\0');
  const std::size_t got = std::fread(heading.data(), 1, heading.size(), file_.get());
  std::error_code error;
  size_ = static_cast<std::int64_t>(std::filesystem::file_size(path_, error));
  if (error || got != heading.size() || heading != identity_) {
    file_.reset();  // of another run, whose calls are not these
    return;
  }
  end_ = std::ssize(identity_);
  is_reading_ = is_decided_ = true;
}

// Whether the file has a further call, and that is whole.
bool CallLog::read_next(Head& head) {
  if (std::fread(&head, sizeof head, 1, file_.get()) != 1) {
    if (end_ < size_) cut("its last call is damaged");
    return false;
  }
  const auto left = static_cast<std::uint64_t>(size_ - end_) - sizeof head;
  const bool is_possible = head.request <= left && head.answer <= left && head.why <= left &&
                           head.request + head.answer + head.why <= left;
  bytes_.resize(is_possible ? head.request + head.answer + head.why : 0);
  if (!is_possible ||
      (!bytes_.empty() && std::fread(bytes_.data(), bytes_.size(), 1, file_.get()) != 1) ||
      checksum_of(bytes_) != head.checksum) {
    cut("its last call is damaged");
    return false;
  }
  return true;
}

// From here on, the run is another one than that of the file, or the file is damaged.
void CallLog::cut(const char* why) {
  say(stderr, fmt::format("isoline: the log of evaluations is cut off after {} calls: {}\n",
                          replayed_, why));
  if (ftruncate(fileno(file_.get()), end_) != 0) file_.reset();
}

std::optional<std::string> CallLog::replay(Verb verb, std::uint32_t point, Numbers request,
                                           std::span<Real> answer) {
  if (!is_reading_) return std::nullopt;
  Head head;
  const bool has_next = read_next(head);
  std::size_t at = 0;
  bool is_same = has_next && head.verb == static_cast<std::uint32_t>(verb) && head.point == point &&
                 (head.answer == 0 || head.answer == answer.size_bytes());
  for (const std::span<const Real> part : request) {
    is_same = is_same && at + part.size_bytes() <= head.request &&
              std::memcmp(&bytes_[at], part.data(), part.size_bytes()) == 0;
    at += part.size_bytes();
  }
  if (!is_same || at != head.request) {
    if (has_next) cut("the run makes another call");
    is_reading_ = false;
    return std::nullopt;
  }
  const char* const from = bytes_.data() + at;
  if (head.answer > 0) std::memcpy(answer.data(), from, head.answer);
  end_ += static_cast<std::int64_t>(sizeof head + bytes_.size());
  ++replayed_;
  return std::string(from + head.answer, head.why);
}

// On a full disk, the run continues without the file.
void CallLog::write_bytes(std::span<const char> bytes) {
  const ssize_t written = pwrite(fileno(file_.get()), bytes.data(), bytes.size(), end_);
  end_ += written;
  if (written != std::ssize(bytes)) file_.reset();
}

void CallLog::append(Verb verb, std::uint32_t point, Numbers request, std::span<const Real> answer,
                     const std::string& why, double seconds) {
  if (!is_decided_ && (is_forced_ || seconds >= kSlowSeconds)) {
    std::error_code error;
    std::filesystem::create_directories(path_.parent_path(), error);
    file_.reset(std::fopen(path_.c_str(), "wbe"));
    if (file_) write_bytes({identity_.data(), identity_.size()});
  }
  is_decided_ = true;
  if (!file_) return;
  Head head{.verb = static_cast<std::uint32_t>(verb), .point = point};
  bytes_.clear();
  for (const std::span<const Real> part : request) add(bytes_, part.data(), part.size_bytes());
  head.request = bytes_.size();
  if (why.empty()) add(bytes_, answer.data(), answer.size_bytes());
  head.answer = bytes_.size() - head.request;
  add(bytes_, why.data(), why.size());
  head.why = why.size();
  head.checksum = checksum_of(bytes_);
  write_bytes({reinterpret_cast<const char*>(&head), sizeof head});
  if (file_) write_bytes(bytes_);
}

}  // namespace isoline
