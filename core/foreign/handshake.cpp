// Starts commands, and validates and caches what they declare in the handshake.
#include "core/foreign/handshake.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/errors.h"
#include "core/foreign/foreign.h"
#include "core/json.h"
#include "core/shell.h"

namespace isoline {

ChildProgram::Start door_to(const std::string& command) {
  require(!command.empty(),
          "process requires a command, such as process[command=\"python3 mine.py\"]");
  const char* const theirs = std::getenv("PYTHONPATH");
  const std::string ours = client_folder("python").string();
  return {.command = command,
          .environment = {{"PYTHONPATH", theirs == nullptr ? ours : ours + ":" + theirs},
                          // our folder may be read-only, and an installed one must not be modified
                          {"PYTHONDONTWRITEBYTECODE", "1"}}};
}

Foreign foreign_of_command(const std::string& command) {
  return {.door = "process", .command = command, .digest = digest_of_files(shell_words(command))};
}

OptionValues declared_values(OptionValues complete) {
  for (const OptionField& field : option_table<SimulatorOptions>()) complete.erase(field.name);
  for (const char* of_harness : {kStartOption, kTargetOption}) complete.erase(of_harness);
  return complete;
}

std::string options_text(const OptionValues& declared) {
  return declared.empty() ? "" : json_text(to_json(declared));
}

void require_unedited(const std::optional<Foreign>& planned) {
  if (!planned || planned->door != "process") return;
  std::string now;  // empty while an editor replaces the file
  try {
    now = foreign_of_command(planned->command).digest;
  } catch (const UsageError&) {
  }
  if (now != planned->digest)
    throw KilledProgram(
        fmt::format("the files of `{}` were edited during the run", planned->command));
}

// Handshakes, read member by member. A member that is missing, of another type or out of range is
// refused with its value.

namespace {

constexpr std::int64_t kMostSize = std::int64_t{1} << 27;  // of x or y: a GiB of doubles
constexpr std::int64_t kMostPrice = std::int64_t{1} << 31;
constexpr std::array<std::string_view, 4> kInverses = {"exact", "damped", "estimate",
                                                       "approximate"};
constexpr std::size_t kMostQuoted = 80;  // bytes
constexpr std::size_t kMostName = 64, kMostWords = 4096,
                      kMostPackages = 100;  // bytes, as of plugins
constexpr const char* kOutside = "It has no value outside its bounds on x.";

// The members of one answer.
class Said {
 public:
  Said(const std::string& text, std::string sender)
      : json_(parse_json(text, sender + "'s handshake")), sender_(std::move(sender)) {
    if (!json_.is_object()) fail("answers with", json_, "an object");
    const std::int64_t protocol = whole("protocol", 0, 1'000'000, {});
    require(protocol == kWireProtocol, [&] {
      return fmt::format("{} uses protocol {}, but Isoline uses protocol {}", sender_, protocol,
                         kWireProtocol);
    });
  }

  void expect_role(std::string_view role) const {
    const std::string said = text("role");
    require(said == role, [&] {
      return fmt::format("{} is {} {}, but the command uses it as {} {}", sender_, article(said),
                         quoted(said), article(role), role);
    });
  }
  bool has(const char* name) const { return json_.contains(name) && !json_[name].is_null(); }

  std::string text(const char* name, std::size_t most = kMostWords) const {
    const std::string law = fmt::format("a string of at most {} bytes", most);
    const std::string said = value<std::string>(name, &Json::is_string, law.c_str()).value_or("");
    if (said.size() > most) refuse(name, law);
    return said;
  }
  bool flag(const char* name) const {
    return value<bool>(name, &Json::is_boolean, "true or false").value_or(false);
  }
  std::optional<Real> number(const char* name) const {
    return value<Real>(name, &Json::is_number, "a number");
  }
  // `standard`: where it is not said; nothing where it must be.
  std::int64_t whole(const char* name, std::int64_t least, std::int64_t most,
                     std::optional<std::int64_t> standard) const {
    const std::string law = fmt::format("a whole number in [{}, {}]", least, most);
    if (!has(name) && standard) return *standard;
    if (!has(name)) refuse(name, law);
    const Json& value = json_[name];
    const bool fits =
        value.is_number_integer() &&
        (value.is_number_unsigned() ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(most)
                                    : value.get<std::int64_t>() <= most);
    if (!fits || value.get<std::int64_t>() < least) refuse(name, law);
    return value.get<std::int64_t>();
  }
  std::vector<Real> numbers(const char* name, std::int64_t count, bool is_required) const {
    const std::string law = fmt::format("a list of {} numbers", count);
    if (!has(name) && !is_required) return {};
    if (!has(name)) refuse(name, law);
    return reals(json_[name], count, name, law);
  }
  template <class Names>
  std::string choice(const char* name, const Names& names) const {
    const std::string said = text(name);
    if (said.empty() || std::ranges::find(names, said) != names.end()) return said;
    std::string law = "one of";
    for (const auto& each : names) law += fmt::format(" {}", each);
    refuse(name, law);
  }
  OracleSet oracles(const char* name, std::initializer_list<Oracle> known) const {
    OracleSet set{Oracle::forward};
    std::string law = "a list of";
    for (const Oracle oracle : known) law += fmt::format(" {}", name_of(oracle));
    if (!has(name) || !json_[name].is_array()) refuse(name, law);
    for (const Json& each : json_[name]) {
      const auto* const found = std::ranges::find_if(known, [&](Oracle oracle) {
        return each.is_string() && each.get_ref<const std::string&>() == name_of(oracle);
      });
      if (found == known.end()) refuse(name, law);
      set.add(*found);
    }
    return set;
  }
  OptionValues values(const char* name) const {
    const auto is_value = [](const Json& each) { return each.is_string() || each.is_number(); };
    if (!has(name)) return {};
    if (!json_[name].is_object() || !std::ranges::all_of(json_[name], is_value))
      refuse(name, "an object of strings and numbers");
    return option_values_from(json_[name]);
  }
  std::map<std::string, std::string> texts(const char* name) const {
    std::map<std::string, std::string> all;
    if (!has(name)) return all;
    const std::string law =
        fmt::format("an object of at most {} strings of at most 64 bytes each", kMostPackages);
    const Json& given = json_[name];
    if (!given.is_object() || given.size() > kMostPackages) refuse(name, law);
    for (const auto& [key, value] : given.items()) {
      if (key.size() > kMostName || !value.is_string()) refuse(name, law);
      all[key] = value.get<std::string>();
      if (all[key].size() > kMostName) refuse(name, law);
    }
    return all;
  }
  OptionTable options(const char* name) const {
    if (!has(name)) return {};
    const std::string law = fmt::format(
        "a list of at most {} objects, each with a new name of letters, digits and hyphens, and "
        "with a default",
        kMostPackages);
    const Json& list = json_[name];
    if (!list.is_array() || list.size() > kMostPackages) refuse(name, law);
    OptionTable table = option_table<SimulatorOptions>();
    const std::size_t ours = table.size();
    for (const Json& each : list) {
      const bool is_whole = each.is_object() && each.contains("name") && each.contains("default") &&
                            each["name"].is_string() && !each["default"].is_structured() &&
                            !each["default"].is_null();
      if (!is_whole) refuse(name, law);
      const std::string option = each["name"];
      const bool is_new = std::ranges::find(table, option, &OptionField::name) == table.end();
      if (!is_new || option.empty() || option.size() > kMostName || option != option_name(option) ||
          option.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                   "-_") != option.npos)
        refuse(name, law);
      const std::string doc =
          each.contains("doc") && each["doc"].is_string() ? each["doc"] : Json("");
      Json standard;
      standard[option] = each["default"];
      table.push_back(
          {option, option_values_from(standard).at(option), {}, {}, doc.substr(0, kMostWords)});
    }
    table.erase(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(ours));
    return table;
  }
  // One text for each unknown; none where the member is absent.
  std::vector<std::string> labels(const char* name, std::int64_t count) const {
    if (!has(name)) return {};
    const std::string law =
        fmt::format("a list of {} strings of at most {} bytes each, without tabs and line ends",
                    count, kMostName);
    const Json& list = json_[name];
    if (!list.is_array() || std::ssize(list) != count) refuse(name, law);
    std::vector<std::string> all;
    for (const Json& each : list) {
      if (!each.is_string()) refuse(name, law);
      all.push_back(each.get<std::string>());
      if (all.back().size() > kMostName || all.back().find_first_of("\t\n\r") != std::string::npos)
        refuse(name, law);
    }
    return all;
  }
  // The lower ones, and the upper ones; both empty where there are none.
  std::pair<std::vector<Real>, std::vector<Real>> bounds(std::int64_t count) const {
    const char* name = "bounds";
    if (!has(name)) return {};
    const std::string law = fmt::format(
        "two lists of {} numbers, no lower bound above its upper one (equal ones fix an unknown)",
        count);
    const Json& both = json_[name];
    if (!both.is_array() || both.size() != 2) refuse(name, law);
    std::pair found(reals(both[0], count, name, law), reals(both[1], count, name, law));
    const auto [low, high] = std::ranges::mismatch(found.first, found.second, std::less_equal());
    if (low != found.first.end())
      refuse(name, fmt::format("{}; those of unknown {} are {} and {}", law,
                               low - found.first.begin() + 1, *low, *high));
    return found;
  }

 private:
  template <class Value>
  std::optional<Value> value(const char* name, bool (Json::*is_one)() const noexcept,
                             const char* law) const {
    if (!has(name)) return std::nullopt;
    if (!(json_[name].*is_one)()) refuse(name, law);
    return json_[name].get<Value>();
  }
  std::vector<Real> reals(const Json& list, std::int64_t count, const char* name,
                          const std::string& law) const {
    if (!list.is_array() || list.size() != static_cast<std::size_t>(count)) refuse(name, law);
    try {
      return reals_of(list);
    } catch (const UsageError&) {
      refuse(name, law);
    }
  }
  static std::string_view article(std::string_view noun) {
    return noun.starts_with('o') ? "an" : "a";
  }
  static std::string quoted(std::string text) {
    if (text.size() > kMostQuoted) text = text.substr(0, kMostQuoted) + "…";
    return text;
  }
  [[noreturn]] void fail(std::string_view what, const Json& value, std::string_view law) const {
    throw UsageError(
        fmt::format("{} {} {}, which must be {}", sender_, what, quoted(json_text(value)), law));
  }
  [[noreturn]] void refuse(const char* name, const std::string& law) const {
    if (!has(name))
      throw UsageError(fmt::format("{} does not declare {}, which must be {}", sender_, name, law));
    fail(fmt::format("declares {} =", name), json_[name], law);
  }

  const Json json_;
  const std::string sender_;
};

Foreign foreign_of(const Said& said) {
  Foreign foreign;
  foreign.label = said.text("name", kMostName);
  foreign.interpreter = said.text("interpreter");
  foreign.packages = said.texts("packages");
  foreign.note = said.text("note");
  foreign.source = said.text("source");
  foreign.options = said.options("options");
  foreign.tunable = said.text("tunable", kMostName);
  const auto tunable = std::ranges::find(foreign.options, foreign.tunable, &OptionField::name);
  require(foreign.tunable.empty() || tunable != foreign.options.end(),
          [&] { return "tunable must be the name of a declared option, got " + foreign.tunable; });
  for (const auto& [word, value] : said.values("words"))
    foreign.options.push_back({word, value, {}, {}, kWordOfScript});
  return foreign;
}

// A part of a greeting. The caller handles a broken connection, as it handles a wrong argument; but
// it can ask a program again that was killed.
auto greeted(auto exchange) {
  try {
    return exchange();
  } catch (const KilledProgram&) {
    throw;
  } catch (const LineError& error) {
    throw UsageError(error.what());
  }
}

void send_greeting(Line& line, Json greeting, const OptionValues& declared) {
  if (!declared.empty()) greeting["options"] = to_json(declared);
  greeted([&] { line.send_text(Verb::hello, 0, json_text(greeting)); });
}

std::string answer_of(Line& line, double seconds) {
  return greeted([&] { return line.receive_text(Verb::hello, kMostHandshake, seconds); });
}

}  // namespace

ProblemHandshake problem_handshake(const std::string& text, const std::string& sender) {
  const Said said(text, sender);
  said.expect_role("problem");
  ProblemHandshake problem{.foreign = foreign_of(said)};
  problem.inputs = said.whole("inputs", 1, kMostSize, {});
  problem.outputs = said.whole("outputs", 1, kMostSize, {});
  problem.oracles = said.oracles("oracles", {Oracle::forward, Oracle::pushforward, Oracle::pullback,
                                             Oracle::jacobian, Oracle::inverse});
  problem.pushforward_price = said.whole("pushforward_price", 1, kMostPrice, 1);
  problem.pullback_price = said.whole("pullback_price", 1, kMostPrice, 1);
  problem.inverse_price = said.whole("inverse_price", 1, kMostPrice, 1);
  problem.are_differences = said.flag("differences");
  problem.inverse = said.choice("inverse", kInverses);
  require(problem.oracles.contains(Oracle::inverse) == !problem.inverse.empty(), [&] {
    return sender + " must declare either both the oracle inverse and its kind, or neither";
  });
  problem.start = said.numbers("start", problem.inputs, true);
  problem.drawn = said.numbers("drawn", problem.inputs, false);
  problem.target = said.numbers("target", problem.outputs, true);
  problem.truth = said.numbers("truth", problem.inputs, false);
  std::tie(problem.lower, problem.upper) = said.bounds(problem.inputs);
  problem.has_active_bounds = said.flag("active_bounds");
  problem.names = said.labels("names", problem.inputs);
  problem.units = said.labels("units", problem.inputs);
  const auto require_within = [&](const char* name, const std::vector<Real>& x) {
    for (std::size_t i = 0; i < x.size() && !problem.lower.empty(); ++i) {
      const bool is_below = x[i] < problem.lower[i];
      require(!is_below && !(x[i] > problem.upper[i]), [&] {
        const std::string label = i < problem.names.size() && !problem.names[i].empty()
                                      ? " ('" + problem.names[i] + "')"
                                      : "";
        return fmt::format("{} declares a {} outside its bounds: x{}{} is {}, {} its {} bound {}",
                           sender, name, i + 1, label, x[i], is_below ? "below" : "above",
                           is_below ? "lower" : "upper",
                           is_below ? problem.lower[i] : problem.upper[i]);
      });
    }
  };
  require_within("start", problem.start);
  require_within("drawn", problem.drawn);
  require_within("truth", problem.truth);
  std::string& note = problem.foreign.note;
  if (!problem.lower.empty()) note += fmt::format("{}{}", note.empty() ? "" : " ", kOutside);
  problem.minimum = said.number("minimum");
  problem.aim = said.choice("aim", kAimNames) == name_of(Aim::x) ? Aim::x : Aim::loss;
  problem.has_x_error = said.flag("has_x_error");
  require(problem.aim == Aim::loss || !problem.truth.empty() || problem.has_x_error,
          [&] { return sender + " declares aim = x, which requires truth or x_error"; });
  constexpr std::array<std::string_view, 1> kScales = {"own"};
  problem.has_own_scale = !said.choice("start_scale", kScales).empty();
  problem.x_floor = said.number("x_floor").value_or(0);
  require(problem.x_floor >= 0, [&] {
    return fmt::format("{} declares x_floor = {}, which must not be negative", sender,
                       problem.x_floor);
  });
  return problem;
}

MethodHandshake method_handshake(const std::string& text, const std::string& sender) {
  const Said said(text, sender);
  said.expect_role("optimizer");
  return {.foreign = foreign_of(said),
          .needs = said.oracles("needs", {Oracle::forward, Oracle::pullback, Oracle::pushforward,
                                          Oracle::jacobian, Oracle::hessian_product}),
          .is_least_squares = said.flag("least_squares"),
          .reports = said.flag("reports"),
          .keeps_bounds = said.flag("keeps_bounds")};
}

void send_greeting(Line& line, std::uint64_t seed, const OptionValues& declared) {
  send_greeting(line, Json{{"protocol", kWireProtocol}, {"role", "problem"}, {"seed", seed}},
                declared);
}

ProblemHandshake receive_greeting(Line& line, double seconds) {
  return problem_handshake(answer_of(line, seconds), line.sender());
}

ProblemHandshake greet_problem(Line& line, std::uint64_t seed, double seconds,
                               const OptionValues& declared) {
  send_greeting(line, seed, declared);
  return receive_greeting(line, seconds);
}

MethodHandshake greet_method(Line& line, double seconds, const OptionValues& declared) {
  const Json greeting{{"protocol", kWireProtocol}, {"role", "optimizer"}};
  send_greeting(line, greeting, declared);
  return method_handshake(answer_of(line, seconds), line.sender());
}

}  // namespace isoline
