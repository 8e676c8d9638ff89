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
  Json only_record(const char* out) const {
    for (const auto& entry : std::filesystem::directory_iterator(shell.folder() / out / "runs"))
      return read_json(entry.path());
    return nullptr;
  }
  Shell shell;
};

TEST_F(OwnProgram, ListsDescribesAndChecksWhatOnlyItHas) {
  shell.expect(kOwn + " list problems --names", {.out = {"twist\n"}});
  EXPECT_FALSE(contains(shell("./isoline list problems --names").out, "twist\n"));
  shell.expect(kOwn + " describe twist", {.out = {"Twist"}});
  shell.expect(kOwn + " check twist");
}

TEST_F(OwnProgram, ItsRecordsNameItsCommandAndItsCommit) {
  shell.expect(kOwn + " run --problem twist --optimizer newton --out out --quiet");
  const Json provenance = only_record("out").at("provenance");
  EXPECT_EQ(provenance.at("commit"), "0f1e2d3c4b5a");
  EXPECT_EQ(provenance.at("dirty"), true);
  EXPECT_EQ(provenance.at("run").at("command"),
            "isoline_own run --problem twist --optimizer newton --out out --quiet");
  shell("./isoline run --problem square --optimizer newton --out plain --quiet --no-report");
  EXPECT_EQ(provenance.at("isoline_commit"), only_record("plain")["provenance"]["commit"]);
  shell.expect("./isoline validate out");
}

TEST_F(OwnProgram, MistakesAreSaidInItsName) {
  const Finished result = shell.expect(kOwn + " rnu", {.exit_code = 1});
  EXPECT_TRUE(result.err.starts_with("isoline_own: ")) << result.err;
}

TEST_F(OwnProgram, ACheckOfWhatThrowsSaysWhatWasThrown) {
  for (const char* check : {" check thrower", " check thrower --json"})
    shell.expect(kOwn + check, {.exit_code = 2, .out = {"it's on purpose"}});
}

}  // namespace
}  // namespace isoline::benchmarks
