// Sheets of problems and optimizers, landscapes included.
#include "benchmarks/run/sheets.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/run/isolate.h"
#include "benchmarks/run/prices.h"
#include "core/decompose.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/option_json.h"

namespace isoline::benchmarks {

using optimizers::privileges_of;
namespace {

constexpr Index kGrid = 81;                // points a side of a landscape
constexpr Index kSmall = 16;               // largest target and truth that a sheet shows
constexpr Index kMostEntries = 256 * 256;  // of a Jacobian that is factorized: 20 ms
constexpr const char* kInverseNames[] = {"none", "exact", "damped", "estimate"};

std::vector<std::string> names_of(OracleSet oracles) {
  std::vector<std::string> names;
  for (std::size_t kind = 0; kind < kOracles; ++kind)
    if (oracles.contains(static_cast<Oracle>(kind))) names.emplace_back(kOracleNames[kind]);
  return names;
}

Real grid_point(Real low, Real high, Index i) {
  return low + (high - low) * static_cast<Real>(i) / static_cast<Real>(kGrid - 1);
}

std::vector<Real> small(const Matrix& values) {
  if (values.size() > kSmall) return {};
  return {values.data(), values.data() + values.size()};
}

// σ_max / σ_min of J; nothing where it is too large, or no number.
std::optional<Real> condition_of(const Problem& problem) {
  const bool is_small = problem.unknowns() * problem.residuals() <= kMostEntries;
  if (problem.is_learned() || !problem.has_identity_network() || !is_small) return std::nullopt;
  const auto& truth = problem.truth();
  const Vector theta = truth ? Vector(truth->reshaped()) : problem.start();
  Point at;
  Matrix J;
  Svd svd;
  problem.forward(theta, at);
  problem.jacobian(J, at);
  if (!J.allFinite() || !thin_svd(J, svd)) return std::nullopt;
  const Real least = J.rows() < J.cols() ? 0 : svd.sigma[svd.sigma.size() - 1];
  return least > 0 ? svd.sigma[0] / least : std::numeric_limits<Real>::infinity();
}

// L over the problem's window in x, and over the box in y that the window maps into.
void draw_landscapes(const Problem& problem, Sheet& sheet) {
  Landscape in_x{*problem.window(), Grid(kGrid, kGrid), problem.contour_spacing()};
  const auto& [x1_low, x1_high, x2_low, x2_high] = in_x.window;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<Real>::infinity());
  Eigen::Vector2d high = -low;
  Point point;
  for (Index j = 0; j < kGrid; ++j)
    for (Index i = 0; i < kGrid; ++i) {
      const Eigen::Vector2d x(grid_point(x1_low, x1_high, i), grid_point(x2_low, x2_high, j));
      problem.forward(x, point);
      in_x.loss(i, j) = point.loss;
      if (problem.outputs() != 2) continue;
      low = low.cwiseMin(point.y.col(0));
      high = high.cwiseMax(point.y.col(0));
    }
  sheet.landscape_x = in_x;
  if (problem.outputs() != 2) return;
  const std::array<Real, 4> image{low[0], high[0], low[1], high[1]};
  Landscape in_y{problem.y_window().value_or(image), Grid(kGrid, kGrid), problem.contour_spacing()};
  const auto& [y1_low, y1_high, y2_low, y2_high] = in_y.window;
  for (Index j = 0; j < kGrid; ++j)
    for (Index i = 0; i < kGrid; ++i)
      in_y.loss(i, j) = problem.loss_of(
          Eigen::Vector2d(grid_point(y1_low, y1_high, i), grid_point(y2_low, y2_high, j)));
  sheet.landscape_y = in_y;
}

// y = x with an inverse of any kind: what a method asks of it shows what it would see.
class Witness final : public problems::Physics {
 public:
  explicit Witness(Inverse kind) : kind_(kind) {}
  Index inputs() const override { return 1; }
  Index outputs() const override { return 1; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override { y = x; }
  void pushforward(BatchRef v, BatchOut Jv, Workspace&) const override { Jv = v; }
  void pullback(BatchRef u, BatchOut JTu, Workspace&) const override { JTu = u; }
  Inverse inverse_kind() const override { return kind_; }

 private:
  Inverse kind_;
};

std::vector<std::string> possible_privileges(const OptimizerEntry& entry,
                                             const Component& component) {
  std::vector<std::string> all;
  for (const Inverse kind : {Inverse::exact, Inverse::damped, Inverse::estimate}) {
    const Problem problem({.physics = std::make_unique<Witness>(kind),
                           .start = Vector::Ones(1),
                           .target = Matrix::Zero(1, 1)});
    for (const std::string& one : privileges_of(needs_of(entry, component.options, problem), kind))
      if (std::ranges::find(all, one) == all.end()) all.push_back(one);
  }
  return all;
}

}  // namespace

Sheet problem_sheet(const Catalog& catalog, const Component& component) {
  const ProblemEntry& entry = catalog.problems.at(component.name);
  const Problem problem = make_problem(catalog, component, 0);
  Sheet sheet{.kind = "problem",
              .name = entry.name,
              .spec = component.spec,
              .title = entry.title,
              .formula = entry.formula,
              .source = entry.source,
              .note = entry.note,
              .options_text = json_text(describe_options(entry.options)),
              .oracles = names_of(problem.offers()),
              .inverse = kInverseNames[static_cast<int>(problem.inverse_kind())],
              .unknowns = problem.unknowns(),
              .residuals = problem.residuals(),
              .aim = entry.aim,
              .target = small(problem.target())};
  sheet.panels = entry.panels;
  sheet.condition = condition_of(problem);
  if (problem.truth()) sheet.truth = small(*problem.truth());
  if (problem.window() && problem.unknowns() == 2) draw_landscapes(problem, sheet);
  return sheet;
}

Sheet optimizer_sheet(const Catalog& catalog, const Component& component) {
  const OptimizerEntry& entry = catalog.optimizers.at(component.name);
  return {.kind = "optimizer",
          .name = entry.name,
          .spec = component.spec,
          .title = entry.title,
          .formula = entry.formula,
          .source = entry.source,
          .note = entry.note,
          .options_text = json_text(describe_options(entry.options)),
          .oracles = names_of(entry.needs),
          .privileges = possible_privileges(entry, component),
          .family = std::string(name_of(entry.family)),
          .tunable = entry.tunable.option};
}

namespace {

constexpr double kSheetSeconds = 30;

std::optional<MeasuredPrices> stored_prices(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    return sheet_from_text(read_text(file), file.string()).prices;
  } catch (const UsageError&) {
    return std::nullopt;  // damaged: it is written anew
  }
}

// Those that the folder has already, where this build measured them on this processor: a run that
// goes on does not change the report of what is done. The problem is made again, in a process of
// its own: what goes wrong in measuring does not cost the sheet.
std::optional<MeasuredPrices> prices_of(const Catalog& catalog, const Component& component,
                                        const std::filesystem::path& file) {
  const std::string build = prices_build(component);
  auto stored = stored_prices(file);
  if (are_ours(stored, build)) return stored;
  const auto measured = [&] {
    Sheet sheet;
    sheet.options_text = "[]";
    sheet.prices = measure_prices(make_problem(catalog, component, 0), build);
    return json_text(to_json(sheet));
  };
  const auto text = isolated_text(measured, kSheetSeconds).text;
  if (!text) return std::nullopt;
  return sheet_from_text(*text, "prices of " + component.spec).prices;
}

}  // namespace

void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store) {
  std::set<std::string> known;
  const auto made = [&](const std::string& spec, const auto& make) -> std::optional<Sheet> {
    if (!known.insert(spec).second) return std::nullopt;
    const auto text = isolated_text([&] { return json_text(to_json(make())); }, kSheetSeconds).text;
    if (!text) return std::nullopt;
    return sheet_from_text(*text, spec);
  };
  for (const Request& request : requests) {
    if (auto sheet = made("problem " + request.problem.spec,
                          [&] { return problem_sheet(catalog, request.problem); })) {
      sheet->prices =
          prices_of(catalog, request.problem, store.folder() / "components" / sheet->file_name());
      store.write(*sheet);
    }
    if (const auto sheet = made("optimizer " + request.optimizer.spec,
                                [&] { return optimizer_sheet(catalog, request.optimizer); }))
      store.write(*sheet);
  }
}

}  // namespace isoline::benchmarks
