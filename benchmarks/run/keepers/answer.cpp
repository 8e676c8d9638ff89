// θ = x of a direct problem: as it was returned, and where the loss was least.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "benchmarks/run/keepers/keeper.h"
#include "core/errors.h"
#include "core/files.h"

namespace isoline::benchmarks {
namespace {

// "NAME tab UNIT" of each unknown, a line each; empty where the problem declares neither.
std::string names_text(const problems::Problem& problem) {
  const problems::Model* const model = problem.model();
  const std::vector<std::string>&names = model ? model->names : problem.names(),
        &units = model ? model->units : problem.units();
  const auto n = model ? names.size() : static_cast<std::size_t>(problem.unknowns());
  require((names.empty() || names.size() == n) && (units.empty() || units.size() == n), [&] {
    return fmt::format("the problem has {} unknowns, but declares {} names and {} units", n,
                       names.size(), units.size());
  });
  std::string text;
  for (std::size_t i = 0; i < n && !(names.empty() && units.empty()); ++i)
    text += fmt::format("{}\t{}\n",
                        names.empty() || names[i].empty() ? fmt::format("x{}", i + 1) : names[i],
                        units.empty() ? "" : units[i]);
  return text;
}

struct Answer {
  static constexpr int kUnknowns = Trace::kUnknowns, kOfModel = 256, kNames = 16 * 1024;
  bool has_returned = false, is_bounded = false, is_scaled = false;
  double residual_norm;
  double returned[kUnknowns];                 // θ
  double lower[kUnknowns], upper[kUnknowns];  // of x, infinite where there is no bound
  double scale[kUnknowns];                    // where it is: x = scale · θ, within the bounds
  char names[kNames] = "";                    // NAME, tab, UNIT, a line each; empty: x1, x2, …
  // x at both points of a problem with the words of a model, where it is not θ.
  int of_model = 0;  // 0: there is no model
  double best_of_model[kOfModel], returned_of_model[kOfModel];

  void begin(const Meter& f) {
    if (f.trace().unknowns == 0) return;
    const problems::Problem& problem = f.problem();
    const std::string text = names_text(problem);
    require(text.size() < kNames, [&] {
      return fmt::format("the names and units of the unknowns have {} bytes, but at most {} fit",
                         text.size(), kNames - 1);
    });
    names[text.copy(names, kNames - 1)] = '\0';
    const problems::OwnUnits& own = problem.own_units();
    is_scaled = own.scales.size() > 0;
    std::ranges::copy(own.scales, scale);
    const problems::Model* const model = problem.model();
    if (model != nullptr) {
      require(model->names.size() <= kOfModel, [&] {
        return fmt::format("fixed, tied and log require at most {} unknowns, got {}", int{kOfModel},
                           model->names.size());
      });
      of_model = static_cast<int>(model->names.size());
    }
    const problems::Bounds* const bounds = own.bounds         ? &*own.bounds
                                           : model != nullptr ? nullptr
                                                              : problem.bounds();
    is_bounded = bounds != nullptr;
    if (bounds == nullptr) return;
    std::ranges::copy(bounds->lower, lower);
    std::ranges::copy(bounds->upper, upper);
  }

  void keep(const Meter& f, int) {
    if (of_model == 0 || !f.trace().has_best) return;
    const Eigen::Map<const Vector> theta(f.trace().best, f.trace().unknowns);
    std::ranges::copy(f.problem().in_own_units(theta), best_of_model);
  }

  void end(const Meter& f, Status) {
    if (f.trace().unknowns == 0) return;
    const problems::Problem& problem = f.problem();
    std::copy_n(f.judged().data(), f.trace().unknowns, returned);
    if (of_model > 0) std::ranges::copy(problem.in_own_units(f.judged()), returned_of_model);
    residual_norm = (f.judged_point().y - problem.target()).norm();
    has_returned = true;
  }

  std::string defect() const {
    const bool is_sound = is_flag(has_returned) && is_flag(is_bounded) && is_flag(is_scaled) &&
                          is_within(of_model, kOfModel) && std::memchr(names, '\0', kNames);
    return is_sound ? "" : "an answer of an invalid size";
  }

  // Points that are not finite answer nothing. Where the returned one is not the best, both are
  // kept.
  void write(const Trace& trace, Parts& parts) const {
    const int unknowns = of_model > 0 ? of_model : trace.unknowns;
    const bool has_scales = is_scaled && of_model == 0;
    AnswerPoints answer{.unknowns = unknowns};
    const auto add = [&](const char* name, const double* values) {
      std::vector<Real> x(values, values + unknowns);
      for (std::size_t i = 0; has_scales && i < x.size(); ++i) {
        x[i] *= scale[i];
        if (is_bounded) x[i] = std::max(lower[i], std::min(x[i], upper[i]));
      }
      if (!std::ranges::all_of(x, [](Real value) { return std::isfinite(value); })) return;
      answer.points.emplace_back(name);
      answer.x.push_back(std::move(x));
    };
    if (has_returned) {
      add(kReturned, of_model > 0 ? returned_of_model : returned);
      answer.residual_norm = residual_norm;
    }
    const bool is_returned_best = has_returned && trace.last.loss <= trace.best_loss;
    if (trace.has_best && !is_returned_best) add(kBest, of_model > 0 ? best_of_model : trace.best);
    if (trace.unknowns == 0 || answer.points.empty()) return;
    const std::vector<std::string> lines = lines_of(names);
    for (const std::string& line : lines) {
      if (std::ssize(lines) != unknowns) break;
      const std::size_t tab = std::min(line.find('\t'), line.size());
      answer.names.push_back(line.substr(0, tab));
      answer.units.push_back(line.substr(std::min(tab + 1, line.size())));
    }
    if (std::ranges::all_of(answer.units, &std::string::empty)) answer.units.clear();
    if (has_scales) answer.scales.assign(scale, scale + unknowns);
    const std::vector<Real>& x = answer.x.back();  // of least loss
    for (int i = 0; is_bounded && i < unknowns; ++i) {
      const Real value = x[static_cast<std::size_t>(i)];
      if (value <= lower[i]) answer.at_lower.push_back(i);
      if (value >= upper[i]) answer.at_upper.push_back(i);
    }
    if (answer.x[0].size() > AnswerPoints::kInline) answer.digest = digest(answer_file(answer));
    parts.answer = std::move(answer);
  }
};

}  // namespace

Keeper answer_keeper() { return keeper_of<Answer>(); }

}  // namespace isoline::benchmarks
