// What records say stands in reports without control sequences: somebody will look at them in a
// terminal.
#include <gtest/gtest.h>

#include "core/files.h"
#include "reports/report.h"
#include "tests/reports/fixture.h"

namespace isoline::reports {
namespace {

TEST(ForeignText, StandsInEveryFormatWithoutControlSequences) {
  const ResultFolder folder;
  folder.add(record_of({}));
  folder.add(record_of({.optimizer = "adam[rate=\x1b[31m]",
                        .status = Status::failed,
                        .message = "\x1b[2J\u009b1m and \u202e back"}));
  write_report(document_of(compare_optimizers(read_study({folder.path()}))), folder.path() / "out");
  for (const std::string& name : names_in(folder.path() / "out")) {
    const std::string text = read_text(folder.path() / "out" / name);
    EXPECT_EQ(text.find('\x1b'), std::string::npos) << name;
    if (name.ends_with(".html")) continue;
    EXPECT_EQ(text.find("\u009b"), std::string::npos) << name;
    EXPECT_EQ(text.find("\u202e"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace isoline::reports
