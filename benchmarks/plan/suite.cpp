// Suites read from JSON and expanded into requests.
#include "benchmarks/plan/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <unordered_set>

#include "benchmarks/plan/catalog.h"
#include "core/foreign/foreign.h"
#include "core/json.h"
#include "core/records/json_view.h"
#include "core/spec.h"
#include "core/text.h"

namespace isoline::benchmarks {
static bool is_selected(const ProblemEntry&, const std::string& selector) {
  return selector == "*";
}

namespace {

namespace fs = std::filesystem;

// The schema requires a whole number from 1 on, but does not know the largest number of the type.
std::int64_t amount_in(const Json& json, const char* name, std::int64_t standard) {
  if (!json.contains(name)) return standard;
  const auto amount = json[name].get<std::uint64_t>();
  require(amount <= kMostAmount, [&] {
    return fmt::format("{} must be at most {}, got {}", name, count_text(kMostAmount),
                       count_text(amount));
  });
  return static_cast<std::int64_t>(amount);
}

struct StoppingRule {
  Real tau = 1.1;
};
void fields(StoppingRule& o, auto& field) {
  field("tau", o.tau, between(1, 100), "factor of the noise level");
}

Budget budget_from(const Json& json) {
  Budget budget;
  budget.iterations = amount_in(json, "iterations", budget.iterations);
  budget.work = amount_in(json, "work", budget.work);
  if (json.contains("seconds")) budget.seconds = real_of(json["seconds"]);
  budget.target = json.value("target", budget.target);
  if (json.contains("stall"))
    budget.stall = json["stall"].is_string() ? 0 : amount_in(json, "stall", kStallIterations);
  if (budget.stall == kStallIterations) budget.stall.reset();  // the cell of the standard
  if (json.contains("stop")) budget.discrepancy = discrepancy_of(json["stop"]);
  return budget;
}

std::vector<std::uint64_t> seeds_from(const Json& json) {
  if (!json.contains("instances") && !json.contains("starts"))
    return parse_seeds(json.value("seeds", "=0"));
  require(!json.contains("seeds"), "it must have either seeds, or instances and starts");
  return crossed_seeds(json.value("instances", ""), json.value("starts", ""));
}

MatrixBlock block_from(const Json& json) {
  const std::vector<std::string> none;
  MatrixBlock block{.problems = json.at("problems"),
                    .optimizers = json.at("optimizers"),
                    .except_problems = json.value("except_problems", none),
                    .except_optimizers = json.value("except_optimizers", none),
                    .features = json.value("features", none),
                    .seeds = seeds_from(json),
                    .threads = json.value("threads", 1),
                    .hard_seconds = json.value("hard_seconds", 0.0),
                    .rates = json.value("rates", "")};
  block.budget = budget_from(json.value("budget", Json::object()));
  return block;
}

bool is_selector(const std::string& text) { return text == "*" || text.starts_with('@'); }

// A list such as "gd,@factorizing" in parts; its selectors stand first or last.
std::vector<std::string> parts_of(std::string text) {
  std::vector<std::string> parts;
  for (auto at = text.find(','); at != text.npos && is_selector(text.substr(0, at));
       at = text.find(',')) {
    parts.push_back(text.substr(0, at));
    text.erase(0, at + 1);
  }
  for (auto at = text.rfind(','); at != text.npos && is_selector(text.substr(at + 1));
       at = text.rfind(',')) {
    parts.push_back(text.substr(at + 1));
    text.erase(at);
  }
  parts.push_back(std::move(text));
  return parts;
}

// The scripts of clients/peers whose packages are installed, by the list that one of them prints.
const std::vector<std::string>& peer_specs() {
  static const std::vector<std::string> all = [] {
    const std::string script = (client_folder("peers") / "peers.py").string();
    std::vector<std::string> specs;
    std::string line;
    FILE* const list = popen(fmt::format("python3 '{}'", script).c_str(), "r");
    for (int each = 0; list != nullptr && (each = std::fgetc(list)) != EOF;) {
      if (each != '\n') {
        line += static_cast<char>(each);
        continue;
      }
      specs.push_back(std::move(line));
      line.clear();
    }
    require(list != nullptr && pclose(list) == 0 && !specs.empty(), [&] {
      return fmt::format("'@peers' needs a package that `python3 {} packages` names", script);
    });
    return specs;
  }();
  return all;
}

// The names in a block, with selectors replaced by the names that they match.
template <class Registered>
std::vector<std::string> named_specs(const Registered& registry,
                                     const std::vector<std::string>& texts,
                                     const std::vector<std::string>& excepted) {
  std::vector<std::string> specs;
  for (const std::string& whole : texts)
    for (const std::string& text : parts_of(whole)) {
      if (!is_selector(text)) {
        specs.push_back(text);
        continue;
      }
      const std::size_t before = specs.size();
      if (std::is_same_v<Registered, OptimizerRegistry> && text == "@peers")
        specs.insert(specs.end(), peer_specs().begin(), peer_specs().end());
      for (const auto& [name, entry] : registry)
        if (entry.in_all && is_selected(entry, text) &&
            std::ranges::find(excepted, name) == excepted.end())
          specs.push_back(name);
      require(specs.size() > before, [&] { return fmt::format("'{}' selects nothing", text); });
    }
  return specs;
}

std::vector<std::string> problem_specs(const Catalog& catalog, const MatrixBlock& block) {
  return named_specs(catalog.problems, block.problems, block.except_problems);
}

std::vector<std::string> optimizer_specs(const Catalog& catalog, const MatrixBlock& block) {
  return named_specs(catalog.optimizers, block.optimizers, block.except_optimizers);
}

std::vector<Spec> parsed_specs(const std::vector<std::string>& texts, std::uint64_t most) {
  std::vector<Spec> specs;
  for (const std::string& text : texts)
    for (Spec& spec : parse_specs(text, most)) specs.push_back(std::move(spec));
  return specs;
}

// Each problem of a block, with each of its features in turn.
std::vector<Spec> featured_problems(const Catalog& catalog, const MatrixBlock& block,
                                    std::uint64_t most) {
  std::vector<Spec> plain = parsed_specs(problem_specs(catalog, block), most), all;
  if (block.features.empty()) return plain;
  for (const std::string& feature : block.features)
    for (Spec problem : plain) {
      if (feature != "plain")
        for (auto& option : parse_spec("feature[" + feature + "]").options)
          problem.options.push_back(std::move(option));
      all.push_back(std::move(problem));
    }
  return all;
}

}  // namespace

Real discrepancy_of(const std::string& stop) {
  const Spec spec = parse_spec(stop);
  require(spec.name == "discrepancy" || stop == "none", [&] {
    return fmt::format(
        "a stopping rule must be 'none' or 'discrepancy' (with the option tau, as in "
        "'discrepancy[tau=1.5]'), got '{}'",
        stop);
  });
  if (stop == "none") return 0;
  return read_options<StoppingRule>(
             complete_options(option_table<StoppingRule>(), spec.name, options_of(spec)))
      .tau;
}

Component with_rates(const Catalog& catalog, const Spec& spec, const Rates::Row* row) {
  OptionValues options = row ? row->options : OptionValues();
  options.set_all(options_of(spec));
  Component optimizer = complete_optimizer(catalog, spec.name, options);
  optimizer.asked = complete_optimizer(catalog, spec).asked;
  return optimizer;
}

static Suite builtin_suite(const std::string& name) {
  const auto& builtin = builtin_suites();
  if (const auto found = builtin.find(name); found != builtin.end())
    return suite_from_json(parse_json(std::string(found->second), name), name);
  require(!name.ends_with(".json"), [&] { return name + ": no such file"; });
  std::vector<std::string> names;
  for (const auto& [known, text] : builtin) names.push_back(known);
  throw UsageError(unknown_name("suite", name, names));
}

void require_valid(const Json& json, const std::string& schema, const std::string& origin) {
  thread_local std::map<std::string, Schema> read;  // claims have hundreds of suites
  if (!read.contains(schema))
    read.try_emplace(schema, parse_json(std::string(builtin_schemas().at(schema)), schema));
  const auto violations = read.at(schema).violations(json);
  require(violations.empty(), [&] {
    return fmt::format("{} violates the schema '{}': {}", origin, schema, violations[0]);
  });
}

std::string Suite::label() const {
  return version > 0 ? fmt::format("{}@{}", name, version) : name;
}

Suite suite_from_json(const Json& json, const std::string& origin) {
  require_valid(json, "suite", origin);
  Suite suite{.name = json.at("name"),
              .title = json.value("title", ""),
              .version = amount_in(json, "version", 0),
              .blocks = {}};
  if (json.contains("cells_of")) try {
      suite.blocks = builtin_suite(json["cells_of"]).blocks;
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{}: cells_of: {}", origin, error.what()));
    }
  try {
    for (const Json& block : json.value("matrix", Json::array()))
      suite.blocks.push_back(block_from(block));
  } catch (const UsageError& error) {
    throw UsageError(
        fmt::format("{}: block {}: {}", origin, suite.blocks.size() + 1, error.what()));
  }
  for (MatrixBlock& block : suite.blocks) {
    block.rates = json.value("rates", block.rates);
    block.optimizers = json.value("optimizers", block.optimizers);
    block.except_optimizers = json.value("except_optimizers", block.except_optimizers);
  }
  return suite;
}

Suite read_suite(const std::string& name_or_path) {
  if (!builtin_suites().contains(name_or_path) && fs::exists(name_or_path))
    return suite_from_json(read_json(name_or_path), name_or_path);
  return builtin_suite(name_or_path);
}

// Whether a row of rates sets an option that the text of the optimizer leaves open.
static bool sets_an_option(const Rates::Row& row, const Spec& spec) {
  const OptionValues given = options_of(spec);
  return row.options.empty() || std::ranges::any_of(row.options, [&](const NamedOption& option) {
           return !given.contains(option.name);
         });
}

std::vector<Request> expand(const Catalog& catalog, const Suite& suite, const Rates& rates,
                            std::uint64_t most) {
  const PlanSize size = size_of(catalog, suite);
  require(size.cells <= most, [&] { return too_large(size, most); });
  std::vector<Request> requests;
  std::unordered_set<std::string> known;
  for (const MatrixBlock& block : suite.blocks) {
    const std::vector<Spec> specs = parsed_specs(optimizer_specs(catalog, block), most);
    // All problems that share a row of rates use one component.
    std::map<std::pair<const Spec*, const Rates::Row*>, Component> optimizers;
    for (const Spec& problem_spec : featured_problems(catalog, block, most)) {
      OptionValues options = options_of(problem_spec);
      options.set_all(suite.problem_options);
      const Component problem = complete_problem(catalog, problem_spec.name, options);
      std::map<std::string, const Rates::Row*> rows;  // null: no row, or the suite uses defaults
      for (const Spec& spec : specs) {
        const auto [row, is_first] = rows.try_emplace(spec.name);
        const bool has_rates = catalog.optimizers.at(spec.name).needs_argument.empty();
        if (is_first && has_rates && block.rates != "none")
          row->second = rates.find(problem, spec.name, block.rates);
        const auto [optimizer, is_new] = optimizers.try_emplace({&spec, row->second});
        if (is_new) optimizer->second = with_rates(catalog, spec, row->second);
        Request request{
            .problem = problem,
            .optimizer = optimizer->second,
            .budget = block.budget,
            .threads = block.threads,
            .rates = row->second && sets_an_option(*row->second, spec) ? row->second->origin : "",
            .hard_seconds = block.hard_seconds};
        const CellNames names(request);
        for (const std::uint64_t seed : block.seeds) {
          request.seed = seed;
          request.cell = names.of(seed);
          if (known.insert(request.cell).second) requests.push_back(request);
        }
      }
    }
  }
  return requests;
}

// Selectors and filters over the catalog.

using optimizers::Family;
namespace {

// The cost class of a step, which decides the grids that a method can run on.
std::string_view cost_class(const OptimizerEntry& entry) {
  if (entry.family == Family::nlopt_derivative_free) return "derivative-free";
  constexpr Index kUnlimited = std::numeric_limits<Index>::max();
  const bool is_limited = entry.most_unknowns < kUnlimited || entry.most_rank < kUnlimited;
  return is_limited ? "factorizing" : "matrix-free";
}

// A spec with the options of its component.
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
      const OptionTable table = options_with_features(registry.at(spec.name));
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

// The size of a plan: the settings of its sweeps times each other, times its seeds.

namespace {

// Components with their settings.
class Settings {
 public:
  explicit Settings(const std::vector<std::string>& specs) {
    for (const std::string& text : specs)
      for (SweepSize& size : sweep_sizes(text)) {
        total_ = sum_of(total_, size.settings);
        all_.push_back(std::move(size));
      }
  }
  std::uint64_t total() const { return total_; }

  // "400 settings of sine", "17 problems", "401 settings of 2 problems, 400 of them of sine"
  std::string words(const char* kinds) const {
    const SweepSize& most = *std::ranges::max_element(all_, {}, &SweepSize::settings);
    if (all_.size() == 1) return fmt::format("{} settings of {}", count_text(total_), most.name);
    if (total_ == all_.size()) return fmt::format("{} {}", count_text(total_), kinds);
    return fmt::format("{} settings of {} {}, {} of them of {}", count_text(total_), all_.size(),
                       kinds, count_text(most.settings), most.name);
  }

 private:
  std::vector<SweepSize> all_;
  std::uint64_t total_ = 0;
};

PlanSize size_of(const Catalog& catalog, const MatrixBlock& block) {
  const Settings problems(problem_specs(catalog, block));
  const Settings optimizers(optimizer_specs(catalog, block));
  const std::uint64_t features = std::max<std::size_t>(1, block.features.size());
  PlanSize size{.cells = product_of(product_of(block.seeds.size(), features),
                                    product_of(problems.total(), optimizers.total())),
                .largest = ""};
  const auto add = [&](std::uint64_t count, const std::string& words) {
    if (count > 1) size.largest += (size.largest.empty() ? "" : " × ") + words;
  };
  if (size.cells == 0) return size;
  add(block.seeds.size(), count_text(block.seeds.size()) + " seeds");
  add(features, count_text(features) + " features");
  add(problems.total(), problems.words("problems"));
  add(optimizers.total(), optimizers.words("optimizers"));
  return size;
}

}  // namespace

PlanSize size_of(const Catalog& catalog, const Suite& suite) {
  PlanSize all;
  std::uint64_t most = 0;
  for (const MatrixBlock& block : suite.blocks) {
    PlanSize size = size_of(catalog, block);
    all.cells = sum_of(all.cells, size.cells);
    if (size.cells < most) continue;
    most = size.cells;
    all.largest = std::move(size.largest);
  }
  return all;
}

std::string too_large(const PlanSize& size, std::uint64_t most) {
  return fmt::format("the plan has {} cells, more than {}: {}", count_text(size.cells),
                     count_text(most), size.largest);
}

}  // namespace isoline::benchmarks
