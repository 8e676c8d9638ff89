// The built-in catalog, the completion of component names and options, and the digests of the
// sources of components.
#include "benchmarks/plan/catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "benchmarks/plan/rates.h"
#include "core/files.h"
#include "core/foreign/plugin_library.h"
#include "core/options.h"
#include "core/records/provenance.h"
#include "optimizers/optimizer.h"
#include "problems/features.h"
#include "problems/problem.h"

namespace isoline::benchmarks {

// Digests of sources, looked up by file and joined to that of a build.

namespace {

using Digests = std::map<std::string, std::string>;

Digests& program_sources() {
  static Digests all;
  return all;
}

// A compiler names a file from wherever it was called: "/home/me/isoline/problems/heat.cpp".
const std::string* found_in(const Digests& digests, const std::string& file) {
  for (std::size_t begin = 0; begin != std::string::npos;) {
    const auto found = digests.find(file.substr(begin));
    if (found != digests.end()) return &found->second;
    begin = file.find('/', begin);
    if (begin != std::string::npos) ++begin;
  }
  return nullptr;
}

const std::string& program_digest() {
  static const std::string found = digest(read_text("/proc/self/exe"));
  return found;
}

}  // namespace

void set_program_sources(std::string_view lines) {
  std::istringstream in{std::string(lines)};
  for (std::string file, one; in >> file >> one;) program_sources()[file] = one;
}

std::string source_digest(const std::string& file) {
  if (const std::string* own = found_in(program_sources(), file)) return *own;
  if (const std::string* ours = found_in(tree_sources(), file)) return *ours;
  return program_digest();
}

BuildParts build_parts(const Request& request) {
  const Component &problem = request.problem, &optimizer = request.optimizer;
  BuildParts parts{
      {"platform", platform_digest()},
      {"harness", tree_sources().at("harness")},
      {"problem", problem.sources},
      {"optimizer", problem.is_learned ? optimizer.learning_sources : optimizer.sources}};
  if (problem.is_learned) parts["network"] = problem.learning_sources;
  return parts;
}

std::string build_digest(const Request& request) {
  std::string text;
  for (const auto& [part, one] : build_parts(request))
    text.append(part).append(" ").append(one).append("\n");
  return digest(text);
}

// The built-in catalog, and components completed from their names and options.

namespace {

// All that is given, even where it is the default.
std::string asked_spec(const OptionTable& table, const std::string& name, const OptionValues& given,
                       const OptionValues& complete) {
  OptionTable asked;
  for (const OptionField& field : table) {
    if (!given.contains(field.name)) continue;
    asked.push_back(field);
    // A default of another type equals no value, and what differs from its default is written.
    const bool is_flag = std::holds_alternative<bool>(field.standard);
    asked.back().standard = is_flag ? OptionValue(Index{0}) : OptionValue(false);
  }
  return short_spec(asked, name, complete);
}

// A changed script is another build.
std::string with_foreign(const Component& component, const std::string& sources) {
  return component.foreign ? digest(sources + digest_of(*component.foreign)) : sources;
}

template <class Entry>
Component complete(const Entry& entry, const OptionValues& given) {
  OptionValues options = complete_options(entry.options, entry.name, given);
  Component component{.name = entry.name,
                      .spec = short_spec(entry.options, entry.name, options),
                      .asked = asked_spec(entry.options, entry.name, given, options),
                      .is_learned = asks_to_learn(options),
                      .sources = source_digest(entry.file)};
  if (entry.introduce) component.foreign = entry.introduce(options);
  component.sources = with_foreign(component, component.sources);
  component.options = std::move(options);
  return component;
}

// Features stand behind the options of the problem itself, and only where they differ from the
// defaults.
Component complete_with_features(const ProblemEntry& entry, const OptionValues& given) {
  ProblemEntry featured = entry;
  featured.options = options_with_features(entry);
  Component problem = complete(featured, given);
  for (const OptionField& field : problems::feature_table(entry.options))
    if (problem.options.at(field.name) == field.standard) problem.options.erase(field.name);
  return problem;
}

// With the data of another model, that is the problem with these options instead.
Problem made_with_features(const ProblemEntry& entry, const Component& problem,
                           std::uint64_t seed) {
  const Draw draw(seed, problem.name);
  OptionValues own, features;
  for (const auto& [name, value] : problem.options) {
    const bool is_own =
        std::ranges::find(entry.options, name, &OptionField::name) != entry.options.end();
    (is_own ? own : features).set(name, value);
  }
  Problem plain = entry.make(own, draw);
  std::optional<Matrix> target;
  if (const std::string model = features.text("model"); !model.empty()) {
    OptionValues other = own;
    other.set_all(options_of(parse_spec(entry.name + "[" + model + "]")));
    target = entry.make(complete_options(entry.options, entry.name, other), draw).target();
  }
  return problems::with_features(std::move(plain), features, draw, target);
}

// The sources of a method and of the method inside it.
std::string digest_of(const Catalog& catalog, const OptimizerEntry& entry,
                      const OptionValues& options, bool is_learning) {
  std::string all = source_digest(entry.file);
  if (!entry.inside) return all;
  for (const std::string& spec : entry.inside(options, is_learning))
    all += source_digest(catalog.optimizers.at(parse_spec(spec).name).file);
  return digest(all);
}

bool can_learn(const ProblemEntry& entry) {
  return std::ranges::find(entry.options, kNetworkOption, &OptionField::name) !=
         entry.options.end();
}

// Without this check, a request to learn would end as an unknown option.
void require_learnable(const Catalog& catalog, const ProblemEntry& entry) {
  if (can_learn(entry)) return;
  std::string learnable;
  for (const auto& [name, other] : catalog.problems)
    if (can_learn(other)) learnable += (learnable.empty() ? "" : ", ") + name;
  throw UsageError(fmt::format("{} cannot be learned; these can: {}", entry.name, learnable));
}

// The direct problem ignores these options: its settings would be equal under several names.
void require_no_learning(const ProblemEntry& entry, const OptionValues& options) {
  const auto mode = std::ranges::find(entry.options, kModeOption, &OptionField::name);
  require(mode->standard == OptionValue(std::string(kDirectMode)),
          [&] { return entry.name + " can only be learned: mode=direct does not apply"; });
  for (const OptionField& field : entry.options)
    if (std::ranges::find(kLearningOptions, field.name) != kLearningOptions.end() &&
        options.at(field.name) != field.standard)
      throw UsageError(fmt::format("{}: {}={} needs mode=learn", entry.name, field.name,
                                   option_text(options.at(field.name))));
}

}  // namespace

OptionTable options_with_features(const ProblemEntry& entry) {
  OptionTable all = entry.options;
  for (OptionField& field : problems::feature_table(entry.options)) all.push_back(std::move(field));
  return all;
}

Catalog builtin_catalog() {
  Catalog catalog;
  problems::register_problems(catalog.problems);
  optimizers::register_optimizers(catalog.optimizers);
  return catalog;
}

void add_plugin(Catalog& catalog, const std::string& path) {
  for (const PluginComponent& component : load_plugin(path)) try {
      if (component.is_optimizer)
        optimizers::add_plugin_method(catalog.optimizers, component);
      else
        problems::add_plugin_physics(catalog.problems, component);
    } catch (const UsageError& error) {
      throw UsageError(path + ": " + error.what());
    }
}

Component complete_problem(const Catalog& catalog, const std::string& name,
                           const OptionValues& options) {
  const ProblemEntry& entry = catalog.problems.at(name);
  if (asks_to_learn(options)) require_learnable(catalog, entry);
  Component problem = complete_with_features(entry, options);
  if (can_learn(entry) && !problem.is_learned) require_no_learning(entry, problem.options);
  if (problem.is_learned) {
    const std::string network = parse_spec(problem.options.text(kNetworkOption)).name;
    problem.learning_sources = source_digest(networks::network_registry().at(network).file);
  }
  const std::string best = BestLosses::known().losses_text(problem);
  if (!best.empty()) problem.sources = digest(problem.sources + best);
  return problem;
}

Component complete_optimizer(const Catalog& catalog, const std::string& name,
                             const OptionValues& options) {
  const OptimizerEntry& entry = catalog.optimizers.at(name);
  Component optimizer = complete(entry, options);
  // Refuses a bad optimizer inside another; what is foreign has introduced itself already.
  if (!entry.introduce) entry.make(optimizer.options, catalog.optimizers);
  optimizer.sources = with_foreign(optimizer, digest_of(catalog, entry, optimizer.options, false));
  optimizer.learning_sources =
      with_foreign(optimizer, digest_of(catalog, entry, optimizer.options, true));
  return optimizer;
}

Component complete_problem(const Catalog& catalog, const Spec& spec) {
  return complete_problem(catalog, spec.name, options_of(spec));
}

Component complete_optimizer(const Catalog& catalog, const Spec& spec) {
  return complete_optimizer(catalog, spec.name, options_of(spec));
}

Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  Problem made = made_with_features(catalog.problems.at(problem.name), problem, seed);
  const std::optional<Real> best = BestLosses::known().find(problem, seed);
  if (best && !made.minimum()) made.set_minimum(*best);
  return made;
}

bool declares_minimum(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  return made_with_features(catalog.problems.at(problem.name), problem, seed).minimum().has_value();
}

}  // namespace isoline::benchmarks
