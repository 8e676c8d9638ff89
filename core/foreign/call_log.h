// The calls of one run to a problem in another process, in a file: each with its request, bit for
// bit, and its answer, before the method sees it. A run that was killed begins again, and its calls
// are answered from the file as long as they are the same.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/foreign/line.h"
#include "core/real.h"

namespace isoline {

class CallLog {
 public:
  using Numbers = std::span<const std::span<const Real>>;

  // A file that exists is read, if it belongs to `identity`. Otherwise the first call decides
  // whether one is written: where it is slow, or where `is_forced`.
  CallLog(std::filesystem::path path, std::string identity, bool is_forced);

  // The answer of the next call in the file, and why it failed, empty if it did not. Nothing where
  // the next one is another call or the last was read: the rest is cut off, and `append` follows.
  std::optional<std::string> replay(Verb verb, std::uint32_t point, Numbers request,
                                    std::span<Real> answer);
  void append(Verb verb, std::uint32_t point, Numbers request, std::span<const Real> answer,
              const std::string& why, double seconds);
  std::int64_t replayed() const { return replayed_; }

 private:
  struct Head;
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool read_next(Head& head);
  void cut(const char* why);
  void write_bytes(std::span<const char> bytes);

  std::filesystem::path path_;
  std::string identity_;
  bool is_forced_, is_reading_ = false, is_decided_ = false;
  std::unique_ptr<std::FILE, Closer> file_;
  std::int64_t replayed_ = 0, end_ = 0,
               size_ = 0;    // end_: of the calls so far, in bytes
  std::vector<char> bytes_;  // of a call behind its head
};

// The one of this process, which runs one cell; the cell sets it before it makes its problem.
inline std::unique_ptr<CallLog>& call_log() {
  static std::unique_ptr<CallLog> log;
  return log;
}

}  // namespace isoline
