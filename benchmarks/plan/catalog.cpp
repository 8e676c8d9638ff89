// The built-in catalog, the completion of component names and options, and the digests of the
// sources of components.
#include "benchmarks/plan/catalog.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

#include "benchmarks/plan/rates.h"
#include "core/files.h"
#include "core/foreign/handshake.h"
#include "core/foreign/plugin_library.h"
#include "core/options.h"
#include "core/records/npy.h"
#include "core/records/provenance.h"
#include "optimizers/optimizer.h"
#include "problems/features.h"
#include "problems/model.h"
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
  const std::string best = BestLosses::known().losses_text(problem);
  if (!best.empty()) parts["best"] = digest(best);
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

// The entry with the options that another program declares. What it says otherwise, such as the
// standard deviations of its data, may follow from the values that are given.
template <class Entry>
Entry with_declared(Entry entry, const OptionValues& given, std::optional<Foreign>& foreign) {
  if (!entry.introduce) return entry;
  OptionValues known;
  for (const OptionField& field : entry.options)
    if (const OptionValue* value = given.find(field.name)) known.set(field.name, *value);
  foreign = entry.introduce(complete_options(entry.options, entry.name, known));
  OptionTable own = entry.options;
  bool is_given = false;
  for (const OptionField& field : foreign->options) {
    if (field.doc == kWordOfScript) continue;
    own.push_back(field);
    const OptionValue* const value = given.find(field.name);
    if (value == nullptr) continue;
    known.set(field.name, *value);
    is_given = true;
  }
  if (is_given) foreign = entry.introduce(complete_options(own, entry.name, known));
  entry.options.insert(entry.options.end(), foreign->options.begin(), foreign->options.end());
  return entry;
}

template <class Entry>
Component complete(const Entry& registered, const OptionValues& given) {
  std::optional<Foreign> foreign;
  Entry entry = with_declared(registered, given, foreign);
  OptionTable features;  // they stand in options only where they differ from their defaults
  if constexpr (std::is_same_v<Entry, ProblemEntry>) {
    features = problems::feature_table(entry.options);
    entry.options.insert(entry.options.end(), features.begin(), features.end());
  }
  OptionValues options = complete_options(entry.options, entry.name, given);
  Component component{.name = entry.name,
                      .spec = short_spec(entry.options, entry.name, options),
                      .asked = asked_spec(entry.options, entry.name, given, options),
                      .is_learned = asks_to_learn(options),
                      .sources = source_digest(entry.file)};
  if (foreign && !foreign->options.empty())
    foreign->label = short_spec(foreign->options, foreign->label, declared_values(options));
  component.foreign = std::move(foreign);
  component.sources = with_foreign(component, component.sources);
  for (const OptionField& feature : features)
    if (options.at(feature.name) == feature.standard) options.erase(feature.name);
  component.options = std::move(options);
  return component;
}

// A start and a target of the user's own.

constexpr std::size_t kFileDigits = 16;

struct NamedFile {
  std::string path, digest;
};

// "mine.npy", or "mine.npy@0123456789abcdef".
NamedFile named_file(const std::string& given) {
  const auto at = given.rfind('@');
  const bool has_digest = at != given.npos && given.size() - at == kFileDigits + 1 &&
                          given.find_first_not_of("0123456789abcdef", at + 1) == given.npos;
  return has_digest ? NamedFile{given.substr(0, at), given.substr(at + 1)} : NamedFile{given, ""};
}

// The path with the digest of its content, if it has none, or one that is the same.
std::string with_digest(const std::string& problem, const std::string& given) {
  const NamedFile file = named_file(given);
  read_numbers(file.path);  // what it cannot read is refused before any run
  const std::string now = digest(read_text(file.path));
  require(file.digest.empty() || file.digest == now, [&] {
    return fmt::format("{}: the content of {} has changed: its digest is {}, and was {}", problem,
                       file.path, now, file.digest);
  });
  return file.path + "@" + now;
}

// The words of a model that accept a file.
constexpr std::array kFileWords = {"sigma", "weights"};
bool is_file(const std::string& given) {
  std::error_code is_too_long;  // a list of numbers
  return !given.empty() && std::filesystem::exists(named_file(given).path, is_too_long);
}

// The problem's entry with the options for files, each with the digest of its content.
ProblemEntry with_files(ProblemEntry entry, OptionValues& given) {
  require(!asks_to_learn(given), [&] {
    return fmt::format("{}: learned problems do not accept a start or a target from a file",
                       entry.name);
  });
  for (const char* option : {kStartOption, kTargetOption}) {
    entry.options.push_back({option, std::string(), {}, {}, ""});
    if (given.text(option).empty()) continue;
    given.set(option, with_digest(entry.name, given.text(option)));
  }
  return entry;
}

// Its numbers, row by row; a field's grid is stored column by column.
Matrix numbers_in_file(const Problem& problem, const std::string& what, const std::string& given,
                       Index wanted) {
  const std::string path = named_file(given).path;
  const NumberArray array = read_numbers(path);
  const auto& field = problem.field();
  const bool is_grid = field && !field->is_history() &&
                       array.shape == std::vector<Index>{field->rows, field->columns};
  require(static_cast<Index>(array.values.size()) == wanted, [&] {
    return fmt::format("{}: its shape is ({}), but the {} has {} numbers{}", path,
                       fmt::join(array.shape, ", "), what, wanted,
                       field && !field->is_history() && field->rows * field->columns == wanted
                           ? fmt::format(", ({}, {}) as a grid", field->rows, field->columns)
                           : "");
  });
  Matrix numbers = Eigen::Map<const Vector>(array.values.data(), wanted);
  if (is_grid)
    numbers.reshaped(field->rows, field->columns) =
        Eigen::Map<const Matrix>(array.values.data(), field->columns, field->rows).transpose();
  return numbers;
}

// With the data of another model, that is the problem with these options instead.
Problem made_with_features(const ProblemEntry& entry, const Component& problem,
                           OptionValues options, std::uint64_t seed) {
  const std::string start = options.text(kStartOption), own_target = options.text(kTargetOption);
  for (const char* option : {kStartOption, kTargetOption}) options.erase(option);
  const Draw draw(seed, problem.name);
  OptionTable declared = entry.options;
  if (problem.foreign)
    declared.insert(declared.end(), problem.foreign->options.begin(),
                    problem.foreign->options.end());
  OptionValues own, features;
  for (const auto& [name, value] : options) {
    const auto known = std::ranges::find(declared, name, &OptionField::name);
    const bool is_feature = known == declared.end() || known->doc == kWordOfScript;
    (is_feature ? features : own).set(name, value);
  }
  const auto with_own_data = [&](Problem made) {
    if (!start.empty())
      made.set_start(numbers_in_file(made, "start of " + problem.name, start, made.unknowns()));
    if (!own_target.empty())
      made.set_target(
          numbers_in_file(made, "target of " + problem.name, own_target, made.outputs()));
    return made;
  };
  Problem plain = entry.make(own, draw);
  const bool has_words = std::ranges::any_of(option_table<problems::ModelWords>(), [&](auto& word) {
    return features.contains(word.name);
  });
  if (has_words) {  // they are of x, as the files are
    plain = with_own_data(std::move(plain));
    for (const char* word : kFileWords)
      if (const auto file = features.text(word); is_file(file)) {
        const std::string path = named_file(file).path;
        const std::vector<Real> numbers = read_numbers(path).values;
        problems::require_factors(numbers, path + ": " + word, plain.outputs());
        features.set(word, fmt::format("{}", fmt::join(numbers, ";")));
      }
  }
  std::optional<Matrix> target;
  if (const std::string model = features.text("model"); !model.empty()) {
    OptionValues other = own;
    other.set_all(options_of(parse_spec(entry.name + "[" + model + "]")));
    target = entry.make(complete_options(declared, entry.name, other), draw).target();
  }
  Problem made = problems::with_features(std::move(plain), features, draw, target);
  return has_words ? std::move(made) : with_own_data(std::move(made));
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

Problem made_without_best(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  return made_with_features(catalog.problems.at(problem.name), problem, problem.options, seed);
}

bool can_learn(const ProblemEntry& entry) {
  return std::ranges::find(entry.options, kModeOption, &OptionField::name) != entry.options.end();
}

// Without this check, a request to learn would end as an unknown option.
void require_learnable(const Catalog& catalog, const ProblemEntry& entry) {
  if (can_learn(entry)) return;
  std::string learnable;
  for (const auto& [name, other] : catalog.problems)
    if (can_learn(other)) learnable += (learnable.empty() ? "" : ", ") + name;
  throw UsageError(fmt::format("{} cannot train a network (mode=learn); these problems can: {}",
                               entry.name, learnable));
}

// The direct problem ignores these options: its settings would be equal under several names.
void require_no_learning(const ProblemEntry& entry, const OptionValues& options) {
  const auto mode = std::ranges::find(entry.options, kModeOption, &OptionField::name);
  require(mode->standard == OptionValue(std::string(kDirectMode)),
          [&] { return entry.name + " has only mode=learn; remove mode=direct"; });
  for (const OptionField& field : entry.options)
    if (std::ranges::find(kLearningOptions, field.name) != kLearningOptions.end() &&
        options.at(field.name) != field.standard)
      throw UsageError(fmt::format("{}: {}={} requires mode=learn", entry.name, field.name,
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
  const ProblemEntry& declared = catalog.problems.at(name);
  OptionValues given = options;
  const bool has_files = given.contains(kStartOption) || given.contains(kTargetOption);
  const ProblemEntry entry = has_files ? with_files(declared, given) : declared;
  const OptionTable features = problems::feature_table(entry.options);
  for (const char* word : kFileWords)
    if (std::ranges::find(features, word, &OptionField::name) != features.end() &&
        given.contains(word) && is_file(option_text(given.at(word))))
      given.set(word, with_digest(name, given.text(word)));
  if (asks_to_learn(options)) require_learnable(catalog, entry);
  Component problem = complete(entry, given);
  if (can_learn(entry) && !problem.is_learned) require_no_learning(entry, problem.options);
  if (problem.is_learned) {
    const std::string network = problem.options.text(kNetworkOption);
    // A problem without this option has a network of its own.
    const std::string file = network.empty()
                                 ? entry.file
                                 : networks::network_registry().at(parse_spec(network).name).file;
    problem.learning_sources = source_digest(file);
  }
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

OptimizerEntry entry_of(const Catalog& catalog, const std::string& optimizer,
                        const OptionValues& given) {
  std::optional<Foreign> foreign;
  OptimizerEntry entry = with_declared(catalog.optimizers.at(optimizer), given, foreign);
  if (foreign && !foreign->tunable.empty()) entry.tunable.option = foreign->tunable;
  return entry;
}

Component complete_optimizer(const Catalog& catalog, const Spec& spec) {
  return complete_optimizer(catalog, spec.name, options_of(spec));
}

Problem make_for_methods(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  const OptionValue* const scales = problem.options.find("scale-unknowns");
  Problem made = make_problem(catalog, problem, seed);
  return scales && *scales == OptionValue(true) ? problems::with_scaled_unknowns(std::move(made))
                                                : std::move(made);
}

Problem make_problem(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  Problem made = made_without_best(catalog, problem, seed);
  const std::optional<Real> best = BestLosses::known().find(problem, seed);
  if (best && !made.minimum()) made.set_minimum(*best);
  return made;
}

bool declares_minimum(const Catalog& catalog, const Component& problem, std::uint64_t seed) {
  return made_without_best(catalog, problem, seed).minimum().has_value();
}

}  // namespace isoline::benchmarks
