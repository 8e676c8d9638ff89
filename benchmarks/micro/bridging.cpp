// What a call over HTTP costs: one Evaluate of a small model, from text to text and back, over the
// same numbers computed here.
#include "benchmarks/micro/pairs.h"
#include "benchmarks/serve/bridge_service.h"
#include "problems/physics/bridged_model.h"

namespace isoline::benchmarks::micro {
namespace {

// A server and its client, in one process.
struct Bridge {
  explicit Bridge(const std::string& spec) {
    const Component problem = complete_problem(catalog(), parse_spec(spec));
    const Component client = complete_optimizer(catalog(), "served", OptionValues());
    runs.emplace_back(catalog(), named({.problem = problem, .optimizer = client}));
    service.emplace(runs);
    server.emplace("127.0.0.1", 0, service->routes(), BridgeService::refusal,
                   HttpLimits{.body_bytes = service->most_bytes()});
    server->start();
    model.emplace(problems::BridgedModel::Place{.url = server->url()}, spec, "{}");
    x = runs[0].problem().start();
    y.resize(model->outputs());
  }

  std::deque<ServedRun> runs;
  std::optional<BridgeService> service;
  std::optional<HttpServer> server;
  std::optional<problems::BridgedModel> model;
  Vector x, y;
  Point here;
};

Cost evaluate(Bridge& bridge) {
  constexpr int kCalls = 50;
  return cost_of(kCalls, [&] {
    bridge.x[0] += 1e-9;  // another point: the server remembers the last one
    bridge.model->evaluate(bridge.x, bridge.y);
  });
}

Cost compute(Bridge& bridge) {
  constexpr int kCalls = 1000;
  return cost_of(kCalls, [&] { bridge.runs[0].problem().forward(bridge.x, bridge.here); });
}

}  // namespace

void register_bridging() {
  for (const std::string spec : {"rosenbrock", "heat[N=32]"})
    register_pair("bridging/evaluate/" + spec, 31, {}, [=] {
      const auto bridge = std::make_shared<Bridge>(spec);
      return Pair{[=] { return evaluate(*bridge); }, [=] { return compute(*bridge); }};
    });
}

}  // namespace isoline::benchmarks::micro
