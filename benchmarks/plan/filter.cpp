// Cells kept by name and options.
#include "benchmarks/plan/filter.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

bool matches(const Component& component, const Component& wanted, const Spec& given) {
  return component.name == wanted.name &&
         std::ranges::all_of(given.options, [&](const auto& option) {
           return component.options.at(option.first) == wanted.options.at(option.first);
         });
}

}  // namespace

std::vector<Request> filtered(const Catalog& catalog, std::vector<Request> requests,
                              const std::string& problems, const std::string& optimizers) {
  const auto keep = [&](const std::string& text, Component Request::*part, const auto& complete) {
    if (text.empty()) return;
    std::vector<std::pair<Spec, Component>> wanted;
    for (const Spec& spec : parse_specs(text))
      wanted.emplace_back(spec, complete(catalog, spec.name, options_of(spec)));
    std::erase_if(requests, [&](const Request& request) {
      return std::ranges::none_of(wanted, [&](const auto& one) {
        return matches(request.*part, one.second, one.first);
      });
    });
    require(!requests.empty(), [&] { return fmt::format("the suite has no cell of '{}'", text); });
  };
  keep(problems, &Request::problem, complete_problem);
  keep(optimizers, &Request::optimizer, complete_optimizer);
  return requests;
}

}  // namespace isoline::benchmarks
