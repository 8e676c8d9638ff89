// The external program that computes a component: a child process, a model behind UM-Bridge, or a
// shared library.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

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

  bool operator==(const Foreign&) const = default;
};

// A digest of the contents of those words that name regular files: of "python3 mine.py", mine.py.
// Files that such a file reads or imports are not included. UsageError if one cannot be read.
std::string digest_of_files(std::span<const std::string> words);

// A digest of everything that may change the result: a part of `build`.
std::string digest_of(const Foreign& foreign);

// Where what outsiders use from their own language lies beside this program.

// The folder of a language's client, as "python": of the prefix that the program is installed in,
// else of the tree that it was built in, else of the prefix that it was configured for.
std::filesystem::path client_folder(const std::string& language);

}  // namespace isoline
