// The calls of one run to a problem in another process, in a file: each with its request, bit for
// bit, its answer and its time, before the method sees it. A run that was killed begins again, and
// its calls are answered from the file as long as they are the same.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/foreign/line.h"
#include "core/real.h"

namespace isoline {

inline constexpr double kSlowSeconds = 0.1;  // a call from which on a file is worth its bytes

// Which calls a file answers: the next one alone, of a run that is repeated; or any of a slow
// problem, where its answer is needed again, with the exception of products, which need a point.
enum class Answers { in_order, in_any_order };

class CallLog {
 public:
  using Numbers = std::span<const std::span<const Real>>;

  // A file that exists is read, if it belongs to `identity`. Otherwise the first call decides
  // whether one is written: where it is slow, or where `is_forced`.
  CallLog(std::filesystem::path path, std::string identity, bool is_forced,
          Answers answers = Answers::in_order);

  // The answer of a call in the file, and why it failed, empty if it did not. Nothing where the
  // next one is another call or the last was read: the rest is cut off, and `append` follows.
  std::optional<std::string> replay(Verb verb, std::uint32_t point, Numbers request,
                                    std::span<Real> answer);
  void append(Verb verb, std::uint32_t point, Numbers request, std::span<const Real> answer,
              const std::string& why, double seconds);
  // The answer of an earlier linearize of this run at the same x, bit for bit; none without a file.
  std::optional<std::string> recall(Numbers request, std::span<Real> answer);
  bool is_slow() const { return first_seconds_ >= kSlowSeconds; }  // the first call
  double replayed_seconds() const { return replayed_seconds_; }    // that they took when made

 private:
  struct Head;
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool read_next(Head& head);
  bool is_call(const Head& head, Verb verb, Numbers request, std::size_t answer_bytes) const;
  bool find(Head& head, Verb verb, Numbers request, std::size_t answer_bytes);
  std::string take(const Head& head, std::span<Real> answer) const;
  void pass(const Head& head);
  void note(Verb verb, Numbers request);
  void cut(const char* why);
  void write_bytes(std::span<const char> bytes);

  std::filesystem::path path_;
  std::string identity_;
  bool is_forced_, is_reading_ = false, is_decided_ = false;
  Answers answers_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::int64_t calls_ = 0, end_ = 0, size_ = 0;  // those before `end_`, where one follows; bytes
  double first_seconds_ = -1, replayed_seconds_ = 0;
  std::vector<char> bytes_;  // of a call behind its head
  // Where the answers of linearize begin in the file, by the digest of x; the last of each.
  std::unordered_map<std::uint64_t, std::int64_t> places_;
};

// While one lives, calls are recalled: the harness looks at a point that the method has evaluated.
class Recalling {
 public:
  Recalling() : before_(std::exchange(is_on_, true)) {}
  ~Recalling() { is_on_ = before_; }
  Recalling(const Recalling&) = delete;
  Recalling& operator=(const Recalling&) = delete;
  static bool is_on() { return is_on_; }

 private:
  inline static bool is_on_ = false;
  bool before_;
};

// The one of this process, which runs one cell; the cell sets it before it makes its problem.
inline std::unique_ptr<CallLog>& call_log() {
  static std::unique_ptr<CallLog> log;
  return log;
}

// A clock, in seconds, on which a call that the log answers takes the time that it took.
double call_clock();

}  // namespace isoline
