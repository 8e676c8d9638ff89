// Suites read from JSON and expanded into requests.
#include "benchmarks/plan/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/filter.h"
#include "benchmarks/plan/resources.h"
#include "core/json.h"
#include "core/records/schema.h"
#include "core/spec.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

Budget budget_from(const Json& json) {
  Budget budget;
  budget.iterations = json.value("iterations", budget.iterations);
  budget.work = json.value("work", budget.work);
  if (json.contains("seconds")) budget.seconds = real_of(json["seconds"]);
  budget.target = json.value("target", budget.target);
  return budget;
}

MatrixBlock block_from(const Json& json) {
  const std::vector<std::string> none;
  return {.problems = json.at("problems"),
          .optimizers = json.at("optimizers"),
          .except_problems = json.value("except_problems", none),
          .except_optimizers = json.value("except_optimizers", none),
          .seeds = parse_seeds(json.value("seeds", "=0")),
          .budget = budget_from(json.value("budget", Json::object())),
          .threads = json.value("threads", 1),
          .hard_seconds = json.value("hard_seconds", 0.0),
          .rates = json.value("rates", "")};
}

bool is_excepted(const std::string& name, const std::vector<std::string>& excepted) {
  return std::ranges::find(excepted, name) != excepted.end();
}

std::vector<Spec> chosen_problems(const Catalog& catalog, const MatrixBlock& block) {
  std::vector<Spec> specs;
  for (const std::string& text : block.problems) {
    if (text != "*") {
      for (Spec& spec : parse_specs(text)) specs.push_back(std::move(spec));
      continue;
    }
    for (const auto& [name, entry] : catalog.problems)
      if (entry.in_all && !is_excepted(name, block.except_problems)) specs.push_back({name, {}});
  }
  return specs;
}

std::vector<Spec> chosen_optimizers(const Catalog& catalog, const MatrixBlock& block) {
  std::vector<Spec> specs;
  for (const std::string& text : block.optimizers) {
    if (text != "*" && !text.starts_with('@')) {
      for (Spec& spec : parse_specs(text)) specs.push_back(std::move(spec));
      continue;
    }
    const std::size_t before = specs.size();
    for (const auto& [name, entry] : catalog.optimizers)
      if (entry.in_all && is_selected(entry, text) && !is_excepted(name, block.except_optimizers))
        specs.push_back({name, {}});
    require(specs.size() > before, [&] { return fmt::format("'{}' selects no optimizer", text); });
  }
  return specs;
}

void expand_block(const Catalog& catalog, const MatrixBlock& block, const Rates& rates,
                  std::set<std::string>& known, std::vector<Request>& requests) {
  const std::vector<Spec> optimizers = chosen_optimizers(catalog, block);
  for (const Spec& problem_spec : chosen_problems(catalog, block)) {
    const Component problem = complete_problem(catalog, problem_spec);
    for (const Spec& spec : optimizers) {
      const bool is_at_defaults = block.rates == "none";
      const Rates::Row* row =
          is_at_defaults ? nullptr : rates.find(problem, spec.name, block.rates);
      const Component optimizer = with_rates(catalog, spec, row);
      for (const std::uint64_t seed : block.seeds) {
        Request request = named({.problem = problem,
                                 .optimizer = optimizer,
                                 .seed = seed,
                                 .budget = block.budget,
                                 .threads = block.threads,
                                 .rates = row ? row->origin : "",
                                 .hard_seconds = block.hard_seconds});
        if (known.insert(request.cell).second) requests.push_back(std::move(request));
      }
    }
  }
}

}  // namespace

Component with_rates(const Catalog& catalog, const Spec& spec, const Rates::Row* row) {
  OptionValues options = row ? row->options : OptionValues();
  for (const auto& [key, value] : options_of(spec)) options.set(key == "lr" ? "rate" : key, value);
  Component optimizer = complete_optimizer(catalog, spec.name, options);
  optimizer.asked = complete_optimizer(catalog, spec).asked;
  return optimizer;
}

Suite suite_from_json(const Json& json, const std::string& origin) {
  const Json schema = parse_json(std::string(builtin_schemas().at("suite")), "suite schema");
  const auto violations = schema_violations(json, schema);
  require(violations.empty(),
          [&] { return fmt::format("{} is no suite: {}", origin, violations[0]); });
  Suite suite{.name = json.at("name"), .title = json.value("title", ""), .blocks = {}};
  for (const Json& block : json.at("matrix")) suite.blocks.push_back(block_from(block));
  return suite;
}

Suite read_suite(const std::string& name_or_path) {
  const auto& builtin = builtin_suites();
  const auto found = builtin.find(name_or_path);
  if (found != builtin.end())
    return suite_from_json(parse_json(std::string(found->second), name_or_path), name_or_path);
  if (fs::exists(name_or_path)) return suite_from_json(read_json(name_or_path), name_or_path);
  std::vector<std::string> names;
  for (const auto& [name, text] : builtin) names.push_back(name);
  throw UsageError(unknown_name("suite", name_or_path, names));
}

std::vector<Request> expand(const Catalog& catalog, const Suite& suite, const Rates& rates) {
  std::vector<Request> requests;
  std::set<std::string> known;
  for (const MatrixBlock& block : suite.blocks)
    expand_block(catalog, block, rates, known, requests);
  return requests;
}

}  // namespace isoline::benchmarks
