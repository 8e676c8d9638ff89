// Nonlinear regression with certified answers: the 27 sets of NIST's Statistical Reference
// Datasets. P(b) lists the model at the observed predictors, y* the responses, L = ½ Σ (yᵢ − y*ᵢ)².
// The error in x is max |bᵢ − cᵢ|/|cᵢ| against the certified c: 10^(−LRE), LRE the least log
// relative error of the parameters. Parameters keep NIST's scales.
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "core/json.h"
#include "problems/jet_physics.h"

namespace isoline::problems {

std::string_view embedded_nist();  // problems/nist.json

namespace {

// The response at parameters b and predictors x, for each scalar.
struct Model {
  const char* formula;  // as in the data file
  Real (*value)(const Real* b, const Real* x);
  First (*first)(const First* b, const Real* x);
  Second (*second)(const Second* b, const Real* x);
};

template <class F>
constexpr Model model(const char* formula, F) {
  return {formula, [](const Real* b, const Real* x) -> Real { return F{}(b, x); },
          [](const First* b, const Real* x) -> First { return F{}(b, x); },
          [](const Second* b, const Real* x) -> Second { return F{}(b, x); }};
}

auto square(const auto& a) { return a * a; }
auto bell(const auto& top, const auto& x, const auto& centre, const auto& width) {
  return top * exp(-square((x - centre) / width));
}
auto wave(const auto& even, const auto& odd, const auto& period, Real x) {
  const auto phase = 2 * std::numbers::pi * x / period;
  return even * cos(phase) + odd * sin(phase);
}

const Model kModels[] = {
    model("b1*(b2+x)^(-1/b3)",
          [](auto b, const Real* x) { return b[0] * pow(b[1] + x[0], -1 / b[2]); }),
    model("b1*(1-exp(-b2*x))",
          [](auto b, const Real* x) { return b[0] * (1 - exp(-b[1] * x[0])); }),
    model("exp(-b1*x)/(b2+b3*x)",
          [](auto b, const Real* x) { return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]); }),
    model("b1*x^b2", [](auto b, const Real* x) { return b[0] * pow(x[0], b[1]); }),
    model("b1+b2*cos(2*pi*x/12)+b3*sin(2*pi*x/12)+b5*cos(2*pi*x/b4)+b6*sin(2*pi*x/b4)"
          "+b8*cos(2*pi*x/b7)+b9*sin(2*pi*x/b7)",
          [](auto b, const Real* x) {
            return b[0] + wave(b[1], b[2], 12.0, x[0]) + wave(b[4], b[5], b[3], x[0]) +
                   wave(b[7], b[8], b[6], x[0]);
          }),
    model("(b1/b2)*exp(-0.5*((x-b3)/b2)^2)",
          [](auto b, const Real* x) {
            return b[0] / b[1] * exp(-0.5 * square((x[0] - b[2]) / b[1]));
          }),
    model("b1*exp(-b2*x)+b3*exp(-(x-b4)^2/b5^2)+b6*exp(-(x-b7)^2/b8^2)",
          [](auto b, const Real* x) {
            return b[0] * exp(-b[1] * x[0]) + bell(b[2], x[0], b[3], b[4]) +
                   bell(b[5], x[0], b[6], b[7]);
          }),
    model("(b1+b2*x+b3*x^2+b4*x^3)/(1+b5*x+b6*x^2+b7*x^3)",
          [](auto b, const Real* x) {
            return (b[0] + x[0] * (b[1] + x[0] * (b[2] + x[0] * b[3]))) /
                   (1 + x[0] * (b[4] + x[0] * (b[5] + x[0] * b[6])));
          }),
    model("(b1+b2*x+b3*x^2)/(1+b4*x+b5*x^2)",
          [](auto b, const Real* x) {
            return (b[0] + x[0] * (b[1] + x[0] * b[2])) / (1 + x[0] * (b[3] + x[0] * b[4]));
          }),
    model("b1*exp(-b2*x)+b3*exp(-b4*x)+b5*exp(-b6*x)",
          [](auto b, const Real* x) {
            return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
          }),
    model("b1*(x^2+x*b2)/(x^2+x*b3+b4)",
          [](auto b, const Real* x) {
            return b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3]);
          }),
    model("b1*exp(b2/(x+b3))",
          [](auto b, const Real* x) { return b[0] * exp(b[1] / (x[0] + b[2])); }),
    model("b1+b2*exp(-x*b4)+b3*exp(-x*b5)",
          [](auto b, const Real* x) {
            return b[0] + b[1] * exp(-x[0] * b[3]) + b[2] * exp(-x[0] * b[4]);
          }),
    model("b1*(1-(1+b2*x/2)^(-2))",
          [](auto b, const Real* x) { return b[0] * (1 - 1 / square(1 + b[1] * x[0] / 2)); }),
    model("b1*(1-(1+2*b2*x)^(-0.5))",
          [](auto b, const Real* x) { return b[0] * (1 - 1 / sqrt(1 + 2 * b[1] * x[0])); }),
    model("b1*b2*x/(1+b2*x)",
          [](auto b, const Real* x) { return b[0] * b[1] * x[0] / (1 + b[1] * x[0]); }),
    model("log(y) = b1-b2*x1*exp(-b3*x2)",
          [](auto b, const Real* x) { return b[0] - b[1] * x[0] * exp(-b[2] * x[1]); }),
    model("b1/(1+exp(b2-b3*x))",
          [](auto b, const Real* x) { return b[0] / (1 + exp(b[1] - b[2] * x[0])); }),
    model("b1/(1+exp(b2-b3*x))^(1/b4)",
          [](auto b, const Real* x) { return b[0] / pow(1 + exp(b[1] - b[2] * x[0]), 1 / b[3]); }),
    model("b1-b2*x-arctan(b3/(x-b4))/pi",
          [](auto b, const Real* x) {
            return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) / std::numbers::pi;
          }),
};

// The model at each observation, x (count, m) one a column.
struct Regression {
  Model model;
  Matrix x;

  void operator()(const Real* b, int, Real* y, int m) const { fill(model.value, b, y, m); }
  void operator()(const First* b, int, First* y, int m) const { fill(model.first, b, y, m); }
  void operator()(const Second* b, int, Second* y, int m) const { fill(model.second, b, y, m); }

 private:
  template <class Scalar>
  void fill(Scalar (*response)(const Scalar*, const Real*), const Scalar* b, Scalar* y,
            int m) const {
    for (int i = 0; i < m; ++i) y[i] = response(b, x.col(i).data());
  }
};

const Json& datasets() {
  static const Json all = parse_json(std::string(embedded_nist()), "nist.json").at("datasets");
  return all;
}

struct Nist {
  std::string dataset = "Misra1a";
  Index start = 1;
};
void fields(Nist& o, auto& field) {
  Choices names;
  for (const auto& each : datasets().items()) names.push_back(each.key());
  field("dataset", o.dataset, names, "name of the data set");
  field("start", o.start, between(1, 2), "which of NIST's two starts; 2 is nearer to the solution");
}

Vector vector_of(const Json& list) {
  const std::vector<Real> values = reals_of(list);
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

ProblemParts make_nist(const Nist& o, const Draw& draw) {
  const Json& set = datasets().at(o.dataset);
  const std::string formula = set.at("model");
  const auto found = std::ranges::find(kModels, formula, &Model::formula);
  require(found != std::end(kModels), "nist.json: a formula without a model");
  const Json& rows = set.at("data_y_x");
  const Index m = static_cast<Index>(rows.size());
  const Vector first = vector_of(rows[0]);
  Matrix x(first.size() - 1, m), y(m, 1);
  for (Index i = 0; i < m; ++i) {
    const Vector row = vector_of(rows[static_cast<std::size_t>(i)]);
    y(i, 0) = formula.starts_with("log(y)") ? std::log(row[0]) : row[0];
    x.col(i) = row.tail(row.size() - 1);
  }
  const Vector certified = vector_of(set.at("certified"));
  // The sum of squares has eleven digits; that of Lanczos1, 1e-25, is beyond double precision,
  // which attains 4e-21 there.
  constexpr Real kDigits = 1e-10, kRounding = 1e-20;
  const Real minimum = real_of(set.at("rss")) / 2;
  std::vector<std::string> names;  // as NIST has them
  for (Index i = 1; i <= certified.size(); ++i) names.push_back("b" + std::to_string(i));
  return {
      .physics = std::make_unique<JetPhysics<Regression>>(Regression{*found, std::move(x)},
                                                          certified.size(), m),
      .start = draw.start(vector_of(set.at(o.start == 1 ? "start1" : "start2")), StartScale::own),
      .start_scale = StartScale::own,
      .target = y,
      .minimum = minimum,
      .minimum_error = kDigits * minimum + kRounding,
      .truth = certified,
      .names = std::move(names),
      .x_error = [certified](BatchRef b, const Batch&) {
        return ((b.col(0) - certified).array() / certified.array()).abs().maxCoeff();
      }};
}

}  // namespace

void register_nist(ProblemRegistry& registry) {
  registry.add(problem_entry(
      {.name = "nist",
       .title = "Nonlinear regression with certified parameters",
       .group = Group::classical,
       .formula = "yᵢ = model(b; xᵢ),  L = ½Σ(yᵢ − y*ᵢ)²",
       .source = "NIST Statistical Reference Datasets, nonlinear regression",
       .note = "27 data sets, two starts each. The error in x is 10^(−LRE), LRE the log relative "
               "error of the worst parameter.",
       .aim = Aim::x,
       .in_all = false},
      make_nist));
}

}  // namespace isoline::problems
