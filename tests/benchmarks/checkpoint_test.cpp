// A run that was stopped and gone on leaves the trace of one that was not, bit for bit.
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "benchmarks/run/runner.h"
#include "core/files.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

Request request_of(const std::string& problem, const std::string& optimizer) {
  return cell_of(problem, optimizer, {.iterations = 30, .target = 0});
}

Json trace_of(const Record& run) {
  Json record = without_timings(to_json(run));
  record.erase("provenance");
  return record;
}

Json trace_of(const Request& request, Checkpoint checkpoint) {
  return trace_of(executed(catalog(), request, std::move(checkpoint)));
}

class Stopped : public testing::TestWithParam<const char*> {};

TEST_P(Stopped, AndGoneOnGivesTheSameTrace) {
  const Request request =
      request_of("sine[mode=learn,xi=4,batch=5,network=mlp[layers=6]]", GetParam());
  const Json whole = trace_of(request, {});
  ASSERT_EQ(whole.at("status"), "budget") << whole.at("message");
  EXPECT_EQ(trace_of(executed_in_pieces(catalog(), request)), whole);
}

INSTANTIATE_TEST_SUITE_P(Methods, Stopped,
                         testing::Values("adam", "adadelta", "momentum[rate=1e-6]", "gd[rate=1e-5]",
                                         "rmsprop", "sip[inverse=newton,proxy=l1]", "supervised",
                                         "adahessian", "hessian-free", "kfac", "hig",
                                         "levenberg-marquardt"));

TEST(Checkpoint, OfAnotherCellOrDamagedOrUnreadableIsLeftAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  for (const std::string text :
       {"", "isoline.checkpoint/2 other\n", "isoline.checkpoint/2 cell\nshort"}) {
    write_text(file, text);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << text;
  }
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 0)), whole);
}

// --- files with the right digest that hold something else

// The checkpoint of a run that was stopped after its first step; what stands before its state.
struct Kept {
  std::string heading, state;
};
Kept kept_checkpoint(const Request& request, const fs::path& file) {
  constexpr std::size_t kDigits = 16;
  Checkpoint checkpoint(file, "cell", 0);
  std::raise(SIGTERM);
  EXPECT_EQ(trace_of(request, std::move(checkpoint)).at("status"), "interrupted");
  const std::string text = read_text(file);
  const std::size_t end = text.find('\n') + 1;
  return {text.substr(0, end), text.substr(end + kDigits)};
}

template <class Number>
std::string with_number(std::string state, std::size_t at, Number number) {
  std::memcpy(state.data() + at, &number, sizeof number);
  return state;
}

TEST(Checkpoint, ThatCannotBeRestoredIsSetAsideAndTheRunStartsFromItsBeginning) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state", damaged = folder.path() / "state.damaged";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  const Kept kept = kept_checkpoint(request, file);
  const std::size_t size = kept.state.size(), trace = size - sizeof(Trace);
  const std::vector<std::string> states = {
      with_number(kept.state, 0, std::int64_t{1} << 40),  // rows of θ
      with_number(kept.state, 0, std::int64_t{-1}),       // the same
      with_number(kept.state, 8, std::int64_t{1} << 62),  // columns of θ
      with_number(kept.state, 0, std::int64_t{1}),        // another number of unknowns
      kept.state.substr(0, size / 2),                     // it ends too early
      kept.state + "more",                                // it goes on
      with_number(kept.state, trace + offsetof(Trace, points), 1'000'000'000)};
  for (std::size_t i = 0; i < states.size(); ++i) {
    write_text(file, kept.heading + digest(states[i]) + states[i]);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << i;
    EXPECT_FALSE(fs::exists(file)) << i;
    EXPECT_EQ(read_text(damaged).substr(kept.heading.size() + 16), states[i]) << i;
  }
}

// --- Results do not depend on how the work was cut: jobs and repetitions leave the same records.

std::vector<Request> matrix() {
  const Suite suite{.name = "test",
                    .title = "",
                    .blocks = {{.problems = {"square"},
                                .optimizers = {"*"},
                                .seeds = {0, 1, 2},
                                .budget = {.iterations = 200, .work = 2000}}}};
  return expand(catalog(), suite, {});
}

std::vector<std::string> records_in(const fs::path& folder) {
  std::vector<std::string> names = names_in(folder / "runs");  // none where it is not there yet
  std::erase_if(names, [](const std::string& name) { return !name.ends_with(".json"); });
  return names;
}

// Every record of a folder, timings aside, by file name.
std::map<std::string, Json> results(const fs::path& folder) {
  std::map<std::string, Json> all;
  for (const std::string& name : records_in(folder))
    all[name] = without_timings(read_json(folder / "runs" / name));
  return all;
}

class Resume : public testing::Test {
 protected:
  Outcome run(const fs::path& folder, int jobs) {
    Store store(folder);
    return run_all(catalog(), requests, store, {.jobs = jobs});
  }
  std::vector<Request> requests = matrix();
  TemporaryFolder first, second;
};

TEST_F(Resume, OneJobAndTwoJobsGiveTheSameRecordsAndDoneCellsAreNotRepeated) {
  run(first.path(), 1);
  const Outcome whole = run(second.path(), 2), again = run(second.path(), 2);
  EXPECT_EQ(results(first.path()), results(second.path()));
  EXPECT_EQ(whole.run, static_cast<std::int64_t>(requests.size()));
  EXPECT_EQ(again.run, 0);
  EXPECT_EQ(again.reused, whole.run);
  EXPECT_EQ(again.statuses, whole.statuses);
}

TEST_F(Resume, RepetitionsAppendTheirTimings) {
  Store store(first.path());
  requests.resize(1);
  run_all(catalog(), requests, store, {.repeat = 2});
  const Outcome outcome = run_all(catalog(), requests, store, {.repeat = 5});
  EXPECT_EQ(outcome.run, 3);
  EXPECT_TRUE(outcome.conflicts.empty());
  const auto record = store.find(requests[0]);
  EXPECT_EQ(record->repeat_wall_seconds.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(record->repeat_wall_seconds));
}

}  // namespace
}  // namespace isoline::benchmarks
