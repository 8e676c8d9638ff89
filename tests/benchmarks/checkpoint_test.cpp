// A run that was stopped and gone on leaves the trace of one that was not, bit for bit.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "benchmarks/plan/suite.h"
#include "benchmarks/run/execute.h"
#include "core/digest.h"
#include "core/files.h"
#include "core/json.h"
#include "tests/benchmarks/builtin.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

Request request_of(const std::string& problem, const std::string& optimizer) {
  const Suite suite{.name = "mine",
                    .title = "",
                    .blocks = {{.problems = {problem},
                                .optimizers = {optimizer},
                                .budget = {.iterations = 30, .target = 0}}}};
  return expand(catalog(), suite, {}).at(0);
}

Json trace_of(const Request& request, Checkpoint checkpoint) {
  const auto trace = std::make_unique<Trace>();
  execute(catalog(), request, *trace, std::move(checkpoint));
  Json record = without_timings(to_json(record_of(request, *trace)));
  record.erase("provenance");
  return record;
}

// Asked to stop at every step, so that it goes on as often as it has iterations.
Json trace_in_pieces(const Request& request, const fs::path& file) {
  Json record;
  int pieces = 0;
  do {
    Checkpoint checkpoint(file, "cell", 0);
    std::raise(SIGTERM);
    record = trace_of(request, std::move(checkpoint));
  } while (++pieces < 100 && record.at("status") == "interrupted");
  EXPECT_GT(pieces, 20);
  return record;
}

class Stopped : public testing::TestWithParam<const char*> {};

TEST_P(Stopped, AndGoneOnGivesTheSameTrace) {
  const TemporaryFolder folder;
  const Request request =
      request_of("sine[mode=learn,xi=4,batch=5,network=mlp[layers=6]]", GetParam());
  const Json whole = trace_of(request, {});
  ASSERT_EQ(whole.at("status"), "budget") << whole.at("message");
  EXPECT_EQ(trace_in_pieces(request, folder.path() / "state"), whole);
}

INSTANTIATE_TEST_SUITE_P(Methods, Stopped,
                         testing::Values("adam", "adadelta", "momentum[rate=1e-6]", "gd[rate=1e-5]",
                                         "rmsprop", "sip[inverse=newton,proxy=l1]", "supervised",
                                         "adahessian", "hessian-free", "kfac", "hig",
                                         "levenberg-marquardt"));

TEST(Checkpoint, OfAnotherCellOrDamagedIsLeftAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  const Json whole = trace_of(request, {});
  for (const std::string text :
       {"", "isoline.checkpoint/2 other\n", "isoline.checkpoint/2 cell\nshort"}) {
    write_text(file, text);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << text;
  }
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

void write_state(const fs::path& file, const Kept& kept, const std::string& state) {
  write_text(file, kept.heading + digest(state) + state);
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
    write_state(file, kept, states[i]);
    EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 1e9)), whole) << i;
    EXPECT_FALSE(fs::exists(file)) << i;
    EXPECT_EQ(read_text(damaged).substr(kept.heading.size() + 16), states[i]) << i;
  }
}

TEST(Checkpoint, ThatCannotBeReadCostsNothing) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "state";
  const Request request = request_of("exponential[mode=learn,batch=5]", "adam");
  fs::create_directory(file);
  EXPECT_EQ(trace_of(request, Checkpoint(file, "cell", 0)), trace_of(request, {}));
}

}  // namespace
}  // namespace isoline::benchmarks
