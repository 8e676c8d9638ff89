// The union of result folders does not depend on their order, and never chooses between results.
// Whatever others put into one costs its own file, and no more.
#include "benchmarks/merge/merge.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/random.h"
#include "core/records/sheet.h"
#include "tests/reports/fixture.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using reports::plan_of;
using reports::record_of;
using reports::ResultFolder;
namespace {

namespace fs = std::filesystem;

// Text by path within the folder.
std::map<std::string, std::string> contents_of(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      all[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  return all;
}

class Merge : public testing::Test {
 protected:
  // Into a new folder that lives as long as this.
  const MergeOutcome& merge(const std::vector<fs::path>& folders) {
    out = owned.path() / std::to_string(count_++);
    return outcome = merge_folders(folders, out);
  }
  const MergeOutcome& merge() { return merge({a.path(), b.path()}); }
  Record merged(const Record& record) const {
    return read_unchecked_record(out / "runs" / record.file_name());
  }

  const ResultFolder a, b, c;
  const TemporaryFolder owned;
  fs::path out;
  MergeOutcome outcome;

 private:
  int count_ = 0;
};
using HostileFolders = Merge;

AuditedOptimizer audit_of(const std::string& name, Real angle) {
  return {.name = name, .spec = name, .linear_angle = angle};
}

// Of six optimizers some, by name.
void add_audit(const ResultFolder& folder, RandomStream& random) {
  std::vector<AuditedOptimizer> all;
  for (int i = 0; i < 6; ++i)
    if (random.uniform() < 0.6)
      all.push_back(audit_of(std::string(1, static_cast<char>('a' + i)), i));
  folder.add_file("audit.json", audit_to_json(all).dump(1) + "\n");
}

// The rates that its plan used: two of four methods', of which one is told in several ways.
void add_rates(const ResultFolder& folder, RandomStream& random) {
  Json rows = Json::array();
  for (const char* optimizer : {"a", "b", "c", "d"}) {
    if (random.uniform() < 0.5) continue;
    const Real rate = *optimizer == 'c' ? random.uniform() : 1;
    rows.push_back(
        {{"problem", "square"}, {"optimizer", optimizer}, {"options", {{"rate", rate}}}});
  }
  const Json table{{"schema", "isoline.rates/1"}, {"rows", rows}};
  folder.add_file("rates.json", table.dump() + "\n");
}

// A folder of random cells out of twelve: timings, start and provenance differ between folders.
void fill(const ResultFolder& folder, std::uint64_t number) {
  RandomStream random(number, "merge", "folder");
  std::vector<Record> records;
  for (std::uint64_t cell = 0; cell < 12; ++cell) {
    if (random.uniform() < 0.4) continue;
    Record record = record_of({.seed = cell});
    const std::string started = std::to_string(random.uniform());
    record.provenance = Provenance(Build{.processor = random.uniform() < 0.5 ? "one" : "another"});
    record.provenance.run.started = started;
    record.summary.wall_seconds = random.uniform();
    for (int i = 0; i < 3; ++i)  // of ten values, so that some are in several lists
      record.repeat_wall_seconds.push_back(std::floor(10 * random.uniform()) / 10);
    std::ranges::sort(record.repeat_wall_seconds);
    if (cell == 10) record.is_nondeterministic = random.uniform() < 0.5;
    if (cell == 10) record.summary.loss = record.is_nondeterministic ? random.uniform() : 0.5;
    folder.add(record);
    records.push_back(record);
  }
  if (number % 4 != 0) folder.add(plan_of(records));
  if (number % 5 != 0) add_audit(folder, random);
  if (number % 3 != 0) add_rates(folder, random);
  folder.add(Sheet{.kind = "problem",
                   .name = "square",
                   .spec = "square",
                   .title = number % 3 == 0 ? "A title" : "Another",
                   .options_text = "[]"});
}

TEST_F(Merge, DoesNotDependOnTheOrderOfTheFoldersOrOnHowOftenOneIsGiven) {
  std::size_t united = 0;
  for (std::uint64_t trial = 0; trial < 8; ++trial) {
    const ResultFolder one, two, three;
    fill(one, 3 * trial);
    fill(two, 3 * trial + 1);
    fill(three, 3 * trial + 2);
    united += merge({one.path(), two.path(), three.path()}).united;
    EXPECT_TRUE(outcome.conflicts.empty());
    const fs::path all = out;
    auto once = contents_of(all);
    merge({three.path(), one.path(), two.path(), one.path()});
    EXPECT_TRUE(contents_of(out) == once) << trial;
    merge({all, two.path()});
    auto twice = contents_of(out);
    for (auto* some : {&once, &twice})
      std::erase_if(*some, [](const auto& file) { return file.first.starts_with("components"); });
    EXPECT_TRUE(twice == once) << trial;
  }
  EXPECT_GE(united, 20U);
}

// {1, 1, 2} and {1, 3}: 1 twice, as in the folder that has it most often.
TEST_F(Merge, TimingsAreUnitedAndSorted) {
  Record record = record_of({});
  record.repeat_wall_seconds = {1, 1, 2};
  a.add(record);
  record.repeat_wall_seconds = {1, 3};
  b.add(record);
  EXPECT_EQ(merge().united, 1U);
  EXPECT_EQ(merged(record).repeat_wall_seconds, (std::vector<Real>{1, 1, 2, 3}));
  EXPECT_TRUE(outcome.conflicts.empty());
}

TEST_F(Merge, AConflictNamesTheCellAndNothingIsWritten) {
  Record record = record_of({.problem = "heat[N=8]", .seed = 4});
  a.add(record);
  record.summary.loss *= 1.05;
  b.add(record);
  b.add(record_of({.seed = 5}));
  ASSERT_EQ(merge().conflicts.size(), 1U);
  for (const char* part : {"heat[N=8] × gd, seed 4", "/summary/loss", "differ"})
    EXPECT_NE(outcome.conflicts[0].sentence.find(part), std::string::npos)
        << outcome.conflicts[0].sentence;
  EXPECT_EQ(outcome.conflicts[0].optimizer, "gd");
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Merge, OtherBuildsOfACellStandBesideEachOther) {
  a.add(record_of({.work_per_hit = 2, .build = "b0"}));
  b.add(record_of({.work_per_hit = 3, .build = "b1"}));
  EXPECT_EQ(merge().records, 2U);
  EXPECT_TRUE(outcome.conflicts.empty());
}

TEST_F(Merge, ARunThatEndedByItselfStandsBeforeOneThatTheClockEnded) {
  const Record whole = record_of({.started = "2026-01-01T00:00:00Z"});
  Record cut = record_of({.hits = 5, .status = Status::budget, .started = "2026-02-01T00:00:00Z"});
  cut.is_nondeterministic = true;
  a.add(cut);
  b.add(whole);
  EXPECT_TRUE(merge().conflicts.empty());
  EXPECT_EQ(merged(whole).status, Status::target);
}

TEST_F(Merge, UnitesAuditsAndRefusesWhatWasMeasuredDifferently) {
  const auto text = [](const std::vector<AuditedOptimizer>& all) {
    return audit_to_json(all).dump(1) + "\n";
  };
  a.add_file("audit.json", text({audit_of("adam", 1), audit_of("gd", 2)}));
  b.add_file("audit.json", text({audit_of("gd", 2), audit_of("sip", 0)}));
  c.add_file("audit.json", text({audit_of("gd", 3)}));
  merge();
  EXPECT_EQ(audit_from_text(read_text(out / "audit.json"), "it").size(), 3U);
  ASSERT_EQ(merge({a.path(), c.path()}).conflicts.size(), 1U);
  EXPECT_EQ(outcome.conflicts[0].optimizer, "gd");
  EXPECT_NE(outcome.conflicts[0].sentence.find("its audit"), std::string::npos);
}

TEST_F(Merge, NeverWritesIntoAFolderThatHoldsSomething) {
  a.add(record_of({}));
  EXPECT_THROW(merge_folders({a.path()}, b.path()), UsageError);
  EXPECT_THROW(merge_folders({a.path() / "none"}, a.path() / "new"), UsageError);
  EXPECT_FALSE(fs::exists(a.path() / "new"));
}

TEST_F(Merge, ConflictsAreNamedByOptimizerWorstFirst) {
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
  const std::string text = conflicts_text(merge().conflicts);
  const std::size_t sip = text.find("sip: 7 conflicts\n"), adam = text.find("adam: 2 conflicts\n");
  EXPECT_LT(sip, adam) << text;
  EXPECT_NE(adam, std::string::npos) << text;
  EXPECT_NE(text.find("… and 4 more"), std::string::npos) << text;
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 4 + 2) << text;
  EXPECT_TRUE(names_in(owned.path()).empty()) << "nothing is written";
}

// The listener, which is told of the first file, kills in the middle of the work.
TEST_F(Merge, ThatIsAskedToEndLeavesNothingBehind) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) a.add(record_of({.seed = seed}));
  const auto killed = [](std::size_t, std::size_t) { std::raise(SIGTERM); };
  EXPECT_TRUE(merge_folders({a.path()}, owned.path() / "out", killed).is_interrupted);
  EXPECT_TRUE(names_in(owned.path()).empty());
}

// --- what others put there

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

TEST_F(HostileFolders, WhatIsNoRecordUnderTheNameOfOneIsNamedAndLeftOut) {
  a.add(record_of({}));
  a.add_file("runs/deep.json", nested(200'000));
  b.add_file("runs/deep.json", nested(200'001));
  a.add_file("components/deep.json", nested(200'000));
  b.add_file("plan.json", nested(200'000));
  b.add_file("runs/torn.json", R"({"schema": "isoline.run/1", "cell": "a)");
  ASSERT_EQ(mkfifo((a.path() / "runs" / "pipe.json").c_str(), 0600), 0);
  fs::create_directory(a.path() / "runs" / "folder.json");
  fs::create_symlink("circle.json", a.path() / "runs" / "circle.json");
  ASSERT_EQ(mkfifo((a.path() / "plan.json").c_str(), 0600), 0);
  EXPECT_EQ(merge().records, 1U);
  EXPECT_EQ(outcome.unreadable.size(), 9U);
  for (const char* name : {"runs/deep.json", "components/deep.json", "pipe.json", "folder.json",
                           "circle.json", "torn.json", "plan.json"})
    EXPECT_TRUE(is_named(outcome.unreadable, name)) << name;
  EXPECT_FALSE(is_there(out / "runs" / "torn.json"));
}

// Levels that one parser takes, and that the copies of a tree, or a comparison, might not.
TEST_F(HostileFolders, RecordsThatDifferAndAreNoneAreAConflict) {
  a.add_file("runs/odd.json", nested(900));
  b.add_file("runs/odd.json", nested(901));
  ASSERT_EQ(merge().conflicts.size(), 1U);
  EXPECT_NE(outcome.conflicts[0].sentence.find("are not records"), std::string::npos);
}

TEST_F(HostileFolders, NoLinkIsFollowedIntoAMergedFolder) {
  const fs::path secret = owned.path() / "secret";
  write_text(secret, "{}");
  const Record record = record_of({});
  a.add(record);
  for (const char* name : {"runs/evil.npy", "runs/evil.json", "components/evil.json", "rates.json"})
    fs::create_symlink(secret, a.path() / name);
  fs::remove(b.path() / "runs");
  fs::create_symlink(a.path() / "runs", b.path() / "runs");
  EXPECT_EQ(merge().unreadable.size(), 5U);
  EXPECT_TRUE(is_named(outcome.unreadable, "evil.npy: it is a symbolic link"));
  EXPECT_EQ(names_in(out / "runs"), std::vector<std::string>{record.file_name()});
  EXPECT_TRUE(names_in(out / "components").empty());
  EXPECT_FALSE(is_there(out / "rates.json"));
}

// Two plans that are none, and one that is: the order of the folders decides nothing.
TEST_F(HostileFolders, APlanThatIsNoneCostsItselfAlone) {
  a.add_file("plan.json", R"({"schema": "isoline.plan/1"})");
  a.add_file("rates.json", R"({"rows": [{}]})");
  b.add(plan_of({record_of({})}));
  c.add_file("plan.json", "[]");
  EXPECT_EQ(merge({a.path(), b.path(), c.path()}).unreadable.size(), 3U);
  EXPECT_EQ(plan_from_text(read_text(out / "plan.json"), "it").cells.size(), 1U);
}

}  // namespace
}  // namespace isoline::benchmarks
