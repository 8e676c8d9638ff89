// What a child process writes to its standard output and standard error: caught, so that no
// terminal gets it, and kept as far as it is not too much.
#pragma once

#include <cstdint>
#include <string>

namespace isoline::benchmarks {

class CapturedOutput {
 public:
  static constexpr std::size_t kMost = std::size_t{64} << 10;  // bytes kept, from the first on

  CapturedOutput() = default;
  ~CapturedOutput() { close(); }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;

  void open();             // before the child is forked
  void redirect() const;   // in the child
  void close_child_end();  // in the parent, once the child is forked
  void drain();            // takes what has come; what stays in the pipe holds the writer up
  void close();

  std::string text() const;        // valid UTF-8; says how much was left out
  std::string last_words() const;  // the last line that says something, cut to some 200 bytes

 private:
  void take(const char* bytes, std::size_t count);

  int read_end_ = -1, write_end_ = -1;
  bool is_widened_ = false;
  std::string kept_, tail_;
  std::int64_t left_out_ = 0;  // bytes
};

}  // namespace isoline::benchmarks
