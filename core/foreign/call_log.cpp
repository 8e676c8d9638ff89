// The file of calls: a line that names its run, then for each call a head and its bytes.
#include "core/foreign/call_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "core/clock.h"
#include "core/text.h"
#include "core/workspace.h"

namespace isoline {
namespace {

std::string heading_of(const std::string& identity) { return "isoline.calls/3 " + identity + "\n"; }

void add(std::vector<char>& bytes, const void* data, std::size_t count) {
  const char* const from = static_cast<const char*>(data);
  bytes.insert(bytes.end(), from, from + count);
}

// By words of eight bytes: a file that was cut short does not have it.
void add_words(PieceDigest& digest, std::span<const char> bytes) {
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], std::min(sizeof word, bytes.size() - i));
    digest.add(word);
  }
}

std::uint64_t digest_of(CallLog::Numbers request) {
  PieceDigest digest;
  for (const std::span<const Real> part : request)
    add_words(digest, {reinterpret_cast<const char*>(part.data()), part.size_bytes()});
  return digest.value();
}

}  // namespace

struct CallLog::Head {
  std::uint32_t verb = 0, point = 0;
  std::uint64_t request = 0, answer = 0, why = 0;  // bytes of each
  double seconds = 0;
  std::uint64_t checksum = 0;  // of all before it and of the bytes

  std::span<const char> bytes() const {
    return {reinterpret_cast<const char*>(this), sizeof *this};
  }
  std::uint64_t checksum_with(std::span<const char> rest) const {
    PieceDigest digest;
    add_words(digest, bytes().first(offsetof(Head, checksum)));
    add_words(digest, rest);
    return digest.value();
  }
};

CallLog::CallLog(std::filesystem::path path, std::string identity, bool is_forced, Answers answers)
    : path_(std::move(path)),
      identity_(heading_of(identity)),
      is_forced_(is_forced),
      answers_(answers) {
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
  if (answers_ == Answers::in_order) return;
  Head head;
  if (read_next(head)) first_seconds_ = head.seconds;
  is_reading_ = is_slow();
  if (!is_reading_) file_.reset();
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
      head.checksum_with(bytes_) != head.checksum) {
    cut("its last call is damaged");
    return false;
  }
  return true;
}

void CallLog::pass(const Head& head) {
  end_ += static_cast<std::int64_t>(sizeof head + bytes_.size());
  ++calls_;
}

// Before `end_` passes the call.
void CallLog::note(Verb verb, Numbers request) {
  if (verb == Verb::linearize) places_[digest_of(request)] = end_;
}

std::optional<std::string> CallLog::recall(Numbers request, std::span<Real> answer) {
  const auto place = places_.find(digest_of(request));
  if (!file_ || place == places_.end()) return std::nullopt;
  const auto read = [&](void* to, std::size_t count, std::int64_t at) {
    return pread(fileno(file_.get()), to, count, at) == static_cast<ssize_t>(count);
  };
  Head head;
  if (!read(&head, sizeof head, place->second)) return std::nullopt;
  bytes_.resize(head.request + head.answer + head.why);
  if (!read(bytes_.data(), bytes_.size(), place->second + std::ssize(head.bytes())) ||
      !is_call(head, Verb::linearize, request, answer.size_bytes()))
    return std::nullopt;
  return take(head, answer);
}

// The answer of the call in `bytes_`.
std::string CallLog::take(const Head& head, std::span<Real> answer) const {
  const char* const from = bytes_.data() + head.request;
  if (head.answer > 0) std::memcpy(answer.data(), from, head.answer);
  return {from + head.answer, head.why};
}

// From here on, the run is another one than that of the file, or the file is damaged.
void CallLog::cut(const char* why) {
  say(stderr,
      fmt::format("isoline: the log of evaluations is cut off after {} calls: {}\n", calls_, why));
  if (ftruncate(fileno(file_.get()), end_) != 0) file_.reset();
}

bool CallLog::is_call(const Head& head, Verb verb, Numbers request,
                      std::size_t answer_bytes) const {
  std::size_t at = 0;
  bool is_same = head.verb == static_cast<std::uint32_t>(verb) &&
                 (head.answer == 0 || head.answer == answer_bytes);
  for (const std::span<const Real> part : request) {
    is_same = is_same && at + part.size_bytes() <= head.request &&
              std::memcmp(&bytes_[at], part.data(), part.size_bytes()) == 0;
    at += part.size_bytes();
  }
  return is_same && at == head.request;
}

// From the beginning; where the file does not have it, `end_` is that of its whole calls.
bool CallLog::find(Head& head, Verb verb, Numbers request, std::size_t answer_bytes) {
  const bool is_product =
      verb == Verb::pushforward || verb == Verb::pullback || verb == Verb::jacobian;
  end_ = std::ssize(identity_);
  calls_ = 0;
  std::fflush(file_.get());  // what was read before calls were appended
  size_ = std::fseek(file_.get(), 0, SEEK_END) == 0 ? std::ftell(file_.get()) : end_;
  std::fseek(file_.get(), end_, SEEK_SET);
  while (end_ < size_ && read_next(head)) {
    if (!is_product && is_call(head, verb, request, answer_bytes)) return true;
    pass(head);
  }
  return false;
}

std::optional<std::string> CallLog::replay(Verb verb, std::uint32_t point, Numbers request,
                                           std::span<Real> answer) {
  if (!is_reading_ || !file_) return std::nullopt;
  Head head;
  if (answers_ == Answers::in_any_order) {
    if (!find(head, verb, request, answer.size_bytes())) return std::nullopt;
  } else {
    const bool has_next = read_next(head);
    if (!has_next || head.point != point || !is_call(head, verb, request, answer.size_bytes())) {
      if (has_next) cut("the run makes another call");
      is_reading_ = false;
      return std::nullopt;
    }
    note(verb, request);
    pass(head);
  }
  if (first_seconds_ < 0) first_seconds_ = head.seconds;
  replayed_seconds_ += head.seconds;
  return take(head, answer);
}

// On a full disk, the run continues without the file.
void CallLog::write_bytes(std::span<const char> bytes) {
  const ssize_t written = pwrite(fileno(file_.get()), bytes.data(), bytes.size(), end_);
  end_ += written;
  if (written != std::ssize(bytes)) file_.reset();
}

void CallLog::append(Verb verb, std::uint32_t point, Numbers request, std::span<const Real> answer,
                     const std::string& why, double seconds) {
  if (first_seconds_ < 0) first_seconds_ = seconds;
  if (!is_decided_ && (is_forced_ || seconds >= kSlowSeconds)) {
    std::error_code error;
    std::filesystem::create_directories(path_.parent_path(), error);
    file_.reset(std::fopen(path_.c_str(), "w+be"));
    if (file_) write_bytes({identity_.data(), identity_.size()});
  }
  is_decided_ = true;
  if (!file_) return;
  Head head{.verb = static_cast<std::uint32_t>(verb), .point = point, .seconds = seconds};
  bytes_.clear();
  for (const std::span<const Real> part : request) add(bytes_, part.data(), part.size_bytes());
  head.request = bytes_.size();
  if (why.empty()) add(bytes_, answer.data(), answer.size_bytes());
  head.answer = bytes_.size() - head.request;
  add(bytes_, why.data(), why.size());
  head.why = why.size();
  head.checksum = head.checksum_with(bytes_);
  note(verb, request);
  write_bytes(head.bytes());
  if (file_) write_bytes(bytes_);
}

double call_clock() {
  const CallLog* const log = call_log().get();
  return 1e-9 * static_cast<double>(monotonic_nanoseconds()) +
         (log != nullptr ? log->replayed_seconds() : 0);
}

}  // namespace isoline
