// Damage in a result folder costs the damaged file: it is named, kept aside, and its cell is run
// again. What is somebody else's stays where it is.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "benchmarks/run/run_plan.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const std::vector<Request>& requests() {
  static const std::vector<Request> all{request_for(catalog(), "square", {}, "gd", {}),
                                        request_for(catalog(), "square", {}, "adam", {})};
  return all;
}

Outcome run_in(const fs::path& folder) {
  return run_plan(catalog(), "two", requests(), folder, {});
}

fs::path only_record_of(const fs::path& folder, const Request& request) {
  for (const std::string& name : names_in(folder / "runs"))
    if (name.starts_with(request.cell)) return folder / "runs" / name;
  return {};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// What may be wrong with a record: each ended the run that met it, or was reused.
std::vector<std::pair<std::string, std::string>> damages_of(const std::string& sound) {
  const std::string seed = "\"seed\":0";
  return {
      {"torn", sound.substr(0, sound.size() / 2)},
      {"empty", ""},
      {"1e400", replaced(sound, "\"rejected_steps\":0", "\"rejected_steps\":1e400")},
      {"a seed of 400 digits", replaced(sound, seed, "\"seed\":" + std::string(400, '9'))},
      {"a window that is no number",
       replaced(sound, "\"curve\":{", "\"curve\":{\"batch_loss\":{\"wide\":[1]},")},
      {"columns of other lengths", replaced(sound, "\"gradient_norm\":[", "\"gradient_norm\":[1,")},
      {"no UTF-8", replaced(sound, "\"message\":\"", "\"message\":\"\xff")},
      {"never ended", replaced(sound, "\"status\":\"budget\"", "\"status\":\"running\"")},
      {"another cell", replaced(sound, "\"cell\":\"", "\"cell\":\"0")},
      {"nested", std::string(200'000, '[')}};
}

TEST(Damaged, RecordsAreNamedKeptAsideAndRunAgain) {
  const TemporaryFolder owned;
  run_in(owned.path());
  const fs::path file = only_record_of(owned.path(), requests()[0]);
  const std::string sound = read_text(file);
  std::size_t count = 0;
  for (const auto& [what, text] : damages_of(sound)) {
    write_text(file, text);
    const Outcome outcome = run_in(owned.path());
    EXPECT_EQ(outcome.run, 1) << what;
    EXPECT_EQ(outcome.reused, 1) << what;
    ASSERT_EQ(outcome.remarks.size(), 1U) << what;
    EXPECT_NE(outcome.remarks[0].find(file.string()), std::string::npos) << outcome.remarks[0];
    EXPECT_NO_THROW(read_record(file)) << what;
    EXPECT_EQ(names_in(owned.path() / "damaged").size(), ++count) << what;
  }
  EXPECT_EQ(read_text(owned.path() / "damaged" / file.filename()),
            sound.substr(0, sound.size() / 2))
      << "nothing there is overwritten";
}

TEST(Damaged, PipesFoldersAndLinksInACircleUnderTheNameOfARecordAreMovedAway) {
  const TemporaryFolder owned;
  run_in(owned.path());
  const fs::path file = only_record_of(owned.path(), requests()[0]);
  const std::vector<std::function<void()>> oddities{
      [&] { ASSERT_EQ(mkfifo(file.c_str(), 0600), 0); }, [&] { fs::create_directory(file); },
      [&] { fs::create_symlink(file.filename(), file); },
      [&] { fs::create_symlink("/dev/zero", file); }};
  for (const auto& put : oddities) {
    fs::remove(file);
    put();
    const Outcome outcome = run_in(owned.path());
    EXPECT_EQ(outcome.run, 1);
    ASSERT_EQ(outcome.remarks.size(), 1U);
    EXPECT_EQ(fs::symlink_status(file).type(), fs::file_type::regular);
    EXPECT_NO_THROW(read_record(file));
  }
  EXPECT_EQ(names_in(owned.path() / "damaged").size(), oddities.size());
}

TEST(Damaged, APlanIsNamedKeptAsideAndWrittenAnew) {
  const TemporaryFolder owned;
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string("{\"schema\": \"isoline.plan/1\"}"),
        std::string(200'000, '[')}) {
    fs::create_directories(owned.path());
    write_text(owned.path() / "plan.json", text);
    const Outcome outcome = run_in(owned.path());
    ASSERT_EQ(outcome.remarks.size(), 1U);
    EXPECT_NE(outcome.remarks[0].find("plan.json"), std::string::npos) << outcome.remarks[0];
    EXPECT_EQ(plan_from_text(read_text(owned.path() / "plan.json"), "it").cells.size(), 2U);
  }
  EXPECT_EQ(names_in(owned.path() / "damaged").size(), 4U);
}

TEST(Damaged, SheetsAndRatesAreKeptAsideToo) {
  const TemporaryFolder owned;
  run_in(owned.path());
  for (const std::string& name : names_in(owned.path() / "components"))
    write_text(owned.path() / "components" / name, "torn");
  write_text(owned.path() / "rates.json", "{\"rows\": [1]}");
  Store store(owned.path());
  write_used_rates(Rates::builtin(), requests(), store);
  EXPECT_EQ(store.remarks().size(), 1U);
  const Outcome outcome = run_in(owned.path());
  EXPECT_EQ(outcome.reused, 2);
  EXPECT_EQ(outcome.remarks.size(), 1U) << "the problem's, whose prices would be kept";
  EXPECT_EQ(names_in(owned.path() / "damaged").size(), 2U);
}

// A folder, removed without a warning by whoever looked for temporaries below it.
TEST(Store, NothingIsRemovedThatIsNotItsOwn) {
  const TemporaryFolder owned;
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  waitpid(gone, nullptr, 0);
  const std::vector<std::string> others{
      "thesis.tmp",
      "chapters/thesis.tmp",
      "chapters/one.tex.1.tmp",
      fmt::format("runs/a.json.{}.tmp", gone),
      fmt::format("runs/a.json.00000000-{}.tmp", gone),
      fs::relative(temporary_of(owned.path() / "runs" / "mine.json"), owned.path()).string()};
  for (const std::string& name : others) {
    fs::create_directories((owned.path() / name).parent_path());
    write_text(owned.path() / name, "somebody's");
  }
  const Store store(owned.path());
  for (const std::string& name : others) EXPECT_TRUE(is_there(owned.path() / name)) << name;
}

TEST(Store, WhatAKilledRunLeftHalfWrittenIsRemoved) {
  const TemporaryFolder owned;
  fs::create_directories(owned.path() / "runs");
  const pid_t killed = fork();
  if (killed == 0) {
    write_text(temporary_of(owned.path() / "runs" / "a.json"), "half");
    write_text(temporary_of(owned.path() / "plan.json"), "half");
    _exit(0);
  }
  waitpid(killed, nullptr, 0);
  EXPECT_EQ(names_in(owned.path() / "runs").size(), 1U);
  const Store store(owned.path());
  EXPECT_TRUE(names_in(owned.path() / "runs").empty());
  EXPECT_EQ(names_in(owned.path()),
            (std::vector<std::string>{"checkpoints", "components", "runs"}));
}

// --- What a component says is kept as valid text, whatever it says: no run ends on it.

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
