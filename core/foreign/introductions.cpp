// Commands that are started, and what is known of them before.
#include "core/foreign/introductions.h"

#include <cstdlib>

#include "core/errors.h"
#include "core/foreign/client_files.h"
#include "core/shell.h"

namespace isoline {

ChildProgram::Start door_to(const std::string& command) {
  require(!command.empty(),
          "process needs a command, as in process[command=\"python3 mine.py\"], and got none");
  const char* const theirs = std::getenv("PYTHONPATH");
  const std::string ours = client_folder("python").string();
  return {.command = command,
          .environment = {{"PYTHONPATH", theirs == nullptr ? ours : ours + ":" + theirs},
                          // our folder may be read-only, and theirs is not ours to write into
                          {"PYTHONDONTWRITEBYTECODE", "1"}}};
}

Foreign foreign_of_command(const std::string& command) {
  return {.door = "process", .command = command, .digest = digest_of_files(shell_words(command))};
}

}  // namespace isoline
