// Commands of programs that are started by a door: those of this folder and the examples of
// clients/.
#pragma once

#include <cstdlib>
#include <string>

#include "core/spec.h"

namespace isoline {

// An interpreter that has a package; empty where none has it.
inline std::string python_with(const std::string& package) {
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    const std::string asked = python + " -c 'import " + package + "' >/dev/null 2>&1";
    if (std::system(asked.c_str()) == 0) return python;
  }
  return "";
}

inline std::string misbehaving(const std::string& words) {
  return "python3 " ISOLINE_SOURCE_DIR "/tests/clients/" + words;
}

inline std::string example(const std::string& words, const std::string& python = "python3") {
  return python + " " ISOLINE_SOURCE_DIR "/clients/python/examples/" + words;
}

// process[command="…"]
inline std::string process_of(const std::string& command, const std::string& more = "") {
  return "process[command=" + quoted(command) + more + "]";
}

}  // namespace isoline
