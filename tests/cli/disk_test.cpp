// Disks that are full, spent or read-only: a clear message, nothing corrupted, and the same command
// goes on when there is room. Small file systems of their own, in a mount namespace of their own.
#include <gtest/gtest.h>

#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

const std::string kRun =
    "./isoline run --problem square,beale,wood --optimizer gd,newton,adam --rates none "
    "--iterations 300 --seeds 4 --out disk/out --jobs 2 ";

class Disk : public testing::Test {
 protected:
  // A script in a namespace where `disk` is a file system of its own.
  Finished on_disk(const std::string& options, const std::string& script) {
    std::filesystem::create_directories(shell.folder() / "disk");
    write_text(shell.folder() / "script.sh",
               "set -u\nmount -t tmpfs -o " + options + " none disk || exit 99\n" + script);
    return shell("unshare --user --map-root-user --mount bash script.sh");
  }
  void SetUp() override {
    const Finished allowed = on_disk("size=1m", "exit 0");
    if (allowed.exit_code != 0)
      GTEST_SKIP() << "no file system can be mounted here: " << allowed.err;
  }
  Shell shell;
};

// Room for the plan and some records, in bytes or in inodes. The second run has room for all of
// them.
TEST_F(Disk, ThatIsFullEndsTheRunWithAMessageAndTheNextGoesOnToSoundFiles) {
  for (const auto& [small, large] :
       {std::pair("size=300k", "size=64m"), std::pair("size=64m,nr_inodes=24", "nr_inodes=4096")}) {
    const Finished both =
        on_disk(small, kRun + "--no-report 2>first.err; echo first $?\nmount -o remount," + large +
                           " disk\n" + kRun +
                           "2>second.err; echo second $?\n"
                           "./isoline validate disk/out; echo valid $?\n"
                           "ls disk/out/runs | grep -vc 'json$'");
    const std::string first = read_text(shell.folder() / "first.err");
    EXPECT_TRUE(contains(first, "No space left on device")) << first;
    for (const char* part : {"first 2\n", "second 0\n", "valid 0\n"})
      EXPECT_TRUE(contains(both.out, part))
          << both.out << both.err << read_text(shell.folder() / "second.err");
    EXPECT_TRUE(both.out.ends_with("\n0\n")) << both.out;
  }
}

TEST_F(Disk, ThatIsReadOnlyIsTheCallersMistakeBeforeAnythingRuns) {
  const Finished result = on_disk(
      "size=64m", kRun + "--quiet --no-report; echo first $?\n" + "mount -o remount,ro disk\n" +
                      kRun + "--force 2>second.err; echo second $?\n" +
                      "./isoline run --problem square --optimizer gd --out disk/new "
                      "2>third.err; echo third $?\n");
  EXPECT_TRUE(contains(result.out, "first 0\nsecond 1\nthird 1\n")) << result.out << result.err;
  for (const char* file : {"second.err", "third.err"}) {
    const std::string message = read_text(shell.folder() / file);
    EXPECT_TRUE(contains(message, "Read-only file system")) << message;
    EXPECT_EQ(count_lines(message), 1U) << message;
  }
}

}  // namespace
}  // namespace isoline::benchmarks
