// Commands run as a user types them, in a temporary folder where ./isoline is the built program.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/json.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

struct Finished {
  int exit_code = -1;
  std::string out, err;
};

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The exit code of a command, and parts of what it prints.
struct Expected {
  int exit_code = 0;
  std::vector<std::string> out = {}, err = {};
};

class Shell {
 public:
  Shell() { std::filesystem::create_symlink(ISOLINE_BINARY, folder_.path() / "isoline"); }
  const std::filesystem::path& folder() const { return folder_.path(); }

  Finished operator()(const std::string& command) const {
    const std::string there = folder_.path().string();
    const std::string whole = "cd " + there + " && { " + command + "\n} >.out 2>.err </dev/null";
    const int status = std::system(whole.c_str());
    return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            .out = read_text(folder_.path() / ".out"),
            .err = read_text(folder_.path() / ".err")};
  }

  Finished expect(const std::string& command, const Expected& expected = {}) const {
    Finished finished = (*this)(command);
    const std::string all = command + "\n" + finished.out + finished.err;
    EXPECT_EQ(finished.exit_code, expected.exit_code) << all;
    for (const std::string& part : expected.out)
      EXPECT_TRUE(contains(finished.out, part)) << part << ": " << all;
    for (const std::string& part : expected.err)
      EXPECT_TRUE(contains(finished.err, part)) << part << ": " << all;
    return finished;
  }

 private:
  TemporaryFolder folder_;
};

inline std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

inline std::size_t count_records(const std::filesystem::path& out) {
  std::size_t count = 0;
  std::error_code error;  // the folder may not be there yet
  for (const auto& entry : std::filesystem::directory_iterator(out / "runs", error))
    count += entry.path().extension() == ".json";
  return count;
}

}  // namespace isoline::benchmarks
