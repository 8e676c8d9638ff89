// The external program that computes a component: a child process, a model behind UM-Bridge, or a
// shared library; and programs that are started beside this one.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/options.h"
#include "core/shell.h"

namespace isoline {

struct PluginComponent;  // of a shared library: core/foreign/plugin_library.h

struct Foreign {
  std::string door;         // "process" or "plugin"; of older records "umbridge"
  std::string command;      // as typed: a command, an address, or the path of a library
  std::string digest;       // of the files that are known to compute it
  std::string label;        // what tables call it, in the place of its spec; empty: the spec
  std::string interpreter;  // "CPython 3.11.2"; empty where it has none
  std::map<std::string, std::string> packages;  // versions by name, as it says itself
  std::string note, source;                     // as an entry's
  // Options that a program declares besides those of the adapter, and the one of them that tuning
  // chooses. Not in records, which hold their values.
  OptionTable options = {};
  std::string tunable = {};

  bool operator==(const Foreign&) const = default;
};

// A digest of the contents of those words that name regular files: of "python3 mine.py", mine.py.
// Files that such a file reads or imports are not included. UsageError if one cannot be read.
std::string digest_of_files(std::span<const std::string> words);

// A digest of everything that may change the result: a part of `build`.
std::string digest_of(const Foreign& foreign);

// The folder of a language's client, as "python": of the prefix that the program is installed in,
// else of the tree that it was built in, else of the prefix that it was configured for.
std::filesystem::path client_folder(const std::string& language);

// A program that is started beside this one and computes for it: its command, its environment, what
// it prints, its end. It dies with this process, and with this object.

// A signal that somebody sends, a scheduler, a user or the kernel out of memory, as opposed to one
// that a fault of its own raises.
bool is_from_outside(int signal);

// In a process that is one cell: programs started from now on belong to its process group, so that
// ending the cell ends them. Their output, up to one MiB, goes to the output of this process, which
// is captured. In other processes each program leads its own group, and its output is not shown.
void join_child_programs();

class ChildProgram {
 public:
  struct Start {
    std::string command;  // words as of a shell, nothing expanded
    // Beside what this process has; a value takes the place of its own.
    std::vector<std::pair<std::string, std::string>> environment = {};
    int descriptor = -1;  // that it inherits under the same number; −1: none but the standard ones
  };

  // UsageError where the command cannot be read or names no program.
  explicit ChildProgram(const Start& start);
  ~ChildProgram();  // kills it, and its group where it leads one
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  const std::string& command() const { return command_; }
  // Readable if the program has printed. A caller that waits for it must also drain this pipe:
  // otherwise the program could block on a full pipe.
  int output() const { return output_; }
  void drain();
  bool has_ended();  // without waiting
  // "it left with exit code 1", or that it still runs; where it is ending, that is waited for.
  std::string end_in_words();
  bool was_killed() const { return end_ && !end_->is_exit && is_from_outside(end_->number); }
  // The last lines of its output, as valid UTF-8; empty if it printed nothing.
  std::string last_words() const;

 private:
  void launch(const Start& start);
  void take(const char* bytes, std::size_t count);
  void await_end(double seconds);

  std::string command_;
  pid_t process_ = 0;
  std::optional<CountedProcess> counted_;
  int output_ = -1;
  bool leads_group_ = true;
  struct End {
    bool is_exit;  // else a signal
    int number;
  };
  std::optional<End> end_;
  std::string tail_;
  std::size_t passed_ = 0;  // bytes that went on to this process's own output
};

}  // namespace isoline
