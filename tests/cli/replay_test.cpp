// A record is run again: equal, or the first difference is named.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    const Finished run = shell(
        "./isoline run --problem square,brown-dennis --optimizer newton,gd,inverse-gradient "
        "--iterations 30 --seeds 0..1 --out out --no-report --quiet");
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  // The first record of an optimizer, changed, as FILE.
  void write_changed(const char* optimizer, const std::function<void(Json&)>& change) {
    for (const auto& entry : fs::directory_iterator(shell.folder() / "out" / "runs")) {
      Json record = read_json(entry.path());
      if (record.at("request").at("optimizer").at("name") != optimizer) continue;
      change(record);
      return write_text(shell.folder() / "changed.json", record.dump());
    }
    FAIL() << "no record of " << optimizer;
  }
  Finished replay(const std::string& what = "changed.json") {
    return shell("./isoline replay " + what);
  }

  Shell shell;
};

TEST_F(Replay, OfRecordsOfThisBuildIsEqualAndWritesNothing) {
  const Finished all = replay("out/runs/*.json");
  EXPECT_EQ(all.exit_code, 0) << all.out << all.err;
  EXPECT_EQ(count_lines(all.out), 12U) << all.out;
  EXPECT_TRUE(contains(all.out, "equal, 30 iterations")) << all.out;
  EXPECT_EQ(count_records(shell.folder() / "out"), 12U);
  EXPECT_EQ(shell("./isoline validate out").exit_code, 0);
}

TEST_F(Replay, NamesTheFirstDifference) {
  write_changed("gd", [](Json& record) {
    record["curve"]["loss"][17] = 0.25;
    record["curve"]["step_norm"][20] = 0.5;
  });
  const Finished changed = replay();
  EXPECT_EQ(changed.exit_code, 2) << changed.out;
  EXPECT_TRUE(contains(changed.out, "differs: loss at iteration 17: 0.25 against ")) << changed.out;
}

TEST_F(Replay, SeesWhatIsNotInTheCurve) {
  write_changed("newton", [](Json& record) { record["counts"]["forward"] = 12345; });
  const Finished counts = replay();
  EXPECT_EQ(counts.exit_code, 2) << counts.out;
  EXPECT_TRUE(contains(counts.out, "differs: counts/forward: 12345 against ")) << counts.out;
  write_changed("newton", [](Json& record) { record["verified"]["1e-3"] = false; });
  EXPECT_EQ(replay().exit_code, 2);
}

TEST_F(Replay, OfAnotherBuildIsNotComparableAndStillTold) {
  write_changed("gd", [](Json& record) {
    record["build"] = std::string(16, '0');
    record["build_parts"]["optimizer"] = std::string(16, '1');
  });
  const Finished other = replay();
  EXPECT_EQ(other.exit_code, 4) << other.out;
  EXPECT_TRUE(contains(other.out, "another build computed it, which differs in: optimizer; equal"))
      << other.out;
}

TEST_F(Replay, OfAComponentThatIsNotThereIsNotComparable) {
  write_changed("gd", [](Json& record) { record["request"]["problem"]["name"] = "sqare"; });
  const Finished gone = replay();
  EXPECT_EQ(gone.exit_code, 4) << gone.out;
  EXPECT_TRUE(contains(gone.out, "did you mean 'square'")) << gone.out;
}

TEST_F(Replay, OfARunThatAClockEndedGoesAsFarAsBothWent) {
  write_changed("gd", [](Json& record) {
    record["nondeterministic"] = true;
    record["status"] = "timeout";
    record.erase("trajectory");
    for (auto& [name, column] : record["curve"].items()) {
      if (!column.is_array()) continue;
      Json kept = Json::array();
      for (std::size_t i = 0; i <= 12; ++i) kept.push_back(column[i]);
      column = kept;
    }
    for (auto& [name, column] : record["curve"]["counts"].items())
      column = Json(std::vector<Json>(column.begin(), column.begin() + 13));
    record["curve"]["loss"][12] = 77;  // where it was ended, in the midst of a step
  });
  const Finished part = replay();
  EXPECT_EQ(part.exit_code, 0) << part.out;
  EXPECT_TRUE(contains(part.out, "equal up to iteration 11")) << part.out;
}

TEST_F(Replay, TheWorstOfSeveralIsTheExitCode) {
  write_changed("gd", [](Json& record) { record["curve"]["loss"][3] = 1; });
  const Finished several = replay("changed.json out/runs/*.json");
  EXPECT_EQ(several.exit_code, 2) << several.out;
  EXPECT_EQ(count_lines(several.out), 13U);
  EXPECT_EQ(replay("out").exit_code, 1) << "a folder";
}

}  // namespace
}  // namespace isoline::benchmarks
