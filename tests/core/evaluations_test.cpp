// The store of evaluations: answers bit for bit, whatever is damaged costs itself alone.
#include "core/foreign/evaluations.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <cstring>
#include <limits>
#include <random>

#include "core/files.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

class StoreOfEvaluations : public testing::Test {
 protected:
  struct Answer {
    std::optional<std::string> why;
    std::array<Real, 2> y = {0, 0};
  };
  void SetUp() override { call_report() = {}; }
  Evaluations opened(Evaluations::Settings settings = {}) const {
    settings.folder = folder.path();
    Evaluations store;
    store.begin(settings);
    return store;
  }
  Answer find(Evaluations& store, Real x, Verb verb = Verb::linearize,
              double most_seconds = kForever) const {
    Answer answer;
    const std::array<std::span<const Real>, 2> request = {std::span<const Real>(), {&x, 1}};
    answer.why = store.find(key, verb, request, answer.y, most_seconds);
    return answer;
  }
  void keep(Evaluations& store, Real x, const std::string& why = "", double seconds = 0.5,
            bool is_late = false) const {
    const std::array<Real, 2> y = {2 * x, -x};
    const std::array<std::span<const Real>, 2> request = {std::span<const Real>(), {&x, 1}};
    store.keep(key, Verb::linearize, request, y, why, seconds, is_late);
  }
  void keep_first(int count) const {
    Evaluations store = opened();
    for (int x = 1; x <= count; ++x) keep(store, x);
  }
  int known(int count) const {
    Evaluations store = opened();
    int answered = 0;
    for (int x = 1; x <= count; ++x)
      if (const Answer found = find(store, x); found.why) {
        EXPECT_EQ(found.y, (std::array<Real, 2>{2.0 * x, -1.0 * x}));
        ++answered;
      }
    return answered;
  }
  std::filesystem::path file(int i = 0) const {
    return folder.path() / "evaluations" / (key.stem() + "." + std::to_string(i) + ".calls");
  }

  TemporaryFolder folder;
  EvaluationKey key{"sh model.sh", {}, 3};
};

TEST_F(StoreOfEvaluations, AnswersInAnyOrderSlowCallsAndFailuresAlone) {
  Evaluations store = opened();
  keep(store, 1);
  keep(store, 2, "no mesh");
  keep(store, 3, "", 0.05);
  Evaluations later = opened();
  EXPECT_EQ(find(later, 2).why, "no mesh");
  EXPECT_EQ(find(later, 1).y, (std::array<Real, 2>{2, -1}));
  EXPECT_FALSE(find(later, 3).why) << "it took less than it costs to keep";
  EXPECT_FALSE(find(later, 1, Verb::pullback).why);
  EXPECT_EQ(later.answered_seconds(), 1.0);
  Evaluations retried = opened({.answers_failures = false});
  EXPECT_FALSE(find(retried, 2).why);
  EvaluationKey other = key;
  other.seed = 4;
  std::swap(key, other);
  EXPECT_FALSE(find(later, 1).why) << "of another seed";
}

TEST_F(StoreOfEvaluations, AnswersTheLastCallsHoweverQuick) {
  Evaluations store;
  for (int i = 0; i <= 64; ++i) keep(store, i, i == 2 ? "no mesh" : "", 0);
  EXPECT_FALSE(find(store, 0).why) << "64 calls follow it";
  EXPECT_EQ(find(store, 1).y, (std::array<Real, 2>{2, -1}));
  EXPECT_EQ(find(store, 2).why, "no mesh");
  EXPECT_FALSE(find(store, 1, Verb::pullback).why) << "another program may have to know the point";
  store.begin({});
  EXPECT_FALSE(find(store, 1).why);
}

TEST_F(StoreOfEvaluations, MakesALateCallAgainWhereMoreTimeIsAllowed) {
  Evaluations store = opened();
  keep(store, 1, "late", 5, true);
  EXPECT_EQ(find(store, 1, Verb::linearize, 5).why, "late");
  EXPECT_FALSE(find(store, 1, Verb::linearize, 10).why);
}

TEST_F(StoreOfEvaluations, LosesDamagedEntriesAlone) {
  constexpr int kEntries = 50, kMutations = 300;
  keep_first(kEntries);
  const std::string whole = read_text(file());
  const std::size_t entry = (whole.size() - whole.find('\n') - 1) / kEntries;
  std::mt19937 random(1);
  for (int i = 0; i < kMutations; ++i) {
    std::string damaged = whole;
    const auto at = random() % whole.size();
    const auto cut = random() % (2 * entry);
    int lost = 1;
    if (i % 3 == 0) damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    if (i % 3 == 1) damaged.erase(at, cut);
    if (i % 3 == 2) damaged.insert(at, cut, 'x');
    if (i % 3 == 1) lost += static_cast<int>(cut / entry) + 1;
    write_text(file(), damaged);
    ASSERT_GE(known(kEntries), kEntries - lost) << i << " at " << at << " by " << cut;
  }
  write_text(file(), whole.substr(0, whole.size() - 9));
  keep_first(0);
  Evaluations store = opened();
  keep(store, 51);
  EXPECT_EQ(known(51), 50) << "what was cut short stays, and the next follows it";
}

// As in a folder of somebody else: all sums are right, and the lengths wrap to the right total.
TEST_F(StoreOfEvaluations, RefusesLengthsBeyondTheFile) {
  keep_first(3);
  std::string bytes = read_text(file());
  constexpr std::size_t kLengths = 16, kSum = 56;  // in an entry
  const std::size_t entry = bytes.find('\n') + 1;
  const std::array<std::uint64_t, 2> lengths = {~std::uint64_t{0} - 4095, 24 + 4096};
  std::memcpy(bytes.data() + entry + kLengths, lengths.data(), sizeof lengths);
  const std::uint64_t sum = fnv1a({bytes.data() + entry, kSum}, fnv1a(key.stem()));
  std::memcpy(bytes.data() + entry + kSum, &sum, sizeof sum);
  write_text(file(), bytes);
  EXPECT_EQ(known(3), 2);
}

TEST(RemarksOnCalls, AreSaidOnceEach) {
  testing::internal::CaptureStderr();
  for (const char* sentence : {"one is damaged", "the disk is full", "one is damaged"})
    remark_on_calls(sentence);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "isoline: one is damaged\nisoline: the disk is full\n");
}

TEST_F(StoreOfEvaluations, HasOneWriterPerFileAndManyReaders) {
  Evaluations one = opened(), two = opened();
  keep(one, 1);
  keep(two, 2);
  EXPECT_TRUE(std::filesystem::exists(file(1)));
  keep(one, 3);
  EXPECT_TRUE(find(two, 3).why) << "others write meanwhile";
  EXPECT_EQ(known(3), 3);
}

TEST_F(StoreOfEvaluations, WritesToNoFileOfOthers) {
  std::filesystem::create_directories(file().parent_path());
  const std::filesystem::path thesis = folder.path() / "thesis";
  write_text(thesis, "my thesis");
  std::filesystem::create_symlink(thesis, file(0));
  ASSERT_EQ(mkfifo(file(1).c_str(), 0600), 0);
  std::filesystem::create_hard_link(thesis, file(2));
  std::filesystem::create_directory(file(3));
  keep_first(2);
  EXPECT_EQ(read_text(thesis), "my thesis");
  EXPECT_EQ(known(2), 2);
}

}  // namespace
}  // namespace isoline
