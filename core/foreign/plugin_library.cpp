// Loads a library and never unloads it: its functions stay callable until the process ends.
#include "core/foreign/plugin_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "core/files.h"
#include "core/floating_point.h"
#include "core/foreign/isoline.h"
#include "core/text.h"

namespace isoline {
namespace {

constexpr std::uint64_t kMostComponents = 1000, kMostOptions = 100;
constexpr std::size_t kMostName = 64, kMostText = 4096;

constexpr std::uint64_t kOfBoth = ISOLINE_FORWARD | ISOLINE_PUSHFORWARD | ISOLINE_PULLBACK |
                                  ISOLINE_JACOBIAN | ISOLINE_INVERSE | ISOLINE_BOUNDS;
constexpr std::uint64_t kOfProblems = kOfBoth | ISOLINE_TRUTH;
constexpr std::uint64_t kOfOptimizers = kOfBoth | ISOLINE_STEP | ISOLINE_SOLVE | ISOLINE_COMPARES;

bool has(std::uint64_t capabilities, std::uint64_t all_of) {
  return (capabilities & all_of) == all_of;
}

// The constraints on one component of one library.
class Reader {
 public:
  Reader(std::string path, std::string digest, std::uint64_t which)
      : path_(std::move(path)), digest_(std::move(digest)), words_(fmt::format("no. {}", which)) {}

  PluginComponent read(const isoline_component& given) {
    check_version(given);
    PluginComponent made;
    made.table = std::make_shared<const isoline_component>(given);
    made.name = name_of(made.table->name, "name");
    words_ = made.name;
    made.title = checked_text("title", given.title);
    made.formula = checked_text("formula", given.formula);
    made.source = checked_text("source", given.source);
    if (given.note != nullptr) made.note = checked_text("note", given.note);
    made.is_optimizer = (given.capabilities & (ISOLINE_STEP | ISOLINE_SOLVE)) != 0;
    made.is_optimizer ? check_optimizer(*made.table) : check_problem(*made.table);
    read_options(*made.table, made);
    made.foreign = {.door = "plugin", .command = path_, .digest = digest_};
    return made;
  }

 private:
  template <class... Parts>
  void hold(bool holds, fmt::format_string<const Parts&...> law, const Parts&... parts) const {
    require(holds,
            [&] { return fmt::format("{}: {}: {}", path_, words_, fmt::format(law, parts...)); });
  }

  void check_version(const isoline_component& given) const {
    hold(given.version == ISOLINE_VERSION, "a component must have version {} of isoline.h, got {}",
         int{ISOLINE_VERSION}, given.version);
    hold(given.bytes == sizeof given, "`bytes` must be sizeof(isoline_component), {}, got {}",
         sizeof given, given.bytes);
  }

  std::string name_of(const char* given, const char* what) const {
    hold(given != nullptr, "`{}` is null", what);
    const std::string name(given, strnlen(given, kMostName + 1));
    const auto is_allowed = [](char letter) {
      return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-';
    };
    const bool is_name = !name.empty() && name.size() <= kMostName && name[0] >= 'a' &&
                         name[0] <= 'z' && std::ranges::all_of(name, is_allowed);
    hold(is_name,
         "`{}` must be lower-case letters, digits and hyphens, {} at most and the first a letter, "
         "got '{}'",
         what, kMostName, valid_utf8(name));
    return name;
  }

  std::string checked_text(const char* what, const char* given) const {
    hold(given != nullptr && given[0] != '\0', "`{}` is {}", what,
         given == nullptr ? "null" : "empty");
    return valid_utf8(std::string(given, strnlen(given, kMostText)));
  }

  // That the mask promises a function is to have it.
  template <class Function>
  void require_function(bool is_promised, const char* name, Function function) const {
    hold(!is_promised || function != nullptr, "its capabilities include {}(), which is null", name);
  }

  void check_problem(const isoline_component& given) const {
    const std::uint64_t can = given.capabilities;
    hold((can & ~kOfProblems) == 0, "capabilities {:#x} are not valid for a problem",
         can & ~kOfProblems);
    hold(has(can, ISOLINE_FORWARD),
         "a problem must have ISOLINE_FORWARD, an optimizer "
         "ISOLINE_STEP or ISOLINE_SOLVE");
    require_function(true, "dimension", given.dimension);
    require_function(true, "instance", given.instance);
    require_function(true, "forward", given.forward);
    require_function(has(can, ISOLINE_PUSHFORWARD), "pushforward", given.pushforward);
    require_function(has(can, ISOLINE_PULLBACK), "pullback", given.pullback);
    require_function(has(can, ISOLINE_JACOBIAN), "jacobian", given.jacobian);
    require_function(has(can, ISOLINE_INVERSE), "inverse", given.inverse);
  }

  void check_optimizer(const isoline_component& given) const {
    const std::uint64_t can = given.capabilities;
    hold((can & ~kOfOptimizers) == 0, "capabilities {:#x} are not valid for an optimizer",
         can & ~kOfOptimizers);
    hold(!has(can, ISOLINE_STEP | ISOLINE_SOLVE),
         "an optimizer must have either ISOLINE_STEP or ISOLINE_SOLVE, got both");
    require_function(true, "step", given.step);
  }

  void read_options(const isoline_component& given, PluginComponent& made) const {
    hold(given.option_count <= kMostOptions, "it may have {} options, got {}", kMostOptions,
         given.option_count);
    hold(given.option_count == 0 || given.options != nullptr, "`options` is null");
    for (std::uint64_t i = 0; i < given.option_count; ++i) {
      const isoline_option& option = given.options[i];
      OptionField field = field_of(option);
      const bool is_new =
          std::ranges::find(made.options, field.name, &OptionField::name) == made.options.end();
      hold(is_new, "option '{}' occurs twice", field.name);
      hold(option.is_tuned == 0 || made.tuned.empty(), "at most one option may be tuned");
      if (option.is_tuned != 0) made.tuned = field.name;
      made.options.push_back(std::move(field));
    }
  }

  OptionField field_of(const isoline_option& option) const {
    const std::string name = name_of(option.name, "name of an option");
    const Range range = between(option.low, option.high);
    hold(contains(range, option.standard), "the default of option '{}' must be in {}, got {}", name,
         range_text(range), option.standard);
    return {name, option.standard, range, {}, checked_text("about of an option", option.about)};
  }

  std::string path_, digest_, words_;
};

// Never closed: its functions may be called until the end.
void* opened(const std::string& path) {
  const std::string whole =
      std::filesystem::absolute(path).string();  // otherwise the loader would search for it
  const KeptFloatingPoint kept;
  void* library = dlopen(whole.c_str(), RTLD_NOW | RTLD_LOCAL);
  require(library != nullptr, [&] {
    const char* reason = dlerror();
    return fmt::format("{} cannot be loaded as a library: {}", path,
                       valid_utf8(reason == nullptr ? "" : reason));
  });
  return library;
}

}  // namespace

bool PluginComponent::can(std::uint64_t capability) const {
  return has(table->capabilities, capability);
}

std::string PluginComponent::words() const { return foreign.command + ": " + name; }

std::vector<PluginComponent> load_plugin(const std::string& path) {
  const std::string contents = digest(read_text(path));  // a regular file, or it says what it is
  void* entry = dlsym(opened(path), "isoline_plugin");
  require(entry != nullptr, [&] {
    return fmt::format("{} does not export isoline_plugin(), which isoline.h declares", path);
  });
  const auto plugin = reinterpret_cast<decltype(&isoline_plugin)>(entry);
  std::vector<PluginComponent> all;
  for (std::uint64_t which = 0; const isoline_component* given = plugin(which); ++which) {
    require(which < kMostComponents, [&] {
      return fmt::format("{}: isoline_plugin() must return null after the last component, got {}",
                         path, kMostComponents);
    });
    all.push_back(Reader(path, contents, which).read(*given));
  }
  require(!all.empty(), [&] { return path + ": isoline_plugin() has no component"; });
  return all;
}

PluginInstance::PluginInstance(PluginComponent of, const OptionValues& options, std::uint64_t seed)
    : of_(std::move(of)) {
  if (table().open == nullptr) return;
  std::vector<double> values;
  for (const OptionField& field : of_.options)
    values.push_back(options.number(field.name, std::nan("")));
  const KeptFloatingPoint kept;
  self_ = table().open(values.data(), seed);
  if (self_ == nullptr) throw std::runtime_error(of_.words() + ": open() returned null");
}

PluginInstance::~PluginInstance() {
  if (table().close != nullptr && self_ != nullptr) table().close(self_);
}

}  // namespace isoline
