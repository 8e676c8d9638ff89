// Two records held to each other as they stand in JSON: their curves by iteration, then the rest.
#include "benchmarks/run/same_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = json_text(value);
  return text.size() <= kMost ? text : std::string(cut(text, kMost)) + "…";
}

std::string against(const std::string& place, const Json& a, const Json& b) {
  return fmt::format("{}: {} against {}", place, shown(a), shown(b));
}

// The value at a place of either record, or a note that it is missing.
Json value_at(const Json& json, const Json::json_pointer& place) {
  return json.contains(place) ? json.at(place) : Json("nothing");
}

// The earliest of the first `points` entries of all columns of two curves in which they differ.
std::string difference_in_curves(const Json& a, const Json& b, std::size_t points) {
  const Json columns[] = {a.flatten(), b.flatten()};  // by "/counts/forward/17"
  std::string difference;
  std::size_t first = points;
  for (const Json& some : columns)
    for (const auto& [path, value] : some.items()) {
      if (value.is_null()) continue;  // a column without entries
      const Json::json_pointer place(path);
      const std::size_t i = std::stoul(place.back());
      if (i >= first || (json_text(value_at(a, place)) == json_text(value_at(b, place)))) continue;
      first = i;
      std::string column = place.parent_pointer().to_string().substr(1);
      std::ranges::replace(column, '/', ' ');
      std::ranges::replace(column, '_', ' ');
      difference =
          against(fmt::format("{} at iteration {}", column, shown(a.at("iteration").at(i))),
                  value_at(a, place), value_at(b, place));
    }
  return difference;
}

// The first member, by its path, in which two values differ.
std::string difference_in(const Json& a, const Json& b) {
  const Json patch = Json::diff(a, b);
  if (patch.empty()) return "";
  const Json::json_pointer place(patch[0].at("path").get<std::string>());
  return against(place.to_string().substr(1), value_at(a, place), value_at(b, place));
}

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

// For spectra, at an iteration where both records have one; then for fields.
std::string difference_in_what_is_kept(const Record& a, const Record& b) {
  if (a.spectrum && b.spectrum)
    for (std::size_t i = 0; i < a.spectrum->iterations.size(); ++i) {
      const auto& others = b.spectrum->iterations;
      const auto there = std::ranges::find(others, a.spectrum->iterations[i]);
      if (there != others.end() &&
          a.spectrum->sigma[i] !=
              b.spectrum->sigma[static_cast<std::size_t>(there - others.begin())])
        return fmt::format("singular values at iteration {}", *there);
    }
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
  Comparison found{.is_up_to_there = a.is_nondeterministic || b.is_nondeterministic};
  const std::size_t least = std::min(a.curve.iteration.size(), b.curve.iteration.size());
  const std::size_t points =
      found.is_up_to_there ? std::min(least, common_points(a.curve, b.curve)) : least;
  if (points > 0) found.iterations = a.curve.iteration[points - 1];
  Json left = result_of(to_json(a)), right = result_of(to_json(b));
  found.difference = difference_in_curves(left.at("curve"), right.at("curve"), points);
  if (!found.difference.empty() || found.is_up_to_there) return found;
  if (a.curve.iteration.size() != b.curve.iteration.size()) {
    found.difference =
        fmt::format("last iteration: {} against {}", a.summary.iterations, b.summary.iterations);
    return found;
  }
  for (Json* rest : {&left, &right})  // what another build names otherwise
    for (const char* name : {"curve", "build", "build_parts"}) rest->erase(name);
  found.difference = difference_in(left, right);
  if (found.difference.empty()) found.difference = difference_in_what_is_kept(a, b);
  return found;
}

}  // namespace isoline::benchmarks
