// What a component says is kept as valid text, whatever it says: no run ends on it.
#include <gtest/gtest.h>

#include "benchmarks/run/run_plan.h"
#include "core/files.h"
#include "core/text.h"
#include "tests/benchmarks/hostile.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

// Leaves with a message that no terminal, and no JSON, would take.
struct Babbler {
  std::string message = "bytes";

  struct State {};
  State init(Meter&, const Vector&) const { return {}; }
  Status step(Meter& f, Vector& theta, State&) const {
    Linearization at;
    f.linearize(theta, at);
    if (message == "bytes") throw std::runtime_error("no text: \xff\xfe");
    if (message == "cut") throw std::runtime_error("x" + repeated("θ", 2000));  // cut within one
    throw std::runtime_error("\x1b[2J\x1b]0;owned\x07");
  }
  static std::string repeated(const std::string& part, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += part;
    return text;
  }
};

void fields(Babbler& o, auto& field) {
  field("message", o.message, Choices{"bytes", "cut", "escapes"}, "what it says");
}

Catalog with_babbler() {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(stepper_entry<Babbler>({.name = "babbler",
                                                 .title = "Says anything",
                                                 .formula = "none",
                                                 .source = "here",
                                                 .needs = {Oracle::forward, Oracle::pullback}}));
  return catalog;
}

TEST(ForeignText, OfAComponentEndsNoRunAndNoResume) {
  const Catalog catalog = with_babbler();
  const TemporaryFolder folder;
  std::vector<Request> requests{request_for(catalog, "square", {}, "gd", {})};
  for (const char* message : {"bytes", "cut", "escapes"})
    requests.push_back(request_for(catalog, "square", {}, "babbler", {{"message", message}}));
  for (const std::int64_t again : {0, 1}) {
    const Outcome outcome = run_plan(catalog, "babble", requests, folder.path(), {});
    EXPECT_EQ(outcome.statuses.at(Status::failed), 3) << again;
    EXPECT_TRUE(outcome.remarks.empty()) << outcome.remarks[0];
    EXPECT_EQ(outcome.reused, again * 4) << "failures of this build are not repeated";
  }
  std::size_t cut_short = 0;
  for (const std::string& name : names_in(folder.path() / "runs")) {
    const std::string message = read_record(folder.path() / "runs" / name).message;
    EXPECT_EQ(valid_utf8(message), message);
    EXPECT_EQ(message.find('\xff'), std::string::npos);
    if (!message.starts_with("xθ")) continue;
    ++cut_short;
    EXPECT_TRUE(message.ends_with("θ")) << "it is cut at a character";
    EXPECT_LT(message.size(), 1024U);
  }
  EXPECT_EQ(cut_short, 1U);
}

}  // namespace
}  // namespace isoline::benchmarks
