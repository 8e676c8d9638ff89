// A folder read record by record gives the subjects that its whole study would.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/errors.h"
#include "core/records/plan.h"
#include "reports/compare/gate.h"
#include "reports/compare/subject.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

// Declared and undeclared minima, a second build, a cell in dispute, and what is no record.
void fill(const ResultFolder& folder) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Record record = record_of({.seed = seed, .work_per_hit = 2});
    if (seed == 1) record.minimum.reset();
    if (seed == 1) record.hits.reset();
    folder.add(record);
    if (seed == 2) folder.add(record_of({.seed = 2, .work_per_hit = 3, .build = "b1"}));
    if (seed != 3) continue;
    record.summary.loss += 1;
    folder.add_file("runs/copy-of-3.json", file_text(record));
  }
  folder.add(record_of({.problem = "heat", .status = Status::inapplicable}));
  folder.add_file("runs/torn.json", "{");
  mkfifo((folder.path() / "runs" / "pipe.json").c_str(), 0600);
}

TEST(FolderSubjects, AreThoseOfTheWholeStudy) {
  const ResultFolder folder;
  fill(folder);
  const Study study = read_study({folder.path()});
  const BestKnown best(study);
  const std::vector<Subject> whole = subjects_of(study, best);
  const FolderSubjects found = read_subjects(folder.path(), std::nullopt);
  EXPECT_EQ(found.superseded, study.superseded);
  EXPECT_EQ(found.unreadable, 2U);
  ASSERT_EQ(found.subjects.size(), whole.size());
  std::size_t doubtful = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const Subject &a = whole[i], &b = found.subjects[i];
    EXPECT_EQ(a.key, b.key);
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.terms, b.terms);
    EXPECT_EQ(a.trace, b.trace);
    EXPECT_EQ(a.rest, b.rest);
    EXPECT_EQ(a.doubt, b.doubt);
    EXPECT_EQ(a.members.size(), b.members.size());
    doubtful += !b.doubt.empty();
    ASSERT_EQ(a.quantities.size(), b.quantities.size());
    for (std::size_t q = 0; q < a.quantities.size(); ++q) {
      EXPECT_EQ(*a.quantities[q].name, *b.quantities[q].name);
      EXPECT_EQ(a.quantities[q].value, b.quantities[q].value) << *a.quantities[q].name;
    }
  }
  EXPECT_GE(doubtful, 1U) << "two records of one cell and build differ";
}

TEST(FolderSubjects, AMissingFolderIsAUsageError) {
  EXPECT_THROW(read_subjects("/nowhere/at/all", std::nullopt), UsageError);
}

// What stands under the name of a record costs itself: the comparison is that of all others.
TEST(Gate, ComparesAllThatCanBeReadBesidesWhatCannot) {
  const ResultFolder before, after;
  before.add(record_of({}));
  after.add(record_of({}));
  after.add_file("runs/huge.json", "[1e400]");
  ASSERT_EQ(mkfifo((after.path() / "runs" / "pipe.json").c_str(), 0600), 0);
  std::filesystem::create_symlink("circle.json", after.path() / "runs" / "circle.json");
  const GateResult result = compare_results(before.path(), after.path(), {});
  EXPECT_EQ(result.joined, 1U);
  EXPECT_EQ(result.equal, 1U);
  EXPECT_EQ(result.exit_code, kGood);
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_NE(result.remarks[0].find("3 files"), std::string::npos) << result.remarks[0];
}

}  // namespace
}  // namespace isoline::reports
