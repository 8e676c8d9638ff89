// Requests of UM-Bridge, the path on the first line and the body behind it; the same bytes as a
// server's answer.
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "benchmarks/serve/bridge_service.h"
#include "core/bridge_answers.h"
#include "core/json.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

using benchmarks::BridgeService;
using benchmarks::ServedRun;

std::deque<ServedRun>& runs() {
  static std::deque<ServedRun> all = [] {
    static const benchmarks::Catalog whole = benchmarks::builtin_catalog();  // "served" is in it
    std::deque<ServedRun> made;
    const Component client = benchmarks::complete_optimizer(whole, "served", {});
    const Component problem = benchmarks::complete_problem(whole, parse_spec("rosenbrock"));
    made.emplace_back(whole, named({.problem = problem, .optimizer = client}));
    return made;
  }();
  return all;
}

// An answer is JSON, but for numbers that are not finite; an error says which of the protocol's.
void expect_protocol(const HttpReply& reply) {
  bridge_json(reply.body, "a reply");
  const std::string error = error_in(reply.body);
  if ((reply.status == 200) != error.empty())
    throw std::logic_error("a status that its body does not say: " + reply.body);
  if (!error.empty() && error.starts_with('?')) throw std::logic_error("an error without a kind");
}

}  // namespace

void bridge(std::string_view bytes) {
  static BridgeService service(runs());
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const std::string path(bytes.substr(0, end));
  const std::string body(bytes.substr(std::min(end + 1, bytes.size())));
  expect_protocol(service.answer(path, body));
  for (const auto& read : std::initializer_list<std::function<void()>>{
           [&] { outputs_in(body); }, [&] { output_in(body); }, [&] { models_in(body); },
           [&] { input_sizes_in(body); }, [&] { support_in(body); }, [&] { error_in(body); }})
    expect_read_or_refused(read);
}

}  // namespace isoline::fuzz
