// Words as a POSIX shell reads them, so that a command in a record can be typed again.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace isoline {

// The word itself where a shell takes it literally, else in single quotes: it's -> 'it'\''s'.
std::string shell_word(std::string_view word);

// The words of a command, split and unquoted as a shell does it, and nothing expanded: no variable,
// no pattern, no pipe. UsageError where a quote stays open or there is no word at all.
std::vector<std::string> shell_words(std::string_view command);

// A program that computes for this process, whose processor time is counted as this one's: of the
// process itself, not of those that it starts.
class CountedProcess {
 public:
  explicit CountedProcess(pid_t process);
  ~CountedProcess();  // before the process is waited for
  CountedProcess(const CountedProcess&) = delete;
  CountedProcess& operator=(const CountedProcess&) = delete;

 private:
  pid_t process_;
};

double counted_processor_seconds();  // of all of them so far, user and system
bool counts_processes();             // this process has had some

}  // namespace isoline
