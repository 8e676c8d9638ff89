// Problems through UM-Bridge and back: what is served and bridged again is the same problem, to the
// bit, for every oracle and for a whole run; and what was asked is a record like any other.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "benchmarks/run/execute.h"
#include "benchmarks/serve/bridge_service.h"
#include "core/bridge_answers.h"
#include "core/http_client.h"
#include "problems/conformance.h"
#include "tests/benchmarks/builtin.h"

namespace isoline::benchmarks {
namespace {

Request request_of(const std::string& problem, const std::string& optimizer) {
  return named({.problem = complete_problem(catalog(), parse_spec(problem)),
                .optimizer = complete_optimizer(catalog(), parse_spec(optimizer))});
}

// Problems, served by this process to itself.
class Served {
 public:
  explicit Served(const std::vector<std::string>& problems) {
    for (const std::string& spec : problems)
      runs.emplace_back(catalog(), request_of(spec, "served[client=test]"));
    service.emplace(runs);
    server.emplace("127.0.0.1", 0, service->routes(), BridgeService::refusal,
                   HttpLimits{.body_bytes = service->most_bytes()});
    server->start();
  }
  // The same problem, from here.
  std::string bridged(const std::string& model, const std::string& more = "") const {
    return "umbridge[url=" + server->url() + ",model=" + quoted(model) + more + "]";
  }

  std::deque<ServedRun> runs;
  std::optional<BridgeService> service;
  std::optional<HttpServer> server;
};

Record run(const Request& request) {
  const auto trace = std::make_unique<Trace>();
  execute(catalog(), request, *trace);
  return record_of(request, *trace);
}

void expect_same_run(const std::string& own, const std::string& bridged,
                     const std::string& optimizer) {
  const Record here = run(request_of(own, optimizer)), there = run(request_of(bridged, optimizer));
  EXPECT_EQ(there.status, here.status) << there.message;
  EXPECT_EQ(there.curve.loss, here.curve.loss) << optimizer;
  EXPECT_EQ(there.curve.iteration, here.curve.iteration);
  EXPECT_EQ(there.curve.gradient_norm, here.curve.gradient_norm);
  EXPECT_EQ(there.curve.step_norm, here.curve.step_norm);
  EXPECT_EQ(there.curve.x_error, here.curve.x_error);
  EXPECT_EQ(there.counts, here.counts);
  EXPECT_GT(here.curve.loss.size(), 3U);
}

TEST(Bridge, TheSameProblemGivesTheSameTraceByLevenbergMarquardt) {
  const Served served({"rosenbrock"});
  expect_same_run("rosenbrock", served.bridged("rosenbrock", ",truth=\"[1, 1]\",minimum=0"),
                  "levenberg-marquardt");
}

TEST(Bridge, TheSameProblemGivesTheSameTraceByGradientsAndByHessians) {
  const Served served({"rosenbrock"});
  const std::string bridged = served.bridged("rosenbrock", ",truth=\"[1, 1]\",minimum=0");
  for (const char* optimizer : {"gd[rate=1e-3]", "nlopt-lbfgs", "nlopt-neldermead"})
    expect_same_run("rosenbrock", bridged, optimizer);
}

// Their Jacobians are made of products here, and read off there: the same sums.
TEST(Bridge, EveryClassicalProblemPassesItsCertificateThroughTheBridge) {
  const std::vector<std::string> problems = {"beale", "wood", "powell-singular", "box3d"};
  const Served served(problems);
  for (const std::string& name : problems) {
    const Component bridged = complete_problem(catalog(), parse_spec(served.bridged(name)));
    const Problem problem = make_problem(catalog(), bridged, 0);
    RandomStream stream(0, name, "check");
    for (const problems::Finding& finding : problems::examine(problem, stream))
      EXPECT_TRUE(finding.holds()) << name << ": " << finding.property << " " << finding.figure;
  }
}

TEST(Bridge, EveryOracleOfAServedProblemHasItsOwnBits) {
  const Served served({"brown-dennis"});
  const Problem own =
      make_problem(catalog(), complete_problem(catalog(), parse_spec("brown-dennis")), 0);
  const Problem bridged = make_problem(
      catalog(), complete_problem(catalog(), parse_spec(served.bridged("brown-dennis"))), 0);
  ASSERT_EQ(bridged.start(), own.start());
  ASSERT_EQ(bridged.target(), own.target());
  RandomStream stream(1, "brown-dennis", "bridge");
  const Vector x = own.start() + stream.normal_vector(own.unknowns());
  const Vector v = stream.normal_vector(own.unknowns());
  const Matrix w = stream.normal_vector(own.outputs());
  Point here, there;
  own.forward(x, here);
  bridged.forward(x, there);
  EXPECT_EQ(there.y, here.y);
  EXPECT_EQ(there.loss, here.loss);
  Vector back(x.size()), back_there(x.size());
  own.pullback(w, back, here);
  bridged.pullback(w, back_there, there);
  EXPECT_EQ(back_there, back);
  Matrix on(own.outputs(), 1), on_there(own.outputs(), 1);
  own.pushforward(v, on, here);
  bridged.pushforward(v, on_there, there);
  EXPECT_EQ(on_there, on);
}

TEST(Bridge, ModelsOfALossAndOfAnInverseAreTheProblemsOwn) {
  const Served served({"rosenbrock"});
  HttpClient client(served.server->url(), 10, 1 << 20);
  const auto output = [&](const std::string& path, const std::string& body) {
    return client.post(path, body).body;
  };
  const Problem own =
      make_problem(catalog(), complete_problem(catalog(), parse_spec("rosenbrock")), 0);
  Point at;
  own.forward(Eigen::Vector2d(-1.2, 1), at);
  const std::string x = R"("input": [[-1.2, 1]])";
  EXPECT_EQ(outputs_in(output("/Evaluate", R"({"name": "rosenbrock.loss", )" + x + "}"))[0][0],
            at.loss);
  Matrix g(2, 1);
  Vector gradient(2);
  own.cotangent(at, g);
  own.pullback(g, gradient, at);
  const Numbers found = output_in(
      output("/Gradient",
             R"({"name": "rosenbrock.loss", "inWrt": 0, "outWrt": 0, "sens": [2], )" + x + "}"));
  EXPECT_EQ(found[0], 2 * gradient[0]);
  const std::vector<Numbers> inverse = outputs_in(
      output("/Evaluate", R"({"name": "rosenbrock.inverse", "input": [[0, 0], [-1.2, 1]]})"));
  EXPECT_EQ(inverse, (std::vector<Numbers>{{1, 1}}));
}

TEST(Bridge, WhatIsNotFiniteIsData) {
  const Served served({"exponential"});
  HttpClient client(served.server->url(), 10, 1 << 20);
  const Problem problem = make_problem(
      catalog(), complete_problem(catalog(), parse_spec(served.bridged("exponential"))), 0);
  Point at;
  problem.forward(Vector::Constant(problem.unknowns(), 1e200), at);
  EXPECT_FALSE(std::isfinite(at.loss));
  problem.forward(Vector::Constant(problem.unknowns(), std::nan("")), at);
  EXPECT_TRUE(std::isnan(at.loss));
}

TEST(Bridge, WhatWasAskedIsARecord) {
  Served served({"rosenbrock"});
  EXPECT_FALSE(served.runs[0].record().has_value()) << "nobody has asked yet";
  HttpClient client(served.server->url(), 10, 1 << 20);
  const auto evaluate = [&](Real x1, Real x2) {
    client.post("/Evaluate", call_text("rosenbrock", "{}", {.input = {{x1, x2}}}));
  };
  evaluate(-1.2, 1);
  client.post("/Gradient",
              call_text("rosenbrock.loss", "{}",
                        {.verb = BridgeVerb::gradient, .input = {{-1.2, 1}}, .sens = {1}}));
  evaluate(-1, 1);
  evaluate(-2, 5);  // worse
  evaluate(0, 0);
  const std::optional<Record> record = served.runs[0].record();
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->status, Status::converged);
  EXPECT_EQ(record->counts[static_cast<std::size_t>(Oracle::forward)], 4);
  EXPECT_EQ(record->counts[static_cast<std::size_t>(Oracle::pullback)], 1);
  EXPECT_EQ(record->summary.iterations, 2) << "each new best is one, the start is none";
  EXPECT_EQ(record->summary.loss, 0.5) << "of the best, not of the last";
  EXPECT_TRUE(record->privileges.empty());
  EXPECT_TRUE(record->is_nondeterministic);
  ASSERT_TRUE(record->foreign.optimizer.has_value());
  EXPECT_EQ(record->foreign.optimizer->label, "test");
  evaluate(1, 1);
  EXPECT_EQ(served.runs[0].record()->summary.loss, 0.5) << "what comes later is not in it";
}

TEST(Bridge, ARunThatReachesItsTargetIsOver) {
  Served served({"rosenbrock"});
  ServedRun& run = served.runs[0];
  run.at(Eigen::Vector2d(0, 0));
  run.at(Eigen::Vector2d(1, 1));
  run.at(Eigen::Vector2d(3, 3));
  EXPECT_EQ(run.record()->status, Status::target);
  EXPECT_EQ(run.record()->counts[static_cast<std::size_t>(Oracle::forward)], 2);
}

TEST(Bridge, ProblemsThatLearnAreNotServed) {
  EXPECT_THROW(Served({"sine[mode=learn]"}), UsageError);
  EXPECT_THROW(Served({"rosenbrock", "rosenbrock"}), UsageError);
}

void expect_refused(const std::string& spec, const std::string& words) {
  try {
    make_problem(catalog(), complete_problem(catalog(), parse_spec(spec)), 0);
    ADD_FAILURE() << spec;
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Bridge, MistakesAreToldInWords) {
  const Served served({"rosenbrock"});
  expect_refused("umbridge", "needs either url=");
  expect_refused("umbridge[url=http://a,command=b]", "needs either url=");
  expect_refused("umbridge[url=ftp://a]", "http://127.0.0.1:4242");
  expect_refused("umbridge[url=http://127.0.0.1:1]", "nobody listens there");
  expect_refused("umbridge[url=" + served.server->url() + "]", "rosenbrock.loss");
  expect_refused(served.bridged("rosenbrock.loss"), "start must be given");
  expect_refused(served.bridged("rosenbrock", ",start=\"[1]\""), "start must have 2 numbers");
  expect_refused(served.bridged("rosenbrock", ",start=\"[1, x]\""), "start");
  expect_refused(served.bridged("rosenbrock", ",config=\"[]\""), "config must be a JSON object");
  expect_refused("umbridge[command=/nowhere/at/all]", "cannot start");
  expect_refused("umbridge[command=\"sh -c 'echo no such module >&2; exit 3'\"]", "no such module");
  expect_refused("umbridge[command=\"sleep 60\",startup=0.2]", "within 0.2 s");
}

TEST(Bridge, WhatAModelLacksMakesMethodsInapplicable) {
  const Served served({"rosenbrock"});
  const std::string inverse =
      served.bridged("rosenbrock.inverse", ",start=\"[0, 0, 0, 0]\",target=\"[1, 1]\"");
  const Record newton = run(request_of(inverse, "levenberg-marquardt"));
  EXPECT_EQ(newton.status, Status::inapplicable);
  EXPECT_NE(newton.message.find("not offered"), std::string::npos) << newton.message;
  const Record simplex = run(request_of(inverse, "nlopt-neldermead"));
  EXPECT_NE(simplex.status, Status::inapplicable) << simplex.message;
  EXPECT_NE(simplex.status, Status::failed) << simplex.message;
}

}  // namespace
}  // namespace isoline::benchmarks
