// The union of result folders does not depend on their order, and never chooses between results.
#include "benchmarks/merge/merge.h"

#include <gtest/gtest.h>

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

using Contents = std::map<std::string, std::string>;  // text by path within the folder

Contents contents_of(const fs::path& folder) {
  Contents all;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      all[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  return all;
}

// Merges into new folders that live as long as this.
class Merger {
 public:
  fs::path operator()(const std::vector<fs::path>& folders) {
    const fs::path out = owned_.path() / std::to_string(count_++);
    last = merge_folders(folders, out);
    return out;
  }
  MergeOutcome last;

 private:
  TemporaryFolder owned_;
  int count_ = 0;
};

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

TEST(Merge, DoesNotDependOnTheOrderOfTheFoldersOrOnHowOftenOneIsGiven) {
  std::size_t united = 0;
  for (std::uint64_t trial = 0; trial < 8; ++trial) {
    const ResultFolder a, b, c;
    fill(a, 3 * trial);
    fill(b, 3 * trial + 1);
    fill(c, 3 * trial + 2);
    Merger merged;
    const fs::path abc = merged({a.path(), b.path(), c.path()});
    const Contents all = contents_of(abc);
    united += merged.last.united;
    EXPECT_TRUE(merged.last.conflicts.empty());
    EXPECT_TRUE(contents_of(merged({c.path(), a.path(), b.path(), a.path()})) == all) << trial;
    Contents twice = contents_of(merged({abc, b.path()})), once = all;
    std::erase_if(twice, [](const auto& file) { return file.first.starts_with("components"); });
    std::erase_if(once, [](const auto& file) { return file.first.starts_with("components"); });
    EXPECT_TRUE(twice == once) << trial;
  }
  EXPECT_GE(united, 20U);
}

// {1, 1, 2} and {1, 3}: 1 twice, as in the folder that has it most often.
TEST(Merge, TimingsAreUnitedAndSorted) {
  Record record = record_of({});
  const ResultFolder a, b;
  record.repeat_wall_seconds = {1, 1, 2};
  a.add(record);
  record.repeat_wall_seconds = {1, 3};
  b.add(record);
  Merger merged;
  const fs::path out = merged({a.path(), b.path()});
  EXPECT_EQ(record_from_text(json_text(read_json(out / "runs" / record.file_name())), "it")
                .repeat_wall_seconds,
            (std::vector<Real>{1, 1, 2, 3}));
  EXPECT_EQ(merged.last.united, 1U);
  EXPECT_TRUE(merged.last.conflicts.empty());
}

TEST(Merge, AConflictNamesTheCellAndNothingIsWritten) {
  Record record = record_of({.problem = "heat[N=8]", .seed = 4});
  const ResultFolder a, b;
  a.add(record);
  record.summary.loss *= 1.05;
  b.add(record);
  b.add(record_of({.seed = 5}));
  Merger merged;
  const fs::path out = merged({a.path(), b.path()});
  ASSERT_EQ(merged.last.conflicts.size(), 1U);
  for (const char* part : {"heat[N=8] × gd, seed 4", "/summary/loss", "differ"})
    EXPECT_NE(merged.last.conflicts[0].sentence.find(part), std::string::npos)
        << merged.last.conflicts[0].sentence;
  EXPECT_EQ(merged.last.conflicts[0].optimizer, "gd");
  EXPECT_FALSE(fs::exists(out));
}

TEST(Merge, OtherBuildsOfACellStandBesideEachOther) {
  const ResultFolder a, b;
  a.add(record_of({.work_per_hit = 2, .build = "b0"}));
  b.add(record_of({.work_per_hit = 3, .build = "b1"}));
  Merger merged;
  merged({a.path(), b.path()});
  EXPECT_EQ(merged.last.records, 2U);
  EXPECT_TRUE(merged.last.conflicts.empty());
}

TEST(Merge, ARunThatEndedByItselfStandsBeforeOneThatTheClockEnded) {
  Record whole = record_of({.started = "2026-01-01T00:00:00Z"});
  Record cut = record_of({.hits = 5, .status = Status::budget, .started = "2026-02-01T00:00:00Z"});
  cut.is_nondeterministic = true;
  const ResultFolder a, b;
  a.add(whole);
  b.add(cut);
  Merger merged;
  const fs::path out = merged({b.path(), a.path()});
  EXPECT_TRUE(merged.last.conflicts.empty());
  EXPECT_EQ(record_from_text(json_text(read_json(out / "runs" / whole.file_name())), "it").status,
            Status::target);
}

TEST(Merge, ADamagedFileIsNamedAndLeftOut) {
  const ResultFolder a;
  a.add(record_of({}));
  a.add_file("runs/torn.json", R"({"schema": "isoline.run/1", "cell": "a)");
  Merger merged;
  const fs::path out = merged({a.path()});
  ASSERT_EQ(merged.last.unreadable.size(), 1U);
  EXPECT_NE(merged.last.unreadable[0].find("torn.json"), std::string::npos);
  EXPECT_FALSE(fs::exists(out / "runs" / "torn.json"));
}

TEST(Merge, UnitesAuditsAndRefusesWhatWasMeasuredDifferently) {
  const ResultFolder a, b, c;
  const auto text = [](const std::vector<AuditedOptimizer>& all) {
    return audit_to_json(all).dump(1) + "\n";
  };
  a.add_file("audit.json", text({audit_of("adam", 1), audit_of("gd", 2)}));
  b.add_file("audit.json", text({audit_of("gd", 2), audit_of("sip", 0)}));
  c.add_file("audit.json", text({audit_of("gd", 3)}));
  Merger merged;
  const fs::path out = merged({a.path(), b.path()});
  EXPECT_EQ(audit_from_text(read_text(out / "audit.json"), "it").size(), 3U);
  merged({a.path(), c.path()});
  ASSERT_EQ(merged.last.conflicts.size(), 1U);
  EXPECT_EQ(merged.last.conflicts[0].optimizer, "gd");
  EXPECT_NE(merged.last.conflicts[0].sentence.find("its audit"), std::string::npos);
}

TEST(Merge, NeverWritesIntoAFolderThatHoldsSomething) {
  const ResultFolder a, b;
  a.add(record_of({}));
  EXPECT_THROW(merge_folders({a.path()}, b.path()), UsageError);
  EXPECT_THROW(merge_folders({a.path() / "none"}, a.path() / "new"), UsageError);
  EXPECT_FALSE(fs::exists(a.path() / "new"));
}

}  // namespace
}  // namespace isoline::benchmarks
