// The sample study: real descents on two-dimensional losses, invented but plausible curves
// elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/spec.h"
#include "core/status.h"
#include "tests/reports/fixture.h"
#include "tests/reports/sample_parts.h"

namespace isoline::reports {

namespace {

namespace fs = std::filesystem;

// Without the fsync of write_text(): thousands of them take minutes.
void save(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

// Counter-based and platform-free: a number in [0, 1) from a text.
Real chance(const std::string& text) {
  const std::string hex = digest(digest(text + "sample"));
  return static_cast<Real>(std::stoull(hex.substr(0, 8), nullptr, 16)) / 4294967296.0;
}

void add_point(Record& r, std::int64_t iteration, Real loss, Real x_error, int price) {
  const Real seconds = 2e-6 * static_cast<Real>(iteration * price + 1);
  r.curve.iteration.push_back(iteration);
  r.curve.work.push_back(iteration * price + 1);
  r.curve.counts["forward"].push_back(iteration + 1);
  r.curve.counts["pullback"].push_back(iteration);
  r.curve.counts["jacobian"].push_back(iteration);
  r.curve.counts["inverse"].push_back(iteration);
  r.curve.wall_seconds.push_back(seconds * 1.0123456789);
  r.curve.processor_seconds.push_back(seconds * 0.987654321);
  r.curve.loss.push_back(loss);
  r.curve.x_error.push_back(x_error);
  r.curve.gradient_norm.push_back(std::sqrt(loss) * 1.23456789);
  r.curve.step_norm.push_back(std::sqrt(loss) * 0.0123456789);
}

std::int64_t iteration_at(std::size_t k, std::size_t points) {
  return k < points / 2 ? static_cast<std::int64_t>(k)
                        : std::llround(static_cast<Real>(points) / 2 *
                                       std::pow(1.12, static_cast<Real>(k - points / 2)));
}

void fill_surface(Record& r, const Surface& s, const Kind& kind, std::size_t points) {
  Eigen::Vector2d x(3 - 0.3 * chance(r.cell), 3 - 0.3 * chance(r.cell + "2"));
  if (r.request.seed == 0) x = Eigen::Vector2d(3, 3);
  r.trajectory.emplace();
  std::int64_t done = 0;
  for (std::size_t k = 0; k < points; ++k) {
    for (; done < iteration_at(k, points); ++done) descend(s, kind, x);
    const Eigen::Vector2d y = s.map(x);
    r.trajectory->x.push_back({x[0], x[1]});
    r.trajectory->y.push_back({y[0], y[1]});
    add_point(r, done, y.squaredNorm(), x.norm(), kind.price);
    if (y.squaredNorm() < 1e-12) break;
  }
}

void fill_invented(Record& r, const Kind& kind, std::size_t points) {
  const std::string pair = r.request.problem.spec + kind.name;
  const Real speed =
      kind.speed * std::exp(2.5 * (chance(pair) - 0.6)) * std::exp(0.2 * (chance(r.cell) - 0.5));
  const Real floor = std::pow(10.0, -3 - 12 * chance(pair + "floor"));
  for (std::size_t k = 0; k < points; ++k) {
    const std::int64_t i = iteration_at(k, points);
    const Real wiggle = 1 + 0.2 * std::sin(static_cast<Real>(i) + 7 * chance(r.cell));
    const Real loss = 3.7 * (std::pow(10.0, -speed * static_cast<Real>(i)) * wiggle + floor);
    add_point(r, i, loss, 0.9 * std::pow(loss, 0.4), kind.price);
    if (loss < 3.7e-10) break;
  }
}

void finish(Record& r, bool is_declared) {
  const Curve& curve = r.curve;
  const Real start = curve.loss.front();
  if (is_declared) {
    r.minimum = 0;
    r.hits.emplace();
    for (int j = 0; j < 51; ++j) {
      const Real target = start * rung(static_cast<std::size_t>(j));
      std::size_t k = 0;
      while (k < curve.loss.size() && !(curve.loss[k] <= target)) ++k;
      const bool is_met = k < curve.loss.size();
      r.hits->target.push_back(target);
      r.hits->iteration.push_back(is_met ? curve.iteration[k] : -1);
      r.hits->work.push_back(is_met ? curve.work[k] : -1);
      r.hits->forwards.push_back(is_met ? curve.iteration[k] + 1 : -1);
      r.hits->wall_seconds.push_back(is_met ? curve.wall_seconds[k] : NAN);
    }
  }
  for (const auto& [name, column] : curve.counts)
    r.counts[std::size_t(std::ranges::find(kOracleNames, name) - kOracleNames.begin())] =
        column.back();
  r.status = curve.loss.back() <= 1e-10 * start ? Status::target : Status::budget;
  r.summary = {.iterations = curve.iteration.back(),
               .work = curve.work.back(),
               .start_loss = start,
               .loss = curve.loss.back(),
               .best_loss = std::ranges::min(curve.loss),
               .start_x_error = curve.x_error.front(),
               .x_error = curve.x_error.back(),
               .gradient_norm = curve.gradient_norm.back(),
               .wall_seconds = curve.wall_seconds.back(),
               .processor_seconds = curve.processor_seconds.back(),
               .peak_memory_bytes = 12345678};
}

void fail_some(Record& r, const Kind& kind) {
  const std::string name = kind.name;
  const bool is_large = r.request.problem.name == "heat" || r.request.problem.name == "fluid";
  if (std::string(kind.family) == "Derivative-free" && is_large) {
    r = {.cell = r.cell,
         .build = r.build,
         .request = r.request,
         .status = Status::inapplicable,
         .message = "derivative-free methods are limited to 256 unknowns, this problem has 4096",
         .provenance = r.provenance};
    r.summary.start_x_error = NAN;
  } else if (name == "broken" && r.request.seed % 2 == 0) {
    r.status = Status::crashed;
    r.message = "signal 11 (SIGSEGV) at iteration 17 <in step()>";
  } else if (chance(r.cell + "fate") < 0.01) {
    r.status = Status::diverged;
    r.curve.loss.back() = r.summary.loss = INFINITY;
  } else if (chance(r.cell + "fate") > 0.995) {
    r.status = Status::timeout;
    r.message = "killed at the hard limit of 60 s";
  }
  if (kind.is_privileged) r.privileges = {name == "newton" ? "exact Hessian" : "exact inverse"};
}

Provenance provenance() {
  Provenance all(Build{
      .version = "0.1.0",
      .commit = "2963533f00dbabe",
      .is_dirty = true,
      .compiler = "GNU 12.2.0",
      .build_type = "Release",
      .flags = "-O3 -DNDEBUG -march=native",
      .processor = "Intel(R) Xeon(R) Processor @ 2.70GHz",
      .cores = 2,
      .system = "Linux 6.1.0 x86_64",
      .libraries = {
          {"Eigen", "3.4.0"}, {"Ceres", "2.1.0"}, {"NLopt", "2.7.1"}, {"OpenBLAS", "0.3.21"}}});
  all.run = {.started = "2026-11-21T06:45:42Z",
             .concurrent_jobs = 2,
             .is_exclusive = false,
             .command = "./isoline run --suite inverse --seeds 5 --jobs 2"};
  return all;
}

Sheet sheet_of(const std::string& kind, const std::string& spec) {
  return {.kind = kind,
          .name = name_of_spec(spec),
          .spec = spec,
          .title = kind == "problem" ? "A physical inverse problem" : "A method of descent",
          .formula = kind == "problem" ? "P(x) = (x₁, x₂²),  L = ‖P(x)‖²" : "θ ← θ − η ∇L",
          .source = "Holl, Koltun, Thuerey (2022), Fig. 1",
          .options_text = "[]",
          .unknowns = 2,
          .residuals = 2};
}

void write(const fs::path& folder, const Sheet& sheet) {
  save(folder / "components" / sheet.file_name(), to_json(sheet).dump());
}

bool is_surface(const std::string& problem) {
  return problem.starts_with("sq") || problem.starts_with("si");
}

std::string problem_at(std::size_t p) {
  return p < kProblems.size() ? kProblems[p] : fmt::format("invented[case={}]", p);
}
std::string optimizer_at(std::size_t s) {
  return s < kKinds.size() ? kKinds[s].name : fmt::format("gd[rate={}]", s);
}

Record run_of(const std::string& problem, const Surface& shape, std::size_t s, std::size_t seed,
              std::size_t points) {
  const Kind& kind = kKinds[s % kKinds.size()];
  Record r = record_of({.problem = problem, .optimizer = optimizer_at(s), .seed = seed});
  r.curve = {};
  r.hits.reset();
  r.minimum.reset();
  r.provenance = provenance();
  if (is_surface(problem))
    fill_surface(r, shape, kind, points);
  else
    fill_invented(r, kind, points);
  finish(r, problem != "fluid" && problem != "burgers");
  fail_some(r, kind);
  return r;
}

void write_sheets(const fs::path& folder, const Size& size) {
  for (std::size_t s = 0; s < size.optimizers; ++s) {
    Sheet sheet = sheet_of("optimizer", optimizer_at(s));
    sheet.family = kKinds[s % kKinds.size()].family;
    write(folder, sheet);
  }
  for (std::size_t p = 0; p < size.problems; ++p) {
    Sheet sheet = sheet_of("problem", problem_at(p));
    sheet.prices = sample_prices(p);
    if (is_surface(sheet.name)) {
      const Surface shape = surface(sheet.name == "sine");
      sheet.landscape_x = shape.in_x;
      sheet.landscape_y = shape.in_y;
      sheet.truth = sheet.target = {0, 0};
    }
    write(folder, sheet);
  }
}

}  // namespace

void write_sample_study(const fs::path& folder, const Size& size) {
  fs::create_directories(folder / "runs");
  fs::create_directories(folder / "components");
  write_sheets(folder, size);
  Plan plan{.suites = {"inverse"}, .cells = {}};
  for (std::size_t p = 0; p < size.problems; ++p) {
    const std::string problem = problem_at(p);
    const Surface shape = surface(problem.starts_with("sine"));
    for (std::size_t s = 0; s < size.optimizers; ++s)
      for (std::size_t seed = 0; seed < size.seeds; ++seed) {
        const Record r = run_of(problem, shape, s, seed, size.points);
        plan.cells.push_back({r.cell, problem, r.request.optimizer.spec, seed});
        const bool is_lost = chance(r.cell + "lost") > 0.999;
        if (!is_lost) save(folder / "runs" / r.file_name(), to_json(r).dump());
      }
  }
  save(folder / "plan.json", to_json(plan).dump());
}

}  // namespace isoline::reports
