// A record survives the round trip, and its digest names the request.
#include "core/records/record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/privilege.h"

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
                  .wall_seconds = {0, 0.5},
                  .processor_seconds = {0, 0.25},
                  .loss = {1, INFINITY},
                  .x_error = {NAN, NAN},
                  .gradient_norm = {1, 2},
                  .step_norm = {0, 1}};
  record.hits = Hits{{1, 0.1}, {0, -1}, {0, -1}, {0, -1}, {{"forward", {0, -1}}}, {0, NAN}};
  record.trajectory = Trajectory{{{1, 2}, {3, 4}}, {{1}, {-INFINITY}}};
  record.repeat_wall_seconds = {0.5};
  record.provenance = Provenance(Build{.version = "0"});
  record.provenance.run.concurrent_jobs = 2;
  return record;
}

TEST(Record, SurvivesTheRoundTrip) {
  const Json written = Json::parse(to_json(sample()).dump());
  EXPECT_EQ(to_json(record_from_text(json_text(written), "it")), written);
}

TEST(Record, OfAnOlderVersionHasNoCountsAtItsHits) {
  Json older = to_json(sample());
  older["hits"].erase("counts");
  EXPECT_TRUE(record_from_text(json_text(older), "it").hits->counts.empty());
  EXPECT_EQ(without_timings(older), without_timings(to_json(sample())));
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

TEST(Provenance, WhatAnotherVersionSaysBesidesSurvives) {
  Json json = to_json(sample());
  json["provenance"]["host"] = {{"load", 1.25}};
  json["provenance"]["run"]["queue"] = "night";
  EXPECT_EQ(to_json(record_from_text(json_text(json), "it")), json);
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
  EXPECT_EQ(without_timings(to_json(other)), without_timings(to_json(sample())));
  other.curve.loss[0] = std::nextafter(1, 2);
  EXPECT_NE(without_timings(to_json(other)), without_timings(to_json(sample())));
}

// Records are found again by it, so it may not change: of two records that commit 5990f5a wrote.
TEST(Cell, HasTheNameThatEarlierVersionsGaveIt) {
  const Json direct = Json::parse(R"({
    "budget": {"iterations": 100000, "seconds": "inf", "target": 1e-10, "work": 2000},
    "optimizer": {"name": "sip", "revision": 2, "spec": "sip", "options": {
      "inner-steps": 1, "inverse": "auto", "inverse-evaluations": 200, "max-loss-change": 0.2,
      "network-optimizer": "auto", "network-steps": 1, "proxy": "l2", "step": 1.0}},
    "problem": {"name": "sine", "revision": 1, "spec": "sine", "options": {
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
  EXPECT_FALSE(is_inverse_of_physics("it was told of an inverse of the physics"));
}

// A component may gain an option that is empty by default: its cells keep their names.
TEST(Cell, DoesNotDependOnAnOptionOfNoText) {
  const Request asked = sample().request;
  Request other = asked;
  other.problem.options.set("watch", std::string());
  other.optimizer.options.set("remark", std::string());
  EXPECT_EQ(cell_digest(other), cell_digest(asked));
  other.problem.options.set("watch", std::string("noise"));
  EXPECT_NE(cell_digest(other), cell_digest(asked));
}

TEST(Cell, DependsOnAllThatIsAskedAndNothingElse) {
  const Request asked = sample().request;
  Request other = asked;
  other.rates = "direct.json";
  other.optimizer.revision = 9;
  EXPECT_EQ(cell_digest(other), cell_digest(asked));
  for (const auto& change : std::vector<std::function<void(Request&)>>{
           [](Request& r) { r.seed = 8; }, [](Request& r) { r.threads = 2; },
           [](Request& r) { r.budget.work = 5; }, [](Request& r) { r.budget.target = 0; },
           [](Request& r) { r.problem.options.set("n", Index{1}); },
           [](Request& r) { r.optimizer.options.set("rate", 0.2); }}) {
    Request changed = asked;
    change(changed);
    EXPECT_NE(cell_digest(changed), cell_digest(asked));
  }
}

}  // namespace
}  // namespace isoline
