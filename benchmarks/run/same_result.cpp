// Two records held to each other: by their curves, then value by value as they stand in JSON.
#include "benchmarks/run/same_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"

namespace isoline::benchmarks {
namespace {

// Equal as they are written: nan is nan, and 0 is not −0.
bool is_same(Real a, Real b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}
bool is_same(std::int64_t a, std::int64_t b) { return a == b; }

// The columns of two curves, entry by entry up to `points`; the first difference of the earliest
// entry is kept.
class Curves {
 public:
  Curves(const Curve& a, const Curve& b, std::size_t points) : a_(a), b_(b), points_(points) {}

  template <class Value>
  void column(const std::string& name, const std::vector<Value>& a, const std::vector<Value>& b) {
    const std::size_t end = std::min(first_, points_);
    for (std::size_t i = 0; i < end; ++i) {
      if (i < a.size() && i < b.size() && is_same(a[i], b[i])) continue;
      if (i >= a.size() && i >= b.size()) continue;
      first_ = i;
      difference_ = fmt::format("{} at iteration {}: {} against {}", name, a_.iteration.at(i),
                                text_at(a, i), text_at(b, i));
      return;
    }
  }
  template <class Key, class Value>
  void columns(const char* what, const std::map<Key, std::vector<Value>>& a,
               const std::map<Key, std::vector<Value>>& b) {
    static const std::vector<Value> none;
    for (const auto& [key, values] : a)
      column(fmt::format("{} {}", what, key), values, b.contains(key) ? b.at(key) : none);
    for (const auto& [key, values] : b)
      if (!a.contains(key)) column(fmt::format("{} {}", what, key), none, values);
  }
  std::string first_difference() {
    column("iteration", a_.iteration, b_.iteration);
    column("loss", a_.loss, b_.loss);
    column("error in x", a_.x_error, b_.x_error);
    column("gradient norm", a_.gradient_norm, b_.gradient_norm);
    column("step norm", a_.step_norm, b_.step_norm);
    column("work", a_.work, b_.work);
    columns("count of", a_.counts, b_.counts);
    columns("mean batch loss over", a_.batch_loss, b_.batch_loss);
    columns("mean batch error in x over", a_.batch_x_error, b_.batch_x_error);
    return difference_;
  }

 private:
  template <class Value>
  static std::string text_at(const std::vector<Value>& column, std::size_t i) {
    return i < column.size() ? fmt::format("{}", column[i]) : "nothing";
  }

  const Curve& a_;
  const Curve& b_;
  std::size_t points_;
  std::size_t first_ = std::numeric_limits<std::size_t>::max();
  std::string difference_;
};

// How many points of two curves stand at iterations that both must have: the last point of a run
// that was ended is where it was ended.
std::size_t common_points(const Curve& a, const Curve& b) {
  if (a.iteration.empty() || b.iteration.empty()) return 0;
  const std::int64_t end = std::min(a.iteration.back(), b.iteration.back());
  const auto before = [end](const Curve& curve) {
    return std::ranges::count_if(curve.iteration, [end](std::int64_t each) { return each < end; });
  };
  return static_cast<std::size_t>(std::min(before(a), before(b)));
}

std::string short_text(const Json& value) {
  constexpr std::size_t kMost = 60;
  std::string text = json_text(value);
  return text.size() <= kMost ? text : text.substr(0, kMost) + "…";
}

// The first member, by its path, in which two values differ.
std::string difference_in(const Json& a, const Json& b, const std::string& path) {
  if (a == b) return "";
  if (a.is_object() && b.is_object()) {
    for (const auto& [key, value] : a.items()) {
      const std::string inner = path.empty() ? key : path + "." + key;
      if (!b.contains(key)) return fmt::format("{}: {} against nothing", inner, short_text(value));
      if (std::string found = difference_in(value, b[key], inner); !found.empty()) return found;
    }
    for (const auto& [key, value] : b.items())
      if (!a.contains(key)) {
        const std::string inner = path.empty() ? key : path + "." + key;
        return fmt::format("{}: nothing against {}", inner, short_text(value));
      }
  }
  if (a.is_array() && b.is_array() && a.size() == b.size())
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::string found = difference_in(a[i], b[i], fmt::format("{}[{}]", path, i));
          !found.empty())
        return found;
  return fmt::format("{}: {} against {}", path, short_text(a), short_text(b));
}

// Without what is compared by columns, and what another build names otherwise.
Json rest_of(const Record& record) {
  Json rest = result_of(to_json(record));
  for (const char* name : {"curve", "build", "build_parts"}) rest.erase(name);
  return rest;
}

// At an iteration where both keep theirs.
std::string difference_in_spectra(const Spectrum& a, const Spectrum& b) {
  for (std::size_t i = 0; i < a.iterations.size(); ++i) {
    const auto there = std::ranges::find(b.iterations, a.iterations[i]);
    if (there == b.iterations.end()) continue;
    if (a.sigma[i] != b.sigma[static_cast<std::size_t>(there - b.iterations.begin())])
      return fmt::format("singular values at iteration {}", a.iterations[i]);
  }
  return "";
}

// Of the spectra that both keep, then the earliest of the fields.
std::string difference_in_what_is_kept(const Record& a, const Record& b) {
  if (a.spectrum && b.spectrum)
    if (std::string found = difference_in_spectra(*a.spectrum, *b.spectrum); !found.empty())
      return found;
  if (!a.fields || !b.fields || *a.fields == *b.fields) return "";
  if (a.fields->iterations != b.fields->iterations) return "iterations of the fields";
  return fmt::format("fields: {} against {}", a.fields->digest, b.fields->digest);
}

}  // namespace

bool same_result(const Record& a, const Record& b) {
  Json left = without_timings(to_json(a)), right = without_timings(to_json(b));
  left.erase("provenance");
  right.erase("provenance");
  return left == right && difference_in_what_is_kept(a, b).empty();
}

Comparison compare_results(const Record& a, const Record& b) {
  Comparison found;
  found.is_up_to_there = a.is_nondeterministic || b.is_nondeterministic;
  const std::size_t all = std::max(a.curve.iteration.size(), b.curve.iteration.size());
  const std::size_t points = found.is_up_to_there ? common_points(a.curve, b.curve) : all;
  const bool has_all = points <= a.curve.iteration.size() && points <= b.curve.iteration.size();
  const std::size_t common =
      has_all ? points : std::min(a.curve.iteration.size(), b.curve.iteration.size());
  if (common > 0) found.iterations = a.curve.iteration[common - 1];
  found.difference = Curves(a.curve, b.curve, common).first_difference();
  if (!found.difference.empty() || found.is_up_to_there) return found;
  if (!has_all)
    found.difference =
        fmt::format("last iteration: {} against {}", a.summary.iterations, b.summary.iterations);
  else
    found.difference = difference_in(rest_of(a), rest_of(b), "");
  if (found.difference.empty()) found.difference = difference_in_what_is_kept(a, b);
  return found;
}

}  // namespace isoline::benchmarks
