// Selectors and filters over the catalog.
#include "benchmarks/plan/filter.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"

namespace isoline::benchmarks {

using optimizers::Family;
namespace {

// What a step costs, which decides the grids that a method can be given.
std::string_view cost_class(const OptimizerEntry& entry) {
  if (entry.family == Family::nlopt_derivative_free) return "derivative-free";
  constexpr Index kUnlimited = std::numeric_limits<Index>::max();
  const bool is_limited = entry.most_unknowns < kUnlimited || entry.most_rank < kUnlimited;
  return is_limited ? "factorizing" : "matrix-free";
}

bool is_selector(const std::string& name) { return name == "*" || name.starts_with('@'); }

// A spec with its options as its component would have them.
struct Wanted {
  std::string name;
  OptionValues options;
};

template <class Registered>
std::vector<Wanted> wanted_in(const Registered& registry, const std::string& text) {
  std::vector<Wanted> all;
  for (const Spec& spec : parse_specs(text)) {
    Wanted wanted{.name = spec.name, .options = {}};
    if (!is_selector(spec.name)) {
      const auto& table = registry.at(spec.name).options;
      const OptionValues complete = complete_options(table, spec.name, options_of(spec));
      for (const auto& [name, value] : options_of(spec))
        wanted.options.set(name, complete.at(name));
    }
    all.push_back(std::move(wanted));
  }
  return all;
}

bool is_among(const std::vector<Wanted>& all, const Component& component,
              const OptimizerEntry* entry) {
  return all.empty() || std::ranges::any_of(all, [&](const Wanted& wanted) {
           if (is_selector(wanted.name))
             return wanted.name == "*" || (entry && is_selected(*entry, wanted.name));
           return wanted.name == component.name &&
                  std::ranges::all_of(wanted.options, [&](const NamedOption& each) {
                    const OptionValue* has = component.options.find(each.name);
                    return has && *has == each.value;
                  });
         });
}

}  // namespace

bool is_selected(const OptimizerEntry& entry, const std::string& selector) {
  return selector == "*" || selector == fmt::format("@{}", name_of(entry.family)) ||
         selector == fmt::format("@{}", cost_class(entry));
}

std::vector<Request> filtered(const Catalog& catalog, std::vector<Request> requests,
                              const std::string& problems, const std::string& optimizers) {
  const auto of_problems =
      problems.empty() ? std::vector<Wanted>() : wanted_in(catalog.problems, problems);
  const auto of_optimizers =
      optimizers.empty() ? std::vector<Wanted>() : wanted_in(catalog.optimizers, optimizers);
  std::erase_if(requests, [&](const Request& request) {
    return !is_among(of_problems, request.problem, nullptr) ||
           !is_among(of_optimizers, request.optimizer,
                     &catalog.optimizers.at(request.optimizer.name));
  });
  require(!requests.empty(), [&] {
    return fmt::format("no cell of the plan has {}{}{}", problems,
                       problems.empty() || optimizers.empty() ? "" : " with ", optimizers);
  });
  return requests;
}

}  // namespace isoline::benchmarks
