// Damage in a result folder affects the damaged file only: it is named and kept aside, and its cell
// is run again. Files of other programs stay. Several runs in one folder share the work.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/merge/merge.h"
#include "benchmarks/run/run_plan.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/random.h"
#include "core/records/sheet.h"
#include "core/text.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"
#include "tests/reports/fixture.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
using reports::plan_of;
using reports::record_of;
using reports::ResultFolder;

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
      {"two seeds", replaced(sound, seed, seed + "," + seed)},
      {"no specification", replaced(sound, "\"spec\":\"", "\"spec\":\"[")},
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

// A folder that a search for temporary files below it once removed without a warning.
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
    write_text(owned.path() / name, "foreign");
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

// --- The message of a component is kept as valid text: no message ends a run.

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
  State init(Meter&, const Vector& theta) const {
    if (theta.size() == 4) ++told();  // else it is rehearsed
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
      Request request = request_for(catalog, "wood", {}, "counting", {});
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
  // Those that its workers had in hand, and those whose records waited to be written together.
  EXPECT_LE(told(), static_cast<int>(requests.size()) + 12);
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
  const Outcome outcome =
      run_plan(catalog, "test", requests, out, {.jobs = 2, .isolates_cells = true});
  status_of(remover);
  EXPECT_GE(outcome.missing.size(), 4U);
  EXPECT_EQ(plan_from_text(read_text(out / "plan.json"), "plan").cells.size(), requests.size());
  const Outcome again = run_plan(catalog, "test", requests, out, {.jobs = 2});
  EXPECT_TRUE(again.missing.empty());
  EXPECT_EQ(again.run, static_cast<std::int64_t>(outcome.missing.size()));
}

// The union of result folders does not depend on their order and never chooses between results. A
// damaged file affects only itself.

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

// The rates of its plan: each method has rates in half of the folders, and those of c differ.
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
  EXPECT_NE(outcome.conflicts[0].sentence.find("audits"), std::string::npos);
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

// The progress function ends the process at the first file, in the middle of the work.
TEST_F(Merge, ThatIsAskedToEndLeavesNothingBehind) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) a.add(record_of({.seed = seed}));
  const auto killed = [](std::size_t, std::size_t) { std::raise(SIGTERM); };
  EXPECT_TRUE(merge_folders({a.path()}, owned.path() / "out", killed).is_interrupted);
  EXPECT_TRUE(names_in(owned.path()).empty());
}

// --- foreign files

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
  EXPECT_TRUE(is_named(outcome.unreadable, "a symbolic link"));
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
  EXPECT_FALSE(is_named(outcome.unreadable, "exception"));  // of the library of JSON
}

}  // namespace
}  // namespace isoline::benchmarks
