// Damage in a result folder costs the damaged file: it is named, kept aside, and its cell is run
// again. What is somebody else's stays where it is. Several runs in one folder share the work, and
// what vanishes under them is missed.
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "benchmarks/run/run_plan.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"

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

TEST(Damaged, RecordsAndWhatStandsUnderTheirNamesAreNamedKeptAsideAndRunAgain) {
  const TemporaryFolder owned;
  run_in(owned.path());
  const fs::path file = only_record_of(owned.path(), requests()[0]);
  const std::string sound = read_text(file);
  std::size_t count = 0;
  const auto expect_run_again = [&](const std::string& what) {
    const Outcome outcome = run_in(owned.path());
    EXPECT_EQ(outcome.run, 1) << what;
    EXPECT_EQ(outcome.reused, 1) << what;
    ASSERT_EQ(outcome.remarks.size(), 1U) << what;
    EXPECT_NE(outcome.remarks[0].find(file.string()), std::string::npos) << outcome.remarks[0];
    EXPECT_EQ(fs::symlink_status(file).type(), fs::file_type::regular) << what;
    EXPECT_NO_THROW(read_record(file)) << what;
    EXPECT_EQ(names_in(owned.path() / "damaged").size(), ++count) << what;
  };
  for (const auto& [what, text] : damages_of(sound)) {
    write_text(file, text);
    expect_run_again(what);
  }
  EXPECT_EQ(read_text(owned.path() / "damaged" / file.filename()),
            sound.substr(0, sound.size() / 2))
      << "nothing there is overwritten";
  const std::vector<std::function<void()>> oddities{
      [&] { ASSERT_EQ(mkfifo(file.c_str(), 0600), 0); }, [&] { fs::create_directory(file); },
      [&] { fs::create_symlink(file.filename(), file); },
      [&] { fs::create_symlink("/dev/zero", file); }};
  for (const auto& put : oddities) {
    fs::remove(file);
    put();
    expect_run_again("an oddity");
  }
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
  const pid_t gone = forked([] {});
  status_of(gone);
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
  status_of(forked([&] {
    for (const char* name : {"runs/a.json", "plan.json"})
      write_text(temporary_of(owned.path() / name), "half");
  }));
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
    std::string text = message == "bytes" ? "no text: \xff\xfe" : "\x1b[2J\x1b]0;owned\x07";
    if (message == "cut") text = "x";  // cut within a letter
    for (int i = 0; message == "cut" && i < 2000; ++i) text += "θ";
    throw std::runtime_error(text);
  }
};

void fields(Babbler& o, auto& field) {
  field("message", o.message, Choices{"bytes", "cut", "escapes"}, "what it says");
}

TEST(ForeignText, OfAComponentEndsNoRunAndNoResume) {
  Catalog catalog = builtin_catalog();
  catalog.optimizers.add(
      stepper_entry<Babbler>({.name = "babbler", .needs = {Oracle::forward, Oracle::pullback}}));
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

// --- folders that several runs share

// Tells how often it ran.
struct Counting {
  struct State {};
  State init(Meter&, const Vector&) const {
    ++told();
    return {};
  }
  Status step(Meter&, Vector&, State&) const {
    usleep(2000);
    return Status::running;
  }
};
void fields(Counting&, auto&) {}

class SharedFolder : public testing::Test {
 protected:
  SharedFolder() {
    catalog.optimizers.add(stepper_entry<Counting>({.name = "counting"}));
    told() = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      Request request = request_for(catalog, "rosenbrock", {}, "counting", {});
      request.seed = seed;
      request.budget.iterations = 5;
      requests.push_back(named(std::move(request)));
    }
  }
  Outcome run_here() {
    Store store(folder.path());
    return run_all(catalog, requests, store, {.jobs = 2});
  }
  pid_t run_elsewhere() {
    return forked([&] { run_here(); });
  }

  Catalog catalog = hostile_catalog();
  TemporaryFolder folder;
  std::vector<Request> requests;
};

TEST_F(SharedFolder, ThreeRunsAtOnceDoEachCellOnce) {
  const pid_t others[] = {run_elsewhere(), run_elsewhere()};
  const Outcome outcome = run_here();
  for (const pid_t other : others) status_of(other);
  EXPECT_EQ(told(), static_cast<int>(requests.size()));
  EXPECT_EQ(outcome.run + outcome.reused, static_cast<std::int64_t>(requests.size()));
  EXPECT_TRUE(outcome.missing.empty());
  EXPECT_EQ(outcome.statuses.at(Status::budget), static_cast<std::int64_t>(requests.size()));
}

TEST_F(SharedFolder, CellsOfARunThatWasKilledAreTakenOver) {
  const pid_t other = run_elsewhere();
  wait_until([&] { return told() >= 3; });
  kill(other, SIGKILL);
  status_of(other);
  const Outcome outcome = run_here();
  EXPECT_EQ(outcome.statuses.at(Status::budget), static_cast<std::int64_t>(requests.size()));
  EXPECT_LE(told(),
            static_cast<int>(requests.size()) + 3);  // those that its three workers had in hand
}

TEST_F(SharedFolder, ACellThatAnotherProcessHoldsIsWaitedFor) {
  requests.resize(1);
  Store store(folder.path());
  const pid_t other = forked([&] {
    Holds holds(store.folder());
    told() = holds.take(Store::name_of(requests[0])) ? 1 : -1;
    usleep(500'000);
  });
  wait_until([] { return told() != 0; });
  ASSERT_EQ(told(), 1);
  EXPECT_FALSE(Holds(store.folder()).take(Store::name_of(requests[0])));
  const Outcome outcome = run_all(catalog, requests, store, {});
  EXPECT_EQ(waitpid(other, nullptr, WNOHANG), other) << "it ran before the other had let go";
  EXPECT_EQ(outcome.run, 1);
}

TEST_F(SharedFolder, RecordsThatVanishWhileItRunsAreMissed) {
  const fs::path out = folder.path() / "out";
  const pid_t remover = forked([&] {
    alarm(120);
    std::error_code error;
    while (std::distance(fs::directory_iterator(out / "runs", error), {}) < 5) usleep(200);
    // It ends at a file that is renamed meanwhile, and leaves the rest.
    while (fs::remove_all(out, error), error) usleep(200);
  });
  const Outcome outcome = run_plan(catalog, "test", requests, out, {.jobs = 2});
  status_of(remover);
  EXPECT_GE(outcome.missing.size(), 4U);
  EXPECT_EQ(plan_from_text(read_text(out / "plan.json"), "plan").cells.size(), requests.size());
  const Outcome again = run_plan(catalog, "test", requests, out, {.jobs = 2});
  EXPECT_TRUE(again.missing.empty());
  EXPECT_EQ(again.run, static_cast<std::int64_t>(outcome.missing.size()));
}

}  // namespace
}  // namespace isoline::benchmarks
