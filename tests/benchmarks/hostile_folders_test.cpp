// Result folders that others made: whatever stands in them costs its own file, and no more.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "benchmarks/merge/merge.h"
#include "core/errors.h"
#include "core/files.h"
#include "tests/reports/fixture.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using reports::plan_of;
using reports::record_of;
using reports::ResultFolder;
namespace {

namespace fs = std::filesystem;

bool is_named(const std::vector<std::string>& sentences, const std::string& part) {
  return std::ranges::any_of(sentences, [&](const std::string& sentence) {
    return sentence.find(part) != std::string::npos;
  });
}

std::string nested(std::size_t levels) {
  std::string text;
  for (std::size_t i = 0; i < levels; ++i) text += "{\"a\":";
  return text + "1" + std::string(levels, '}');
}

TEST(HostileFolders, ARecordThatNestsWithoutEndIsNamedAndLeftOut) {
  const ResultFolder a, b;
  const TemporaryFolder owned;
  a.add(record_of({}));
  a.add_file("runs/deep.json", nested(200'000));
  b.add_file("runs/deep.json", nested(200'001));
  a.add_file("components/deep.json", nested(200'000));
  a.add_file("plan.json", nested(200'000));
  const MergeOutcome outcome = merge_folders({a.path(), b.path()}, owned.path() / "out");
  EXPECT_EQ(outcome.records, 1U);
  EXPECT_EQ(outcome.unreadable.size(), 4U);
  EXPECT_TRUE(is_named(outcome.unreadable, "runs/deep.json"));
}

// Levels that one parser takes, and that the copies of a tree, or a comparison, might not.
TEST(HostileFolders, RecordsThatDifferAndAreNoneAreAConflict) {
  const ResultFolder a, b;
  const TemporaryFolder owned;
  a.add_file("runs/odd.json", nested(900));
  b.add_file("runs/odd.json", nested(901));
  const MergeOutcome outcome = merge_folders({a.path(), b.path()}, owned.path() / "out");
  ASSERT_EQ(outcome.conflicts.size(), 1U);
  EXPECT_NE(outcome.conflicts[0].sentence.find("are not records"), std::string::npos);
}

TEST(HostileFolders, NoLinkIsFollowedIntoAMergedFolder) {
  const ResultFolder a, b;
  const TemporaryFolder owned;
  const fs::path out = owned.path() / "out", secret = owned.path() / "secret";
  write_text(secret, "{}");
  const Record record = record_of({});
  a.add(record);
  fs::create_symlink(secret, a.path() / "runs" / "evil.npy");
  fs::create_symlink(secret, a.path() / "runs" / "evil.json");
  fs::create_symlink(secret, a.path() / "components" / "evil.json");
  fs::create_symlink(secret, a.path() / "rates.json");
  fs::remove(b.path() / "runs");
  fs::create_symlink(a.path() / "runs", b.path() / "runs");
  const MergeOutcome outcome = merge_folders({a.path(), b.path()}, out);
  EXPECT_EQ(outcome.unreadable.size(), 5U);
  EXPECT_TRUE(is_named(outcome.unreadable, "evil.npy: it is a symbolic link"));
  EXPECT_EQ(names_in(out / "runs"), std::vector<std::string>{record.file_name()});
  EXPECT_TRUE(names_in(out / "components").empty());
  EXPECT_FALSE(is_there(out / "rates.json"));
}

TEST(HostileFolders, PipesFoldersAndLinksInACircleUnderTheNameOfARecordAreNamed) {
  const ResultFolder a;
  const TemporaryFolder owned;
  a.add(record_of({}));
  ASSERT_EQ(mkfifo((a.path() / "runs" / "pipe.json").c_str(), 0600), 0);
  fs::create_directory(a.path() / "runs" / "folder.json");
  fs::create_symlink("circle.json", a.path() / "runs" / "circle.json");
  ASSERT_EQ(mkfifo((a.path() / "plan.json").c_str(), 0600), 0);
  const MergeOutcome outcome = merge_folders({a.path()}, owned.path() / "out");
  EXPECT_EQ(outcome.records, 1U);
  EXPECT_EQ(outcome.unreadable.size(), 4U);
  for (const char* name : {"pipe.json", "folder.json", "circle.json", "plan.json"})
    EXPECT_TRUE(is_named(outcome.unreadable, name)) << name;
}

// Two plans that are none, and one that is: the order of the folders decides nothing.
TEST(HostileFolders, APlanThatIsNoneCostsItselfAlone) {
  const ResultFolder a, b, c;
  const TemporaryFolder owned;
  a.add_file("plan.json", R"({"schema": "isoline.plan/1"})");
  a.add_file("rates.json", R"({"rows": [{}]})");
  b.add(plan_of({record_of({})}));
  c.add_file("plan.json", "[]");
  const MergeOutcome outcome = merge_folders({a.path(), b.path(), c.path()}, owned.path() / "out");
  EXPECT_EQ(outcome.unreadable.size(), 3U);
  EXPECT_EQ(plan_from_text(read_text(owned.path() / "out" / "plan.json"), "it").cells.size(), 1U);
}

TEST(Merge, ConflictsAreNamedByOptimizerWorstFirst) {
  const ResultFolder a, b;
  const auto disagree = [&](const char* optimizer, std::uint64_t seeds) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      Record record = record_of({.optimizer = optimizer, .seed = seed});
      a.add(record);
      record.summary.loss += 1;
      b.add(record);
    }
  };
  disagree("adam", 2);
  disagree("sip", 7);
  const TemporaryFolder owned;
  const std::string text =
      conflicts_text(merge_folders({a.path(), b.path()}, owned.path() / "out").conflicts);
  const std::size_t sip = text.find("sip: 7 conflicts\n"), adam = text.find("adam: 2 conflicts\n");
  EXPECT_LT(sip, adam) << text;
  EXPECT_NE(adam, std::string::npos) << text;
  EXPECT_NE(text.find("… and 4 more"), std::string::npos) << text;
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 4 + 2) << text;
  EXPECT_TRUE(names_in(owned.path()).empty()) << "nothing is written";
}

// The listener, which is told of the first file, kills in the middle of the work.
TEST(Merge, ThatIsAskedToEndLeavesNothingBehind) {
  const ResultFolder a;
  const TemporaryFolder owned;
  for (std::uint64_t seed = 0; seed < 100; ++seed) a.add(record_of({.seed = seed}));
  const auto killed = [](std::size_t, std::size_t) { std::raise(SIGTERM); };
  const MergeOutcome outcome = merge_folders({a.path()}, owned.path() / "out", killed);
  EXPECT_TRUE(outcome.is_interrupted);
  EXPECT_TRUE(names_in(owned.path()).empty());
}

}  // namespace
}  // namespace isoline::benchmarks
