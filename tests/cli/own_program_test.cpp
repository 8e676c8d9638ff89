// A binary with a catalog of its own has every verb, and its records name its own repository.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/records/provenance.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

const std::string kOwn = OWN_BINARY;

class OwnProgram : public testing::Test {
 protected:
  Json only_record() const {
    for (const auto& entry : std::filesystem::directory_iterator(shell.folder() / "out" / "runs"))
      return read_json(entry.path());
    return nullptr;
  }
  Shell shell;
};

TEST_F(OwnProgram, ListsDescribesAndChecksWhatOnlyItHas) {
  EXPECT_TRUE(contains(shell(kOwn + " list problems --names").out, "twist\n"));
  EXPECT_FALSE(contains(shell("./isoline list problems --names").out, "twist\n"));
  EXPECT_TRUE(contains(shell(kOwn + " describe twist").out, "Twist"));
  const Finished checked = shell(kOwn + " check twist");
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
}

TEST_F(OwnProgram, ItsRecordsNameItsCommandAndItsCommit) {
  const Finished run = shell(kOwn + " run --problem twist --optimizer newton --out out --quiet");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json provenance = only_record().at("provenance");
  EXPECT_EQ(provenance.at("commit"), "0f1e2d3c4b5a");
  EXPECT_EQ(provenance.at("dirty"), true);
  EXPECT_EQ(provenance.at("run").at("command"),
            "isoline_own run --problem twist --optimizer newton --out out --quiet");
  shell("./isoline run --problem square --optimizer newton --out plain --quiet --no-report");
  for (const auto& entry : std::filesystem::directory_iterator(shell.folder() / "plain" / "runs"))
    EXPECT_EQ(provenance.at("isoline_commit"), read_json(entry.path())["provenance"]["commit"]);
  EXPECT_EQ(shell("./isoline validate out").exit_code, 0);
}

TEST_F(OwnProgram, MistakesAreSaidInItsName) {
  const Finished result = shell(kOwn + " rnu");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.err.starts_with("isoline_own: ")) << result.err;
}

TEST_F(OwnProgram, ACheckOfWhatThrowsSaysWhatWasThrown) {
  const Finished words = shell(kOwn + " check thrower");
  EXPECT_EQ(words.exit_code, 2) << words.err;
  EXPECT_TRUE(contains(words.out, "it's on purpose")) << words.out;
  const Json json = parse_json(shell(kOwn + " check thrower --json").out, "check");
  EXPECT_TRUE(contains(json.dump(), "it's on purpose")) << json.dump();
}

}  // namespace
}  // namespace isoline::benchmarks
