// Selects the iterations that a trace stores, and checks the texts and numbers of a trace.
#include "core/trace.h"

#include <cmath>
#include <vector>

#include "core/text.h"

namespace isoline {
namespace {

bool is_amount(std::int64_t count) { return count >= 0; }
bool is_amount(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

bool are_amounts(const auto& counts) {
  return std::ranges::all_of(counts, [](std::int64_t count) { return is_amount(count); });
}

template <std::size_t size>
bool ends(const char (&text)[size]) {
  return std::memchr(text, '\0', sizeof text) != nullptr;
}

bool is_sound(const TracePoint& point) {
  return is_amount(point.iteration) && are_amounts(point.counts) && is_amount(point.work) &&
         are_amounts(point.rounds) && is_amount(point.wall_seconds) &&
         is_amount(point.processor_seconds);
}

bool are_points_sound(const Trace& trace) {
  const int points = trace.points;
  if (!is_within(points, Trace::kPoints)) return false;
  for (int i = 0; i < points; ++i) {
    if (!is_sound(trace.point[i])) return false;
    if (i > 0 && trace.point[i].iteration <= trace.point[i - 1].iteration) return false;
    if (i > 0 && trace.point[i].work < trace.point[i - 1].work) return false;
  }
  return is_sound(trace.last);
}

// Targets are met from the first on, one after the other.
bool are_hits_sound(const TraceHit (&hits)[kRungs]) {
  std::int64_t last = 0;
  for (const TraceHit& hit : hits) {
    if (hit.iteration == -1) {
      last = std::numeric_limits<std::int64_t>::max();
      continue;
    }
    const bool is_next = hit.iteration >= last;
    if (!is_next || !is_amount(hit.work) || !are_amounts(hit.counts) || !are_amounts(hit.rounds) ||
        !is_amount(hit.wall_seconds))
      return false;
    last = hit.iteration;
  }
  return true;
}

bool are_sound(const FailedEvaluations& failures) {
  return is_amount(failures.total) && is_within(failures.kept, FailedEvaluations::kMost) &&
         failures.kept <= failures.total &&
         is_within(failures.unknowns, FailedEvaluations::kNumbers) &&
         failures.kept * failures.unknowns <= FailedEvaluations::kNumbers &&
         std::all_of(failures.reason, failures.reason + failures.kept,
                     [](const auto& reason) { return ends(reason); });
}

bool are_texts_sound(const Trace& trace) {
  return ends(trace.series_names) && ends(trace.message) && ends(trace.privileges) &&
         ends(trace.claimed);
}

// As many as there are numbers of a point, and no two alike.
bool are_series_sound(const Trace& trace) {
  std::vector<std::string_view> names;
  std::string_view left = trace.series_names;
  while (!left.empty()) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    names.push_back(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  std::ranges::sort(names);
  return names.size() <= Trace::kSeries && std::ranges::adjacent_find(names) == names.end();
}

bool are_choices_sound(const Trace& trace) {
  return is_flag(trace.is_finished) && is_flag(trace.is_learned) &&
         is_flag(trace.stopped_by_clock) && is_flag(trace.is_bounded) &&
         is_flag(trace.counts_rounds) && is_flag(trace.has_best) && is_flag(trace.has_kept) &&
         is_flag(trace.wants_spectra) &&
         is_within(static_cast<int>(trace.status), static_cast<int>(kStatusNames.size()) - 1) &&
         is_within(static_cast<int>(trace.aim), static_cast<int>(kAimNames.size()) - 1);
}

}  // namespace

std::int64_t next_kept_after(std::int64_t iteration) {
  constexpr std::int64_t kEvery = 100;
  constexpr Real kPerDecade = 32;
  if (iteration < kEvery) return iteration + 1;
  const Real passed = std::floor(kPerDecade * std::log10(static_cast<Real>(iteration)) + 1e-9);
  std::int64_t next = iteration;
  for (Real step = passed; next <= iteration; ++step)
    next = std::llround(std::pow(10.0, step / kPerDecade));
  return next;
}

void set_text(char (&out)[Trace::kText], std::string_view text) {
  const std::string_view kept = cut(text, Trace::kText - 1);
  out[kept.copy(out, Trace::kText - 1)] = '\0';
}

std::string defect_of(const Trace& trace) {
  if (!are_choices_sound(trace)) return "an invalid choice";
  if (!are_points_sound(trace)) return "invalid iterations, counts or times";
  if (!are_hits_sound(trace.hit) || !are_hits_sound(trace.x_hit))
    return "targets reached in an invalid order";
  if (!is_within(trace.unknowns, Trace::kUnknowns)) return "a point of an invalid size";
  if (!are_sound(trace.failures)) return "failed evaluations of an invalid number";
  if (!are_texts_sound(trace)) return "an unterminated text";
  if (!are_series_sound(trace)) return "more series than the trace has room for";
  if (!are_amounts(trace.prices) || !is_amount(trace.rejected_steps) ||
      !is_amount(trace.calls.made) || !is_amount(trace.calls.answered))
    return "invalid counts";
  return "";
}

}  // namespace isoline
