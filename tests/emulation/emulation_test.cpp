// The portable build gives the same bits on every processor: cells of every kind run natively and
// by qemu's user-mode emulation of others, and each record names the processor that its worker saw.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "core/records/record.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kEmulator = "qemu-x86_64";

// A run of the suite beside this file, by cell.
struct Results {
  std::map<std::string, Record> records;
  Finished finished;
};

// `prefix` stands before the program: nothing, or the emulator and its processor.
Results results_of(const Shell& shell, const std::string& prefix, const std::string& out) {
  const std::string suite = ISOLINE_SOURCE_DIR "/tests/emulation/cells.json";
  Results results;
  results.finished =
      shell(fmt::format("{} ./isoline run {} --out {} --no-report --quiet", prefix, suite, out));
  const auto runs = shell.folder() / out / "runs";
  if (!std::filesystem::exists(runs)) return results;
  for (const auto& entry : std::filesystem::directory_iterator(runs)) {
    if (entry.path().extension() != ".json") continue;  // pictures stand beside
    Record record = read_record(entry.path());
    results.records.emplace(record.cell, std::move(record));
  }
  return results;
}

const Results& native_results() {
  static const Shell shell;
  static const Results results = results_of(shell, "", "native");
  return results;
}

// All of a record but its times and what it says of its machine.
std::string bits_of(const Record& record) {
  Json json = without_timings(to_json(record));
  json.erase("provenance");
  json.erase("build");
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string title_of(const Record& record) {
  return record.request.problem.spec + " × " + record.request.optimizer.spec;
}

// The first line in which the two differ, from each.
std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream left(a), right(b);
  std::string from_left, from_right;
  while (std::getline(left, from_left) && std::getline(right, from_right))
    if (from_left != from_right) return fmt::format("{}  /  {}", from_left, from_right);
  return "one ends before the other";
}

// How many of the emulated records have the native bits.
std::size_t count_equal(const Results& native, const Results& emulated) {
  std::size_t equal = 0;
  for (const auto& [cell, record] : emulated.records) {
    const auto other = native.records.find(cell);
    if (other == native.records.end()) continue;
    const std::string here = bits_of(other->second), there = bits_of(record);
    equal += here == there;
    EXPECT_TRUE(here == there) << title_of(record) << ": " << first_difference(here, there);
  }
  return equal;
}

struct Processor {
  const char* name;   // as the emulator calls it
  const char* brand;  // as it calls itself
};

void PrintTo(const Processor& processor, std::ostream* out) { *out << processor.name; }

class Emulation : public testing::TestWithParam<Processor> {};

TEST_P(Emulation, GivesTheBitsOfThisProcessor) {
  constexpr std::size_t kLeastCells = 40;
  const Shell shell;
  if (shell(fmt::format("command -v {}", kEmulator)).exit_code != 0)
    GTEST_SKIP() << kEmulator << " is not installed (Debian's package qemu-user)";
  const Results& native = native_results();
  ASSERT_GE(native.records.size(), kLeastCells) << native.finished.err;
  const Results emulated =
      results_of(shell, fmt::format("{} -cpu {}", kEmulator, GetParam().name), "emulated");
  ASSERT_EQ(emulated.records.size(), native.records.size()) << emulated.finished.err;
  for (const auto& [cell, record] : emulated.records)
    ASSERT_EQ(record.provenance.build->processor, GetParam().brand)
        << title_of(record) << " left the emulator";
  EXPECT_EQ(count_equal(native, emulated), native.records.size());
}

INSTANTIATE_TEST_SUITE_P(On, Emulation,
                         testing::Values(Processor{"Haswell", "Intel Core Processor (Haswell)"},
                                         Processor{"EPYC", "AMD EPYC Processor"},
                                         Processor{"Skylake-Server",
                                                   "Intel Xeon Processor (Skylake)"}),
                         [](const auto& each) {
                           std::string name = each.param.name;
                           std::erase(name, '-');
                           return name;
                         });

// What the suite must hold: the sensitive methods on the sensitive problems, and every network.
TEST(EmulatedCells, AreOfEveryKind) {
  std::set<std::string> problems, optimizers;
  std::size_t run = 0;
  for (const auto& [cell, record] : native_results().records) {
    EXPECT_FALSE(is_failure(record.status)) << title_of(record) << ": " << record.message;
    EXPECT_FALSE(record.is_nondeterministic) << title_of(record);
    if (record.status == Status::inapplicable) continue;
    ++run;
    problems.insert(record.request.problem.name);
    optimizers.insert(record.request.optimizer.name);
  }
  EXPECT_GE(run, 40U);
  for (const char* name : {"poisson", "heat", "hig-toy", "sine"})
    EXPECT_TRUE(problems.contains(name));
  for (const char* name : {"newton", "saddle-free-newton", "gauss-newton", "ceres-gauss-newton",
                           "ceres-subspace-dogleg", "hig", "sip", "kfac", "nlopt-lbfgs"})
    EXPECT_TRUE(optimizers.contains(name)) << name;
}

}  // namespace
}  // namespace isoline::benchmarks
