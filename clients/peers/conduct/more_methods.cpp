// Methods of GSL, Ceres and pagmo by their defaults, as methods.cpp has those of dlib and ALGLIB.
// flags: -I/usr/include/eigen3 -lgsl -lgslcblas -lceres -lglog -lpagmo -lboost_serialization -ltbb
#include <ceres/ceres.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_multimin.h>

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "methods.h"

Vector numbers_of(const gsl_vector* x) {  // by its stride
  Vector numbers(given.n);
  for (std::size_t i = 0; i < given.n; ++i) numbers[i] = gsl_vector_get(x, i);
  return numbers;
}

int residual(const gsl_vector* x, void*, gsl_vector* r) {
  const Vector found = ask("residual", numbers_of(x).data());
  for (std::size_t i = 0; i < given.m; ++i) gsl_vector_set(r, i, found[i]);
  return GSL_SUCCESS;
}
double value(const gsl_vector* x, void*) { return ask("value", numbers_of(x).data())[0]; }
void slope(const gsl_vector* x, void*, gsl_vector* g) {
  const Vector found = ask("gradient", numbers_of(x).data());
  for (std::size_t i = 0; i < given.n; ++i) gsl_vector_set(g, i, found[i]);
}
void both(const gsl_vector* x, void*, double* v, gsl_vector* g) {
  *v = value(x, 0), slope(x, 0, g);
}

void run_gsl(const std::string& method) {
  constexpr double kTight = 1e-8;
  const gsl_vector_view start = gsl_vector_view_array(given.x.data(), given.n);
  if (method == "bfgs2") {
    gsl_multimin_function_fdf loss{value, slope, both, given.n, nullptr};
    auto* state = gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, given.n);
    gsl_multimin_fdfminimizer_set(state, &loss, &start.vector, 0.01, 0.1);
    int code = GSL_CONTINUE;
    for (int i = 0; i < 1000 && code == GSL_CONTINUE; ++i) {
      code = gsl_multimin_fdfminimizer_iterate(state);
      if (code == GSL_SUCCESS) code = gsl_multimin_test_gradient(state->gradient, kTight);
    }
    return finish(code == GSL_SUCCESS, "none", "status_" + std::to_string(code),
                  numbers_of(state->x).data());
  }
  auto options = gsl_multifit_nlinear_default_parameters();
  if (method == "lmaccel") options.trs = gsl_multifit_nlinear_trs_lmaccel;
  if (method == "dogleg") options.trs = gsl_multifit_nlinear_trs_dogleg;
  auto* state = gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, given.m, given.n);
  gsl_multifit_nlinear_fdf fit{};
  fit.f = residual, fit.n = given.m, fit.p = given.n;
  gsl_multifit_nlinear_init(&start.vector, &fit, state);
  int info = 0;
  const int code =
      gsl_multifit_nlinear_driver(1000, kTight, kTight, 0, nullptr, nullptr, &info, state);
  finish(code == GSL_SUCCESS, std::to_string(fit.nevalf),
         "status_" + std::to_string(code) + ",_info_" + std::to_string(info),
         numbers_of(state->x).data());
}

struct Residual {
  bool operator()(double const* const* x, double* r) const {
    const Vector found = ask("residual", x[0]);
    std::copy(found.begin(), found.end(), r);
    return true;
  }
};

void run_ceres() {
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Residual, ceres::CENTRAL>(new Residual);
  cost->AddParameterBlock(static_cast<int>(given.n));
  cost->SetNumResiduals(static_cast<int>(given.m));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, given.x.data());
  for (int i = 0; given.has_bounds && i < static_cast<int>(given.n); ++i) {
    problem.SetParameterLowerBound(given.x.data(), i, given.lower[i]);
    problem.SetParameterUpperBound(given.x.data(), i, given.upper[i]);
  }
  ceres::Solver::Summary summary;
  ceres::Solve({}, &problem, &summary);
  finish(summary.termination_type == ceres::CONVERGENCE,
         std::to_string(summary.num_residual_evaluations),
         ceres::TerminationTypeToString(summary.termination_type), given.x.data());
}

struct Loss {
  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    return {ask("value", x.data())[0]};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const auto [lower, upper] = finite_bounds();
    return {lower, upper};
  }
};

void run_pagmo(const std::string& method) {
  pagmo::population all(pagmo::problem(Loss()), 19, 1U);
  all.push_back(given.x);
  all = pagmo::algorithm(method == "de"
                             ? pagmo::algorithm(pagmo::de(100U, 0.8, 0.9, 2U, 1e-6, 1e-6, 1U))
                             : pagmo::algorithm(pagmo::cmaes(100U, -1, -1, -1, -1, 0.5, 1e-6, 1e-6,
                                                             false, false, 1U)))
            .evolve(all);
  finish(false, std::to_string(all.get_problem().get_fevals()), "no_code", all.champion_x().data());
}

int main(int, char** words) {
  const std::string package = words[1], method = words[2];
  gsl_set_error_handler_off();
  run_each([&] {
    if (package == "gsl") run_gsl(method);
    if (package == "ceres") run_ceres();
    if (package == "pagmo") run_pagmo(method);
  });
}
