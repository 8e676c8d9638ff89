// x(z) of the words of a model: x of fixed unknowns is constant, of tied ones an expression, of
// logarithmic ones exp(z); and the residuals (y(x(z)) − y*)/σ, with (x − mean)/sd of each prior.
#include "problems/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/failures.h"
#include "core/numbers.h"
#include "problems/differences.h"
#include "problems/expression.h"
#include "problems/wrapper.h"

namespace isoline::problems {
namespace {

constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();

// "k1; k2 = 3" as pairs of a name and the text after its sign, which may be empty.
std::vector<std::pair<std::string, std::string>> pairs_in(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(",;", at), text.size());
    const std::string_view item = std::string_view(text).substr(at, end - at);
    const std::size_t sign = std::min(item.find('='), item.size());
    if (!bare_cell(item).empty())
      pairs.emplace_back(bare_cell(item.substr(0, sign)),
                         bare_cell(item.substr(std::min(sign + 1, item.size()))));
    at = end + 1;
  }
  return pairs;
}

Real number_of(std::string_view text, const char* word, std::string_view name) {
  const auto value = number_in(text);
  require(value && std::isfinite(*value),
          [&] { return fmt::format("{}: expected a number for {}, got '{}'", word, name, text); });
  return *value;
}

// (m)
Vector factors_of(const std::string& text, const char* word, Index m) {
  std::vector<Real> numbers;
  for (const auto& cell : cells_of_line(text))
    numbers.push_back(number_of(cell, word, fmt::format("datum {}", numbers.size() + 1)));
  require_factors(numbers, word, m);
  if (numbers.size() == 1) return Vector::Constant(m, numbers[0]);
  return Eigen::Map<const Vector>(numbers.data(), m);
}

struct Tie {
  Index unknown;
  Expression expression;
};
struct Prior {
  Index unknown;
  Real mean, deviation;
};

struct Mapping {
  std::vector<std::string> names;  // of x, (k)
  Vector x;                        // with the values of fixed unknowns, (k)
  std::vector<Index> free;         // (n), ascending
  std::vector<bool> is_log;        // (n)
  std::vector<Tie> ties;
  std::vector<Prior> priors;
  Vector factors;             // of the residuals of the data, (m); empty: 1
  std::optional<Bounds> box;  // of x, (k)

  Index unknowns() const { return std::ssize(free); }
  bool has_log(Index j) const { return is_log[static_cast<std::size_t>(j)]; }
  Index outer(Index j) const { return free[static_cast<std::size_t>(j)]; }
  Index index(const std::string& name, const char* word) const {
    const auto at = std::ranges::find(names, name);
    require(at != names.end(), [&] {
      std::string known;
      for (const std::string& each : names) known += " " + each;
      return fmt::format("{}: there is no unknown '{}'; there are{}", word, name, known);
    });
    return at - names.begin();
  }

  Vector to_x(VectorRef z) const {
    Vector full = x;
    for (Index j = 0; j < unknowns(); ++j) full[outer(j)] = has_log(j) ? std::exp(z[j]) : z[j];
    for (const Tie& tie : ties) full[tie.unknown] = tie.expression(full).value;
    return full;
  }
  // ∂x/∂z, (k, n)
  Matrix slopes(VectorRef z) const {
    Vector full = x;
    Matrix S = Matrix::Zero(x.size(), unknowns());
    for (Index j = 0; j < unknowns(); ++j) {
      full[outer(j)] = has_log(j) ? std::exp(z[j]) : z[j];
      S(outer(j), j) = has_log(j) ? full[outer(j)] : 1;
    }
    for (const Tie& tie : ties) {
      const Expression::Value found = tie.expression(full);
      full[tie.unknown] = found.value;
      S.row(tie.unknown) = found.by.transpose() * S;
    }
    return S;
  }
  bool has_ties_within_bounds(BatchRef full) const {
    return !box || std::ranges::all_of(ties, [&](const Tie& tie) {
      const auto row = full.row(tie.unknown).array();
      return (row >= box->lower[tie.unknown] && row <= box->upper[tie.unknown]).all();
    });
  }
  // −infinity where x has no logarithm.
  Vector to_z(VectorRef full) const {
    Vector z(unknowns());
    for (Index j = 0; j < unknowns(); ++j) {
      const Real value = full[outer(j)];
      z[j] = has_log(j) ? std::log(std::max<Real>(value, 0)) : value;
    }
    return z;
  }
};

Mapping mapping_of(const ModelWords& words, const ProblemParts& parts) {
  const Index k = parts.physics->inputs(), m = parts.physics->outputs();
  Mapping map{.names = parts.names, .x = parts.start.standard};
  map.box = parts.bounds;
  for (Index i = std::ssize(map.names); i < k; ++i) map.names.push_back(fmt::format("x{}", i + 1));
  std::vector<bool> is_held(static_cast<std::size_t>(k)), is_log = is_held;
  for (const auto& [name, value] : pairs_in(words.fixed)) {
    const Index i = map.index(name, "fixed");
    is_held[static_cast<std::size_t>(i)] = true;
    if (!value.empty()) map.x[i] = number_of(value, "fixed", name);
    const auto& box = map.box;
    require(!box || (box->lower[i] <= map.x[i] && map.x[i] <= box->upper[i]), [&] {
      return fmt::format("fixed: {} = {} lies outside its bounds, {} to {}", name, map.x[i],
                         box->lower[i], box->upper[i]);
    });
  }
  const auto ties = pairs_in(words.tied);
  std::vector<std::string> known = map.names;  // without those that are tied further on
  for (const auto& [name, _] : ties) known[static_cast<std::size_t>(map.index(name, "tied"))] = "";
  for (const auto& [name, text] : ties) {
    const Index i = map.index(name, "tied");
    require(!is_held[static_cast<std::size_t>(i)],
            [&] { return fmt::format("tied: {} is fixed or tied already", name); });
    map.ties.push_back({i, Expression(text, known)});
    known[static_cast<std::size_t>(i)] = name;
    is_held[static_cast<std::size_t>(i)] = true;
  }
  for (const auto& [name, _] : pairs_in(words.log))
    is_log[static_cast<std::size_t>(map.index(name, "log"))] = true;
  for (Index i = 0; i < k; ++i) {
    if (is_held[static_cast<std::size_t>(i)]) continue;
    const bool has_log = is_log[static_cast<std::size_t>(i)];
    require(!has_log || map.x[i] > 0, [&] {
      return fmt::format("log: {} starts at {}, and must be positive",
                         map.names[static_cast<std::size_t>(i)], map.x[i]);
    });
    map.free.push_back(i);
    map.is_log.push_back(has_log);
  }
  require(!map.free.empty(), "fixed and tied leave no unknown");
  if (!words.sigma.empty()) map.factors = factors_of(words.sigma, "sigma", m).cwiseInverse();
  if (!words.weights.empty()) map.factors = factors_of(words.weights, "weights", m);
  for (const auto& [name, text] : pairs_in(words.prior)) {
    std::size_t sign = text.find("±"), width = std::string_view("±").size();
    if (sign == text.npos) sign = text.find("+-"), width = 2;
    require(sign != text.npos, [&] {
      return fmt::format("prior: expected \"{} = MEAN ± DEVIATION\", got '{}'", name, text);
    });
    map.priors.push_back({map.index(name, "prior"), number_of(text.substr(0, sign), "prior", name),
                          number_of(text.substr(sign + width), "prior", name)});
    require(map.priors.back().deviation > 0,
            [&] { return fmt::format("prior: the deviation of {} must be positive", name); });
  }
  return map;
}

// The workspace of the physics inside, at x(z).
struct Inside final : Scratch {
  Workspace w;
  Matrix slopes;  // of each sample, side by side: (k, n·B)
  bool has_failed = false;
};

class Modelled final : public Wrapper {
 public:
  Modelled(std::unique_ptr<Physics> inside, Mapping map, std::vector<std::string> units)
      : inside_(std::move(inside)),
        map_(std::move(map)),
        model_{.names = map_.names, .units = std::move(units), .factors = map_.factors} {}

  const Mapping& map() const { return map_; }
  const Model& model() const { return model_; }
  const Physics& inside() const override { return *inside_; }
  Vector inner_point(VectorRef z) const override { return map_.to_x(z); }
  Matrix inner_slopes(VectorRef z) const override { return map_.slopes(z); }
  Index inputs() const override { return map_.unknowns(); }
  Index outputs() const override { return m() + std::ssize(map_.priors); }
  bool is_elsewhere() const override { return inside_->is_elsewhere(); }
  Products products() const override { return inside_->products(); }

  void begin_forwards(BatchRef z) const override { inside_->begin_forwards(points(z)); }
  void forward(BatchRef z, BatchRef c, BatchOut y, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    const Index n = inputs();
    own.w.x = points(z);
    own.w.context = c;
    own.w.saved_is_current = false;
    own.has_failed = !own.w.x.allFinite() || !map_.has_ties_within_bounds(own.w.x);
    if (own.has_failed) {
      add_failure({z.data(), static_cast<std::size_t>(z.rows())},
                  own.w.x.allFinite() ? "what is tied lies outside its bounds"
                                      : "x is not finite, by its logarithm or the expression that "
                                        "it is tied to");
      y.setConstant(kNaN);
      return;
    }
    own.slopes.resize(own.w.x.rows(), n * z.cols());
    for (Index b = 0; b < z.cols(); ++b) own.slopes.middleCols(b * n, n) = map_.slopes(z.col(b));
    auto data = y.topRows(m());
    inside_->forward(own.w.x, c, data, own.w);
    weigh(data);
    for (Index p = 0; p < std::ssize(map_.priors); ++p) {
      const Prior& prior = map_.priors[static_cast<std::size_t>(p)];
      y.row(m() + p) = (own.w.x.row(prior.unknown).array() - prior.mean) / prior.deviation;
    }
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    if (own.has_failed) {
      Jv.setConstant(kNaN);
      return;
    }
    const Index n = inputs();
    Matrix dx(own.w.x.rows(), v.cols());
    for (Index b = 0; b < v.cols(); ++b) dx.col(b) = own.slopes.middleCols(b * n, n) * v.col(b);
    auto data = Jv.topRows(m());
    inside_->pushforward(dx, data, own.w);
    weigh(data);
    add_priors(dx, Jv);
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    if (own.has_failed) {
      JTu.setConstant(kNaN);
      return;
    }
    const Index n = inputs();
    Matrix data = u.topRows(m()), dx(own.w.x.rows(), u.cols());
    weigh(data);
    inside_->pullback(data, dx, own.w);
    for (Index p = 0; p < std::ssize(map_.priors); ++p) {
      const Prior& prior = map_.priors[static_cast<std::size_t>(p)];
      dx.row(prior.unknown) += u.row(m() + p) / prior.deviation;
    }
    for (Index b = 0; b < u.cols(); ++b)
      JTu.col(b) = own.slopes.middleCols(b * n, n).transpose() * dx.col(b);
  }
  void jacobian(BatchOut J, Workspace& w) const override {
    Inside& own = w.as<Inside>();
    if (own.has_failed) {
      J.setConstant(kNaN);
      return;
    }
    const Index n = inputs(), k = own.w.x.rows(), batch = J.cols() / n;
    Matrix of_x(m(), k * batch);
    inside_->jacobian(of_x, own.w);
    weigh(of_x);
    for (Index b = 0; b < batch; ++b) {
      const auto slopes = own.slopes.middleCols(b * n, n);
      J.block(0, b * n, m(), n) = of_x.middleCols(b * k, k) * slopes;
      auto block = J.middleCols(b * n, n);
      add_priors(slopes, block);
    }
  }

 private:
  Index m() const { return inside_->outputs(); }
  Matrix points(BatchRef z) const {
    Matrix x(map_.x.size(), z.cols());
    for (Index b = 0; b < z.cols(); ++b) x.col(b) = map_.to_x(z.col(b));
    return x;
  }
  void weigh(BatchOut y) const {
    if (map_.factors.size() > 0) y.array().colwise() *= map_.factors.array();
  }
  // The rows of priors, from those of x.
  void add_priors(BatchRef dx, BatchOut rows) const {
    for (Index p = 0; p < std::ssize(map_.priors); ++p) {
      const Prior& prior = map_.priors[static_cast<std::size_t>(p)];
      rows.row(m() + p) = dx.row(prior.unknown) / prior.deviation;
    }
  }

  std::unique_ptr<Physics> inside_;
  Mapping map_;
  Model model_;
};

// Calls `visit` with each wrapper from the outermost one to that of the model; the latter, or none.
const Modelled* modelled_in(const Physics* physics, const auto& visit) {
  while (const auto* const wrapper = dynamic_cast<const Wrapper*>(physics)) {
    visit(*wrapper);
    if (const auto* const found = dynamic_cast<const Modelled*>(wrapper)) return found;
    physics = &wrapper->inside();
  }
  return nullptr;
}
const Modelled* modelled_in(const Problem& problem) {
  return modelled_in(&problem.physics(), [](const Wrapper&) {});
}

// Row s − 1 of the hypercube, of `count` rows: each column is a permutation of equal cells.
Vector hypercube_row(Index row, Index count, const Bounds& box) {
  RandomStream stream(0, "model", "latin hypercube");
  std::vector<Index> order(static_cast<std::size_t>(count));
  Vector z(box.lower.size());
  for (Index j = 0; j < z.size(); ++j) {
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[static_cast<std::size_t>(stream.uniform() * Real(i + 1))]);
    Real share = 0;
    for (Index i = 0; i < count; ++i) {
      const Real within = stream.uniform();
      if (i == row) share = (Real(order[static_cast<std::size_t>(i)]) + within) / Real(count);
    }
    z[j] = box.lower[j] + share * (box.upper[j] - box.lower[j]);
  }
  return z;
}

std::unique_ptr<Modelled> make_modelled(const ModelWords& words, ProblemParts& parts) {
  Mapping map = mapping_of(words, parts);
  return std::make_unique<Modelled>(std::move(parts.physics), std::move(map), parts.units);
}

}  // namespace

void require_factors(std::span<const Real> numbers, std::string_view what, Index m) {
  require(numbers.size() == 1 || std::ssize(numbers) == m, [&] {
    return fmt::format("{} must have one number or one for each of the {} data, got {}", what, m,
                       numbers.size());
  });
  require(std::ranges::all_of(numbers, [](Real each) { return each > 0 && std::isfinite(each); }),
          [&] { return fmt::format("{} must be positive", what); });
}

const Model* Problem::model() const {
  const Modelled* const found = modelled_in(*this);
  return found == nullptr ? nullptr : &found->model();
}

Vector factors_of_data(const Physics& physics, Index rows) {
  const Modelled* const found = modelled_in(&physics, [](const Wrapper&) {});
  if (found != nullptr && found->model().factors.size() > 0) return found->model().factors;
  return Vector::Ones(rows);
}

Vector Problem::factors_of_data() const {
  return isoline::problems::factors_of_data(physics(), residuals() - penalties());
}

Vector point_of_model(const Physics& physics, VectorRef theta) {
  Vector x = theta;
  modelled_in(&physics, [&](const Wrapper& wrapper) { x = Vector(wrapper.inner_point(x)); });
  return x;
}

namespace {

Matrix slopes_of_model(const Physics& physics, VectorRef theta) {
  Vector x = theta;
  Matrix slopes = Matrix::Identity(theta.size(), theta.size());
  modelled_in(&physics, [&](const Wrapper& wrapper) {
    slopes = Matrix(wrapper.inner_slopes(x) * slopes);
    x = Vector(wrapper.inner_point(x));
  });
  return slopes;
}

}  // namespace

Matrix Problem::model_slopes(VectorRef theta) const { return slopes_of_model(physics(), theta); }

Real given_step(const GivenSteps& given, const Physics& physics, VectorRef theta, Index j,
                Real size, Real otherwise) {
  const Modelled* const found = modelled_in(&physics, [](const Wrapper&) {});
  if (found == nullptr) return given.of(j, theta.size(), size, otherwise);
  const Index i = found->map().outer(j);
  const Real h = given.of(i, std::ssize(found->map().names), size, otherwise);
  return given.are_absolute ? h / std::abs(slopes_of_model(physics, theta)(i, j)) : h;
}

Real Problem::given_step(const GivenSteps& given, VectorRef theta, Index j, Real size,
                         Real otherwise) const {
  const Real h = problems::given_step(given, physics(), theta, j, size, otherwise);
  const Vector& scales = own_units().scales;
  return given.are_absolute && scales.size() > 0 ? h / scales[j] : h;
}

bool is_logarithm(const Problem& problem, Index unknown) {
  const Modelled* const found = modelled_in(problem);
  return found != nullptr && found->map().has_log(unknown);
}

Problem with_model(Problem plain, const ModelWords& words, const Draw& draw) {
  if (words.is_empty()) return plain;
  require(plain.is_least_squares() && plain.has_identity_network() && plain.samples() == 1,
          "fixed, tied, log, sigma, weights, prior and starts require a direct problem of one "
          "sample with a least-squares loss");
  require(words.sigma.empty() || words.weights.empty(), "sigma and weights exclude each other");
  require(words.prior.empty() || !words.sigma.empty(),
          "prior requires sigma: without it, the weight of the data beside the prior is unknown");
  const Real x_scale = plain.x_scale(plain.batch());
  ProblemParts parts = std::move(plain).parts();
  const std::optional<std::string> steps = remove_differences(parts);
  auto physics = make_modelled(words, parts);
  const Mapping& map = physics->map();
  const Index m = parts.target.rows(), n = map.unknowns();

  const Vector standard = map.to_z(map.x);
  Vector drawn = map.to_z(parts.start.drawn);
  for (Index j = 0; j < n; ++j)
    if (!std::isfinite(drawn[j])) drawn[j] = standard[j];
  parts.start = {drawn, standard};
  const std::optional<Bounds> bounds_of_x = parts.bounds;
  if (parts.bounds) {
    Bounds box{map.to_z(parts.bounds->lower), map.to_z(parts.bounds->upper),
               parts.bounds->are_needed};
    parts.start.drawn = box.nearest(parts.start.drawn);
    parts.start.standard = box.nearest(parts.start.standard);
    parts.bounds = std::move(box);
  }
  if (words.starts > 0) {
    require(parts.bounds && (parts.bounds->upper - parts.bounds->lower).allFinite(),
            "starts requires finite bounds of each unknown, above 0 for those of log");
    const auto start = static_cast<Index>(draw.start_seed());
    require(start < words.starts, [&] {
      return fmt::format("starts={} has the starts 0 to {}, not {}", words.starts, words.starts - 1,
                         start);
    });
    if (start > 0) parts.start.drawn = hypercube_row(start - 1, words.starts - 1, *parts.bounds);
  }

  // The x* of the problem holds where the words allow it.
  const auto in_z = [&](std::optional<Matrix>& x) {
    if (!x) return;
    const Vector z = map.to_z(x->reshaped());
    const bool is_same = map.to_x(z).isApprox(Vector(x->reshaped()), 1e-9);
    x = is_same ? std::optional<Matrix>(z) : std::nullopt;
  };
  const bool had_truth = parts.truth.has_value();
  in_z(parts.truth);
  in_z(parts.made_from);
  const bool is_weighted = map.factors.size() > 0;
  const bool lost_truth = had_truth && !parts.truth;
  if (lost_truth || !map.priors.empty() || !map.ties.empty() ||
      (parts.minimum && *parts.minimum > 0 && is_weighted))
    parts.minimum.reset();
  if (parts.x_error && !lost_truth) {
    parts.x_error = [inner = parts.x_error, map](BatchRef z, const Batch& batch) {
      Batch in_x = batch;
      if (batch.truth.size() > 0) in_x.truth = map.to_x(batch.truth.col(0));
      return inner(map.to_x(z.col(0)), in_x);
    };
    parts.x_scale = x_scale;
  } else {
    parts.x_error = {};
    parts.x_scale.reset();
    parts.aim = Aim::loss;
  }

  parts.own_units = {.scales = {}, .bounds = bounds_of_x};
  std::vector<std::string> names, units;
  for (Index j = 0; j < n; ++j) {
    const auto i = static_cast<std::size_t>(map.outer(j));
    names.push_back((map.has_log(j) ? "ln " : "") + map.names[i]);
    if (!parts.units.empty()) units.push_back(map.has_log(j) ? "" : parts.units[i]);
  }
  parts.names = std::move(names);
  parts.units = std::move(units);

  const Index priors = std::ssize(map.priors);
  if (is_weighted) parts.target.array().colwise() *= map.factors.array();
  add_penalties(parts, priors);
  if (!words.sigma.empty())
    parts.noise_level = std::sqrt(static_cast<Real>(m));
  else if (is_weighted)
    parts.noise_level.reset();
  parts.scale.reset();
  leave_views_out(parts);
  parts.physics = std::move(physics);
  if (steps) replace_derivatives(parts, "central", true, *steps);
  return Problem(std::move(parts));
}

}  // namespace isoline::problems
