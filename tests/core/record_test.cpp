// Records, requests and plans are read back as written, the schemas agree with the fields, and the
// fields and pictures beside a record are read back or refused. After a field is added the schemas
// are renewed by
//   ISOLINE_RENEW_SCHEMAS=1 build/release/tests/core_tests --gtest_filter='Schemas.*'
#include "core/records/record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "core/failures.h"
#include "core/files.h"
#include "core/frames.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/records/npy.h"
#include "core/records/request.h"
#include "core/records/sheet.h"
#include "core/results/profile.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

Record sample() {
  Record record{.cell = "0123456789abcdef", .build = "fedcba9876543210"};
  record.request = {.problem = {"square", {}, "square", "square"},
                    .optimizer = {"gd", {{"rate", 0.1}}, "gd[rate=0.1]", "gd[rate=0.1]"},
                    .seed = 7};
  record.status = Status::diverged;
  record.message = "went \"away\"";
  record.minimum = 0;
  record.verified = {{"1e-1", true}, {"1e-3", false}, {"1e-6", std::nullopt}};
  record.counts[0] = 3;
  record.summary = {.iterations = 1, .loss = INFINITY, .x_error = NAN, .wall_seconds = 0.5};
  record.curve = {.iteration = {0, 1},
                  .work = {0, 2},
                  .counts = {{"forward", {0, 1}}},
                  .rounds = {{"8", {0, 1}}},
                  .wall_seconds = {0, 0.5},
                  .processor_seconds = {0, 0.25},
                  .loss = {1, INFINITY},
                  .x_error = {NAN, NAN},
                  .gradient_norm = {1, 2},
                  .step_norm = {0, 1}};
  record.hits = Hits{.target = {1, 0.1},
                     .iteration = {0, -1},
                     .work = {0, -1},
                     .forwards = {0, -1},
                     .counts = {{"forward", {0, -1}}},
                     .rounds = {{"8", {0, -1}}},
                     .wall_seconds = {0, NAN}};
  record.trajectory = Trajectory{{{1, 2}, {3, 4}}, {{1}, {-INFINITY}}};
  record.answer = AnswerPoints{.unknowns = 2,
                               .names = {"k", "c"},
                               .units = {"N/m", ""},
                               .points = {kReturned, kBest},
                               .x = {{1, 0.1}, {3, 4}},
                               .residual_norm = 0.5};
  record.failures = Failures{.total = 3, .x = {{1, NAN}, {2, 3}}, .reasons = {"no mesh", ""}};
  record.repeat_wall_seconds = {0.5};
  record.provenance = Provenance(Build{.version = "0"});
  record.provenance.run.concurrent_jobs = 2;
  return record;
}

TEST(Record, SurvivesTheRoundTrip) {
  const Json written = Json::parse(to_json(sample()).dump());
  EXPECT_EQ(to_json(record_from_text(json_text(written), "it")), written);
}

// jq and Node write large numbers without their exponent.
TEST(Record, ReadsAnIntegerThatIsTooLargeForAnIntegerAsANumber) {
  Json json = to_json(sample());
  for (const auto& [value, digits] : {std::pair{1e+25, "10000000000000000000000000"},
                                      std::pair{-1e+22, "-10000000000000000000000"}}) {
    json["summary"]["loss"] = value;
    std::string text = json_text(json);
    const std::string written = json_text(value);
    text.replace(text.find(written), written.size(), digits);
    EXPECT_EQ(record_from_text(text, "it").summary.loss, value);
  }
}

// Earlier versions wrote neither names and units nor the list of failed evaluations.
TEST(Record, OfAnEarlierVersionHasUnknownsWithoutNames) {
  Json json = to_json(sample());
  EXPECT_EQ(json["answer"]["names"], (Json{"k", "c"}));
  json.erase("failures");
  for (const char* name : {"names", "units"}) json["answer"].erase(name);
  const Record record = record_from_text(json_text(json), "it");
  EXPECT_EQ(record.answer->name(1), "x2");
  EXPECT_EQ(record.answer->unit(1), "");
  EXPECT_FALSE(record.failures);
  EXPECT_EQ(to_json(record), json);
}

TEST(FailedEvaluations, KeepTheFirstThousandAndOfALongXTheReasonAlone) {
  const auto failed = std::make_unique<FailedEvaluations>();
  const auto at_length = std::make_unique<FailedEvaluations>();
  for (int i = 0; i < 1500; ++i)
    failed->add(std::vector<double>{1.0 * i, 2}, std::string(300, 'a'));
  EXPECT_EQ(failed->total, 1500);
  EXPECT_EQ(failed->kept, FailedEvaluations::kMost);
  EXPECT_EQ(failed->point(999)[0], 999);
  EXPECT_EQ(std::string(failed->reason[999]), std::string(FailedEvaluations::kReason - 1, 'a'));
  for (const std::size_t n : {3000, 3000, 3000, 2}) at_length->add(std::vector<double>(n), "a");
  EXPECT_EQ(at_length->total, 4);
  EXPECT_EQ(at_length->kept, 2) << "the next does not fit, and the last has another size";
  const auto too_long = std::make_unique<FailedEvaluations>();
  too_long->add(std::vector<double>(FailedEvaluations::kNumbers + 1), "no mesh");
  EXPECT_TRUE(too_long->point(0).empty());
  EXPECT_STREQ(too_long->reason[0], "no mesh");
}

TEST(Record, WhatIsNoRecordIsAUsageError) {
  Json json = to_json(sample());
  for (const char* missing : {"schema", "cell", "request", "status", "curve", "summary"}) {
    Json broken = json;
    broken.erase(missing);
    EXPECT_THROW(record_from_text(json_text(broken), "it"), UsageError) << missing;
  }
  json["status"] = "splendid";
  EXPECT_THROW(record_from_text(json_text(json), "it"), UsageError);
}

TEST(Provenance, IsSharedInMemoryByTheRecordsOfOneBuild) {
  Json json = to_json(sample());
  const Record first = record_from_text(json_text(json), "it");
  json["provenance"]["run"]["concurrent_jobs"] = 5;
  const Record second = record_from_text(json_text(json), "it");
  json["provenance"]["commit"] = "abc";
  const Record third = record_from_text(json_text(json), "it");
  EXPECT_EQ(first.provenance.build, second.provenance.build);
  EXPECT_NE(first.provenance.build, third.provenance.build);
  EXPECT_EQ(third.provenance.build->commit, "abc");
  EXPECT_EQ(first.provenance.run.concurrent_jobs, 2);
  EXPECT_EQ(second.provenance.run.concurrent_jobs, 5);
}

TEST(Provenance, OfAProgramThatSaysNothingIsEmpty) {
  Json json = to_json(sample());
  json["provenance"] = Json::object();
  const Record record = record_from_text(json_text(json), "it");
  EXPECT_EQ(record.provenance.build->version, "");
  EXPECT_FALSE(record.provenance.build->is_dirty.has_value());
  EXPECT_EQ(to_json(record), json);
}

TEST(Provenance, ARunIsTimedAloneWhereNothingRanBesideIt) {
  RunProvenance run;
  EXPECT_TRUE(run.is_timed_alone());  // as far as it is known
  run.concurrent_jobs = 4;
  EXPECT_FALSE(run.is_timed_alone());
  run.is_exclusive = true;
  EXPECT_TRUE(run.is_timed_alone());
}

TEST(Record, TimesAreLeftOutOfComparisons) {
  Record other = sample();
  other.summary.wall_seconds = 9;
  other.summary.peak_memory_bytes = 1 << 20;
  other.curve.wall_seconds = {0, 9};
  other.hits->wall_seconds = {1, NAN};
  other.repeat_wall_seconds = {9, 10};
  other.provenance.run.concurrent_jobs = 1;
  other.failures->reasons[0] = "no mesh in /tmp/1";
  EXPECT_EQ(without_timings(to_json(other)), without_timings(to_json(sample())));
  other.curve.loss[0] = std::nextafter(1, 2);
  EXPECT_NE(without_timings(to_json(other)), without_timings(to_json(sample())));
}

// Baselines hold digests of these texts, so they may not change.
TEST(Record, HasTheTextsOfTheMembersOfItsTree) {
  Record record = sample();
  record.curve.loss = {1e-5, 1e15};  // with and without an exponent
  record.summary.loss = 0.0001;
  const Json tree = result_of(to_json(record));
  const auto texts = member_texts(record, paths_beside_results());
  ASSERT_EQ(texts.size(), tree.size());
  for (const auto& [name, value] : tree.items())
    EXPECT_EQ(texts.at(name), json_text(name) + ":" + json_text(value));
  EXPECT_FALSE(tree.at("curve").contains("wall_seconds"));
  EXPECT_FALSE(tree.at("request").at("problem").contains("asked"));
}

// Records are found again by it, so it may not change: of two records that commit 5990f5a wrote.
TEST(Cell, HasTheNameThatEarlierVersionsGaveIt) {
  const Json direct = Json::parse(R"({
    "budget": {"iterations": 100000, "seconds": "inf", "target": 1e-10, "work": 2000},
    "optimizer": {"name": "sip", "spec": "sip", "options": {
      "inner-steps": 1, "inverse": "auto", "inverse-evaluations": 200, "max-loss-change": 0.2,
      "network-optimizer": "auto", "network-steps": 1, "proxy": "l2", "step": 1.0}},
    "problem": {"name": "sine", "spec": "sine", "options": {
      "batch": 100, "data": 0, "form": "code", "gamma": 10.0, "mode": "direct",
      "network": "mlp[layers=32-64-32]", "phi": 45.0, "xi": 10.0}},
    "rates": "", "seed": 0, "threads": 1})");
  EXPECT_EQ(request_from_json(direct).cell, "97c10fa6580650cd");
  EXPECT_FALSE(request_from_json(direct).problem.is_learned);
  EXPECT_EQ(to_json(request_from_json(direct)), direct);
  Json learned = direct;
  learned.merge_patch(Json::parse(R"({
    "budget": {"iterations": 10000, "target": 0.0, "work": null},
    "optimizer": {"options": {"inverse": "newton", "network-optimizer": "adam[rate=1e-3]",
                              "proxy": "l1"}},
    "problem": {"options": {"mode": "learn", "xi": 32.0}}})"));
  learned["budget"]["work"] = nullptr;  // a merge takes it for an erasure
  EXPECT_EQ(request_from_json(learned).cell, "6fb30fb6a3608d73");
  EXPECT_TRUE(request_from_json(learned).problem.is_learned);
}

TEST(LearnedProblem, HasInstancesWhoseOtherOptionsAgree) {
  OptionValues direct, learned;
  for (OptionValues* options : {&direct, &learned}) options->set("xi", Real{10});
  direct.set("mode", "direct");
  direct.set("batch", std::int64_t{100});
  learned.set("mode", "learn");
  learned.set("batch", std::int64_t{50});
  EXPECT_TRUE(is_instance_of(direct, learned));
  EXPECT_FALSE(is_instance_of(learned, direct));
  EXPECT_FALSE(is_instance_of(learned, learned));
  direct.set("xi", Real{11});
  EXPECT_FALSE(is_instance_of(direct, learned));
}

TEST(Rates, AreTunedWhereAGridOfOursWroteThem) {
  EXPECT_EQ(kind_of_rates(""), RatesKind::none);
  EXPECT_EQ(kind_of_rates("learn.json"), RatesKind::published);
  EXPECT_EQ(kind_of_rates("learn-tuned.json"), RatesKind::tuned);
  EXPECT_EQ(kind_of_rates("learn-tuned.json.old"), RatesKind::published);
}

TEST(Privileges, AreInversesWhereThePhysicsAreInverted) {
  for (const std::string_view name : kPrivilegeNames)
    EXPECT_EQ(is_inverse_of_physics(name), name.find("inverse of") != name.npos) << name;
  EXPECT_FALSE(is_inverse_of_physics("told of an inverse"));
}

TEST(Cell, DependsOnAllThatIsAskedAndNothingElse) {
  const Request asked = sample().request;
  Request other = asked;
  other.rates = "direct.json";
  other.problem.options.set("watch", std::string());  // a new option that is empty by default
  EXPECT_EQ(cell_digest(other), cell_digest(asked));
  for (const auto& change : std::vector<std::function<void(Request&)>>{
           [](Request& r) { r.seed = 8; }, [](Request& r) { r.threads = 2; },
           [](Request& r) { r.budget.work = 5; }, [](Request& r) { r.budget.target = 0; },
           [](Request& r) { r.budget.stall = 0; }, [](Request& r) { r.budget.discrepancy = 1.1; },
           [](Request& r) { r.problem.options.set("n", Index{1}); },
           [](Request& r) { r.problem.options.set("watch", std::string("noise")); },
           [](Request& r) { r.optimizer.options.set("rate", 0.2); }}) {
    Request changed = asked;
    change(changed);
    EXPECT_NE(cell_digest(changed), cell_digest(asked));
  }
}

const std::filesystem::path kFolder =
    std::filesystem::path(ISOLINE_SOURCE_DIR) / "benchmarks/schemas";

void expect_renewed(const char* file, const Json& schema) {
  if (std::getenv("ISOLINE_RENEW_SCHEMAS") != nullptr) write_json(kFolder / file, schema);
  EXPECT_EQ(read_json(kFolder / file), schema)
      << file << " is not what the fields say: renew it as the first lines of this file say";
}

TEST(Schemas, AreWhatTheFieldsSay) {
  expect_renewed("run.json", run_schema());
  expect_renewed("component.json", sheet_schema());
  expect_renewed("plan.json", plan_schema());
  expect_renewed("profile.json", results::profile_schema());
}

// A record with all that it must have and nothing more.
Record least() {
  Record record{.cell = std::string(16, '0'), .build = std::string(16, '1')};
  record.status = Status::budget;
  for (const auto& [name, tau] : kVerified)
    record.verified[name] = record.found[name] = std::nullopt;
  Build build{.version = "0",
              .commit = "abc",
              .is_dirty = false,
              .compiler = "c",
              .flags = "f",
              .instruction_set = "i",
              .processor = "p",
              .libraries = {{"a", "1"}}};
  record.provenance = Provenance(build);
  record.provenance.run = {
      .started = "now", .concurrent_jobs = 1, .is_exclusive = true, .command = "isoline"};
  return record;
}

// Records from before sparse Jacobians have no such price.
TEST(Criteria, ContainThePriceOfASparseJacobianWhereARunCountsOne) {
  constexpr auto kSparse = static_cast<std::size_t>(Oracle::sparse_jacobian);
  Record record = least();
  const std::string before = digest_of(criterion_of(record));
  record.prices[kSparse] = 3;
  EXPECT_EQ(digest_of(criterion_of(record)), before);
  record.counts[kSparse] = 1;
  EXPECT_NE(digest_of(criterion_of(record)), before);
}

TEST(Schemas, OfRecordsRefuseWhatIsMissingUnknownOrOfAnotherType) {
  const Schema schema(run_schema());
  const Json good = to_json(least());
  EXPECT_EQ(schema.violations(good), std::vector<std::string>{});
  for (const char* field : {"cell", "request", "status", "minimum", "summary", "provenance"}) {
    Json broken = good;
    broken.erase(field);
    EXPECT_NE(schema.violations(broken), std::vector<std::string>{}) << field;
  }
  for (const auto& [place, value] :
       std::map<std::string, Json>{{"/cell", "short"},
                                   {"/unknown", 1},
                                   {"/summary/loss", nullptr},
                                   {"/summary/work", 1.5},
                                   {"/status", "running"},
                                   {"/request/threads", 0},
                                   {"/request/seed", -1},
                                   {"/provenance/commit", 5},
                                   {"/verified/1e-3", "yes"},
                                   {"/counts/forward", -1},
                                   {"/summary/work", -1},
                                   {"/summary/wall_seconds", -1.0},
                                   {"/summary/iterations", -1},
                                   {"/summary/peak_memory_bytes", -1},
                                   {"/curve/work", Json::array({-1})},
                                   {"/curve/wall_seconds", Json::array({-0.5})},
                                   {"/repeat_wall_seconds", Json::array({-0.5})},
                                   {"/request/budget/work", -1},
                                   {"/request/budget/stall", -1}}) {
    Json broken = good;
    broken[Json::json_pointer(place)] = value;
    EXPECT_NE(schema.violations(broken), std::vector<std::string>{}) << place;
  }
  Json infinite = good;
  infinite["summary"]["loss"] = "inf";
  EXPECT_EQ(schema.violations(infinite), std::vector<std::string>{});
}

// As a seed is: what reads it as a signed number finds −1.
TEST(Schema, TheLargestIntegerIsNotBelowZero) {
  const Json schema{{"properties", {{"seed", {{"type", "integer"}, {"minimum", 0}}}}}};
  EXPECT_TRUE(schema_violations({{"seed", std::uint64_t{18446744073709551615U}}}, schema).empty());
  EXPECT_TRUE(schema_violations({{"seed", 1}}, schema).empty());
  EXPECT_FALSE(schema_violations({{"seed", -1}}, schema).empty());
}

TEST(Schema, ViolationsNameTheirPlace) {
  const Json schema{{"type", "object"},
                    {"properties", {{"list", {{"items", {{"type", "integer"}}}}}}}};
  const auto violations = schema_violations({{"list", {1, "two"}}}, schema);
  ASSERT_FALSE(violations.empty());
  bool is_named = false;
  for (const std::string& each : violations) is_named |= each.find("[1]") != std::string::npos;
  EXPECT_TRUE(is_named) << violations[0];
}

// y*, x* and x at two iterations, of 2×3 cells.
TEST(Answer, WithManyUnknownsIsReadBackFromItsFile) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.x.npy";
  AnswerPoints written{
      .unknowns = 3, .points = {kReturned, kBest}, .x = {{1, 0.1, 1e-300}, {4, 5, 6}}};
  written.digest = digest(answer_file(written));
  Record record = sample();
  record.answer = written;
  AnswerPoints read = record_from_text(file_text(record), "it").answer.value();
  EXPECT_TRUE(read.x.empty()) << "the record does not repeat the numbers";
  EXPECT_THROW(read_answer_numbers(read, path), UsageError) << "the file is missing";
  write_text(path, answer_file(written));
  read_answer_numbers(read, path);
  EXPECT_EQ(read.x, written.x);
  EXPECT_EQ(read.point(kBest)[2], 6);
  write_text(path, answer_file(written) + " ");
  EXPECT_THROW(read_answer_numbers(read, path), UsageError) << "the file is damaged";
}

TEST(Answer, WhoseSizesOrNamesDisagreeIsUnsound) {
  const AnswerPoints sound{.unknowns = 2, .points = {kBest}, .x = {{1, 2}}};
  EXPECT_NO_THROW(require_sound(sound));
  for (const auto& change : std::vector<std::function<void(AnswerPoints&)>>{
           [](AnswerPoints& a) { a.unknowns = 3; }, [](AnswerPoints& a) { a.names = {"k"}; },
           [](AnswerPoints& a) { a.units = {"N/m"}; },
           [](AnswerPoints& a) { a.points = {"other"}; }, [](AnswerPoints& a) { a.points = {}; },
           [](AnswerPoints& a) {
             a.x.push_back({1, 2});
           }}) {
    AnswerPoints changed = sound;
    change(changed);
    EXPECT_THROW(require_sound(changed), UsageError);
  }
}

FieldFrames small_fields() {
  FieldFrames fields{.iterations = {0, 7}, .shape = {4, 2, 3}};
  for (int i = 0; i < 24; ++i) fields.numbers.push_back(0.1F * static_cast<float>(i));
  fields.digest = digest(field_file(fields));
  return fields;
}

std::string refusal_of(FieldFrames fields, const std::filesystem::path& path) {
  fields.numbers.clear();
  return refusal([&] { read_field_numbers(fields, path); });
}

TEST(FieldFrames, AreReadBackFromTheirFile) {
  const TemporaryFolder folder;
  const FieldFrames written = small_fields();
  write_text(folder.path() / "a.npy", field_file(written));
  FieldFrames read = written;
  read.numbers.clear();
  read_field_numbers(read, folder.path() / "a.npy");
  EXPECT_EQ(read.numbers, written.numbers);
  EXPECT_EQ(read.target()[1], 0.1F);
  EXPECT_EQ(read.truth()[0], 0.6F);
  EXPECT_EQ(read.x(1)[5], 2.3F);
  const NumberArray array = read_npy(folder.path() / "a.npy");
  EXPECT_EQ(array.shape, (std::vector<Index>{4, 2, 3}));
  EXPECT_EQ(array.values[23], static_cast<Real>(2.3F));
}

TEST(FieldFrames, ThatAreMissingDamagedOrAnothersAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.npy";
  const FieldFrames fields = small_fields();
  EXPECT_NE(refusal_of(fields, path).find("a.npy"), std::string::npos);
  std::string bytes = field_file(fields);
  bytes.back() ^= 1;
  write_text(path, bytes);
  EXPECT_NE(refusal_of(fields, path).find("is not the file"), std::string::npos);
  FieldFrames other = fields;
  other.shape = {4, 3, 2};
  write_text(path, field_file(fields));
  EXPECT_NE(refusal_of(other, path).find("shape"), std::string::npos);
}

TEST(FieldFrames, WhoseShapeOrIterationsCannotBeAreUnsound) {
  EXPECT_NO_THROW(require_sound(small_fields()));
  using Numbers = std::vector<std::int64_t>;
  for (const auto& [iterations, shape] :
       std::vector<std::pair<Numbers, std::vector<Index>>>{{{0, 7}, {7, 2, 3}},
                                                           {{0, 7}, {2, 2, 3}},
                                                           {{0, 7}, {4, 0, 3}},
                                                           {{0, 7}, {4, 6}},
                                                           {{0, 7}, {4, 2, -3}},
                                                           {{7, 7}, {4, 2, 3}},
                                                           {{-1, 7}, {4, 2, 3}},
                                                           {{7, 0}, {4, 2, 3}}})
    EXPECT_THROW(require_sound({.iterations = iterations, .shape = shape}), UsageError)
        << iterations[0] << ", " << shape.size();
}

// The pictures of a sample, and the x of a run that are kept as pictures, whenever it ends.

// Of a field of 2×1 cells whose x is the iteration and its negative.
class KeptFrames : public testing::Test {
 protected:
  KeptFrames() {
    const std::vector<Real> target = {1, 2}, truth = {3, 4};
    open_frames(*frames, 2, 1, target, truth);
  }
  void keep(std::int64_t iteration) {
    const Real value = static_cast<Real>(iteration);
    keep_frame(*frames, iteration, std::vector<Real>{value, -value});
  }
  std::vector<std::int64_t> chosen() const {
    std::vector<std::int64_t> iterations;
    for (const std::size_t place : chosen_frames(*frames)) {
      iterations.push_back(frames->iteration[place]);
      EXPECT_EQ(frames->x[place][0], static_cast<float>(iterations.back()));
      EXPECT_EQ(frames->x[place][1], -static_cast<float>(iterations.back()));
    }
    return iterations;
  }

  std::unique_ptr<Frames> frames = std::make_unique<Frames>();
};

TEST_F(KeptFrames, OfAShortRunAreAllOfIt) {
  for (std::int64_t i = 0; i <= 5; ++i) keep(i);
  EXPECT_EQ(chosen(), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
}

// At any end, the first, the last and four within a factor of three of the even spread.
TEST_F(KeptFrames, AreSpreadAsTheLogarithmOfTheirIteration) {
  std::vector<std::int64_t> kept;
  for (std::int64_t i = 0; i < 100; ++i) kept.push_back(i);
  for (Real t = 100; t < 1e7; t *= 1.075) kept.push_back(std::llround(t));
  for (const std::int64_t iteration : kept) {
    keep(iteration);
    if (iteration < 5) continue;
    const std::vector<std::int64_t> six = chosen();
    ASSERT_EQ(six.size(), kMostFrames);
    EXPECT_EQ(six.front(), 0);
    EXPECT_EQ(six.back(), iteration);
    const Real end = static_cast<Real>(iteration) + 1;
    for (std::size_t i = 1; i + 1 < six.size(); ++i) {
      ASSERT_GT(six[i], six[i - 1]);
      const Real even = std::pow(end, static_cast<Real>(i) / (kMostFrames - 1));
      const Real ratio = (static_cast<Real>(six[i]) + 1) / even;
      EXPECT_LT(std::max(ratio, 1 / ratio), 3) << six[i] << " of " << iteration;
    }
  }
}

TEST_F(KeptFrames, OfOneIterationAreTheLastX) {
  keep(0);
  keep(1);
  keep_frame(*frames, 1, std::vector<Real>{7, 8});
  ASSERT_EQ(chosen_frames(*frames).size(), 2U);
  EXPECT_EQ(frames->x[chosen_frames(*frames)[1]][0], 7);
}

TEST_F(KeptFrames, WithoutANumberInSinglePrecisionAreNone) {
  keep(0);
  for (const Real wrong : {std::nan(""), 1e39, -std::numeric_limits<Real>::infinity()})
    keep_frame(*frames, 1, std::vector<Real>{1, wrong});
  EXPECT_EQ(chosen(), std::vector<std::int64_t>{0});
}

TEST(Frames, OfAGridThatIsTooLargeAreNone) {
  for (const auto& [columns, is_kept] : {std::pair{128, true}, std::pair{129, false}}) {
    const auto frames = std::make_unique<Frames>();
    const std::vector<Real> cells(static_cast<std::size_t>(128 * columns), 1.0);
    open_frames(*frames, 128, columns, cells, {});
    keep_frame(*frames, 0, cells);
    EXPECT_EQ(chosen_frames(*frames).size(), is_kept ? 1U : 0U);
    EXPECT_FALSE(frames->has_truth);
  }
}

TEST_F(KeptFrames, ThatCannotBeAreNotSound) {
  for (std::int64_t i = 0; i < 20; ++i) keep(i);
  ASSERT_TRUE(are_sound(*frames));
  const std::int64_t other = frames->iteration[1];
  for (const std::int64_t wrong : {frames->iteration[0], std::int64_t{-2}}) {
    frames->iteration[1] = wrong;
    EXPECT_FALSE(are_sound(*frames)) << wrong;
  }
  frames->iteration[1] = other;
  frames->columns = Frames::kCells;
  EXPECT_FALSE(are_sound(*frames));
}

// u = sin aj, v = cos bi, of which central differences have sin a and sin b for a and b.
TEST(Curl, IsThatOfAWaveOnAPeriodicGrid) {
  constexpr Index kRows = 6, kColumns = 10;
  const Real b = 2 * std::numbers::pi / kRows, a = 2 * std::numbers::pi / kColumns;
  Vector velocity(2 * kRows * kColumns);
  for (Index j = 0; j < kColumns; ++j)
    for (Index i = 0; i < kRows; ++i) {
      velocity[i + kRows * j] = std::sin(a * static_cast<Real>(j));
      velocity[kRows * kColumns + i + kRows * j] = std::cos(b * static_cast<Real>(i));
    }
  const Vector found = curl(velocity, kRows, kColumns);
  for (Index j = 0; j < kColumns; ++j)
    for (Index i = 0; i < kRows; ++i)
      EXPECT_NEAR(found[i + kRows * j],
                  -std::sin(b) * std::sin(b * static_cast<Real>(i)) -
                      std::sin(a) * std::cos(a * static_cast<Real>(j)),
                  1e-14);
}

// A state of two cells that grows by 1 a row.
TEST(PictureOfAHistory, HasAllStatesOfXAndOfYTheLastAlone) {
  const Field field{.rows = 3, .columns = 2, .time = 0.5};
  const History grow = [](VectorRef x, BatchOut states) {
    for (Index row = 0; row < states.rows(); ++row)
      states.row(row) = x.transpose().array() + static_cast<Real>(row);
  };
  Matrix batch(2, 2);
  batch << 4, 90, 7, 90;
  const auto cells = [](const Picture& picture) {
    return std::vector<Real>(picture.cells().begin(), picture.cells().end());
  };
  EXPECT_EQ(cells(Picture(batch, field, grow)), (std::vector<Real>{4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(cells(Picture(batch, field)), (std::vector<Real>{0, 0, 4, 0, 0, 7}));
  EXPECT_TRUE(cells(Picture(Matrix(), field, grow)).empty());
}

}  // namespace
}  // namespace isoline
