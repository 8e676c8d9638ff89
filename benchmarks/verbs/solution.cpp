// isoline solution DIR...: the x that runs found, with what is known of its accuracy; isoline
// solution NETWORK --input FILE: the x that a trained network infers from observations.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/cli/planned_run.h"
#include "benchmarks/cli/terminal.h"
#include "benchmarks/cli/verb.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/refit.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/trained.h"
#include "core/differences.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/evaluations.h"
#include "core/json.h"
#include "core/output.h"
#include "core/records/naming.h"
#include "core/records/npy.h"
#include "core/results/answers.h"
#include "core/results/profile.h"
#include "core/results/uncertainty.h"
#include "core/seeds.h"
#include "core/text.h"
#include "reports/formats/formats.h"
#include "reports/sections/answers.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

struct SolutionArguments {
  std::vector<std::string> folders;
  std::string problem, optimizer = "best", format = "table", out;
  std::string input, training_data;  // of a trained network, whose file then is the only folder
  std::int64_t memory_bytes = 0;     // 0: as a cell's
  double seconds = 600;
  std::vector<std::string> unknowns;
  bool profile = false, trust = false;
};

void declare(VerbArguments& verb, SolutionArguments& given) {
  verb.texts(
          "DIR", given.folders,
          "Result folders of `isoline run`; or one file of a network, as `isoline train` wrote it")
      .required();
  verb.text("--problem", given.problem, "Problem, by its name or its specification (default: all)");
  verb.text("--optimizer", given.optimizer,
            "Optimizer, by its name or its specification; best: the run of least loss")
      .shown();
  verb.text("--format", given.format, "Format of the output")
      .one_of({"table", "csv", "json", "npy"})
      .shown();
  verb.flag(
      "--profile", given.profile,
      "Add profile-likelihood intervals: at values of each unknown, all others are fitted "
      "again from there. Calls of 0.1 s or more are kept, so that repeating the command goes on");
  verb.texts("--unknown", given.unknowns, "Profile this unknown (default: all); repeatable")
      .one_each();
  verb.flag("--trust", given.trust, kTrust);
  verb.plugins();
  verb.text("--out,--output", given.out,
            "Output file, which npy and networks require (default: standard output)");
  verb.text(
      "--input", given.input,
      "Observations for a network, one per row: .npy of shape (samples, length of y) or (samples, "
      "N, N), or .csv");
  verb.text("--training-data", given.training_data,
            "Instead of --input: apply the network to the N samples of the option data=N that it "
            "was trained on, and write their y* to this file");
  verb.time("--time", given.seconds, "Time limit of a network: 10s, 2m (default: 10m)");
  verb.memory("--memory", given.memory_bytes, "Memory limit of a network (default: 4GB)");
}

// A run with its answer, whose numbers are read.
struct Solution {
  const Record* record = nullptr;
  AnswerPoints answer = {};
  std::size_t others = 0;  // runs that reach its loss at another point
  Real distance = 0;       // to the farthest of those points
  std::vector<results::LikelihoodProfile> profiles = {};

  Real loss() const {
    const Summary& summary = record->summary;
    return answer.point(kBest).empty() ? summary.loss : summary.best_loss;
  }
  std::span<const Real> point() const {  // of least loss
    const std::span<const Real> best = answer.point(kBest);
    return best.empty() ? answer.point(kReturned) : best;
  }
  std::span<const Real> deviations() const {  // of the returned point
    if (results::doubt_of(*record) != results::Doubt::none) return {};
    return record->uncertainty->standard_deviation;
  }
};

AnswerPoints answer_in(const std::vector<std::string>& folders, const Record& record) {
  AnswerPoints answer = *record.answer;
  if (!answer.is_in_file()) return answer;
  for (const fs::path folder : folders) {
    const fs::path file = answer_path(folder / "runs" / record.file_name());
    if (!fs::exists(file)) continue;
    read_answer_numbers(answer, file);
    return answer;
  }
  throw UsageError(fmt::format("{} is missing: it holds the {} unknowns of the answer of {}",
                               answer_path(record.file_name()).string(), answer.unknowns,
                               record.file_name()));
}

void compare_with(const Solution& other, Solution& solution) {
  const Record &a = *solution.record, &b = *other.record;
  if (a.request.problem.spec != b.request.problem.spec || a.request.seed != b.request.seed) return;
  const Real scale = results::scale_of_ties(a, solution.loss(), other.loss());
  const Real apart = results::distance_at_equal_loss(solution.loss(), other.loss(), scale,
                                                     solution.point(), other.point());
  if (apart > 0) ++solution.others;
  solution.distance = std::max(solution.distance, apart);
}

// Losses on other data do not compare: that of the luckiest noise would be the least.
bool have_one_data_set(const Record& a, const Record& b) {
  if (a.request.problem.spec != b.request.problem.spec) return false;
  if (a.fit && b.fit) return a.fit->target == b.fit->target;
  return !(a.noise_level.value_or(0) > 0) ||
         instance_of(a.request.seed) == instance_of(b.request.seed);
}

// The run of least loss of each problem and data set, among those that are wanted.
std::vector<Solution> solutions_of(const results::Study& study, const SolutionArguments& given) {
  std::vector<Solution> all, chosen;
  for (const Record& record : study.runs)
    if (record.answer && (given.problem.empty() || is_named(record.request.problem, given.problem)))
      all.push_back({.record = &record, .answer = answer_in(given.folders, record)});
  const auto is_better = [](const Solution& a, const Solution& b) {
    constexpr Real kNear = 1 + 1e-5;  // of losses that differ by noise, that of a confirmed point
    const bool a_is_near = a.loss() <= kNear * b.loss(), b_is_near = b.loss() <= kNear * a.loss();
    const bool a_is_fit = !a.deviations().empty(), b_is_fit = !b.deviations().empty();
    if (a_is_near && b_is_near && a_is_fit != b_is_fit) return a_is_fit;
    return a.loss() < b.loss() || std::isnan(b.loss());
  };
  for (const Solution& each : all) {
    const Request& request = each.record->request;
    if (given.optimizer != "best" && !is_named(request.optimizer, given.optimizer)) continue;
    const auto same = std::ranges::find_if(chosen, [&](const Solution& other) {
      return have_one_data_set(*other.record, *each.record);
    });
    if (same == chosen.end())
      chosen.push_back(each);
    else if (is_better(each, *same))
      *same = each;
  }
  for (Solution& solution : chosen) {
    for (const Solution& other : all) compare_with(other, solution);
  }
  return chosen;
}

std::string table_text(const Solution& solution) {
  constexpr std::size_t kMostRows = 40;
  const Record& record = *solution.record;
  const Request& request = record.request;
  const auto digits = [](Real loss) { return fmt::format("{:.6g}", loss); };
  const std::string returned = digits(record.summary.loss), best = digits(solution.loss());
  std::string text =
      fmt::format("{} × {}, seed {}: {}, loss {}", reports::terminal_text(request.problem.spec),
                  reports::terminal_text(request.optimizer.spec), request.seed,
                  name_of(record.status), returned);
  if (solution.answer.residual_norm)
    text += fmt::format(
        ", {} {:.6g}",
        solution.record->fit && !solution.record->fit->sigma.empty() ? "‖(y − y*)/σ‖" : "‖y − y*‖",
        *solution.answer.residual_norm);
  text += best == returned ? "\n" : fmt::format("; best: loss {}\n", best);
  if (!record.message.empty())
    text += fmt::format("  {}\n", reports::terminal_text(record.message));
  if (const std::string doubt = reports::doubt_text(record); record.uncertainty && !doubt.empty())
    text += fmt::format("  {}\n", doubt);
  const auto columns = reports::answer_columns(record, solution.answer, "{:.10g}");
  const std::size_t rows = columns[0].texts.size(), shown = std::min(rows, kMostRows);
  for (std::size_t row = 0; row <= shown; ++row) {
    for (const reports::AnswerColumn& column : columns) {
      std::size_t width = column.name.size();
      for (std::size_t i = 0; i < shown; ++i) width = std::max(width, column.texts[i].size());
      text += fmt::format("  {:>{}}", row == 0 ? column.name : column.texts[row - 1], width);
    }
    text += "\n";
  }
  if (shown < rows)
    text += fmt::format("  {} more unknowns; --format csv prints all\n", rows - shown);
  if (!solution.profiles.empty()) text += "  profile intervals (95 %)\n";
  for (const results::LikelihoodProfile& profile : solution.profiles) {
    text += fmt::format("  {:>{}}  {:.6g} … {:.6g}\n", profile.name, columns[0].name.size(),
                        profile.low, profile.high);
    for (const std::string& message : profile.messages) text += fmt::format("    {}\n", message);
  }
  if (solution.others > 0)
    text += fmt::format(
        "  {} with the same loss {} at another point, up to {:.3g} away: the problem has more than "
        "one solution, or the loss does not determine x.\n",
        reports::counted(solution.others, "run"), solution.others == 1 ? "is" : "are",
        solution.distance);
  // Most messages say it.
  const bool is_said = record.message.find(" failed, the first") != std::string::npos;
  if (const auto& failures = record.failures; failures && !is_said)
    text +=
        fmt::format("  {} failed, the first with: {}. The record lists x and the reasons.\n",
                    reports::counted(static_cast<std::size_t>(failures->total), "evaluation"),
                    failures->reasons.empty() ? "" : reports::terminal_text(failures->reasons[0]));
  return text + fmt::format("  {}\n", reports::rerun_command(request));
}

std::string csv_text(const std::vector<Solution>& solutions) {
  std::string text =
      "problem,optimizer,seed,unknown,unit,returned,standard deviation,best,active bound\n";
  for (const Solution& solution : solutions) {
    const Request& request = solution.record->request;
    const auto columns = reports::answer_columns(*solution.record, solution.answer, "{}");
    for (std::size_t i = 0; i < columns[0].texts.size(); ++i) {
      text += fmt::format("{},{},{}", reports::exact_csv_field(request.problem.spec),
                          reports::exact_csv_field(request.optimizer.spec), request.seed);
      for (const char* name :
           {"unknown", "unit", "returned", "standard deviation", "best", "active bound"}) {
        const auto column = std::ranges::find(columns, name, &reports::AnswerColumn::name);
        text += "," + (column == columns.end() ? "" : reports::exact_csv_field(column->texts[i]));
      }
      text += "\n";
    }
  }
  return text;
}

Json to_json(const Solution& solution) {
  const Record& record = *solution.record;
  Json json{{"problem", record.request.problem.spec},
            {"optimizer", record.request.optimizer.spec},
            {"seed", record.request.seed},
            {"status", name_of(record.status)},
            {"message", record.message},
            {"loss", json_number(record.summary.loss)},
            {"best_loss", json_number(solution.loss())},
            {"runs_at_another_point", solution.others},
            {"command", reports::rerun_command(record.request)},
            {"record", record.file_name()}};
  for (std::size_t i = 0; i < solution.point().size(); ++i)
    json["unknowns"].push_back(solution.answer.name(i));
  const auto add = [&](const char* name, std::span<const Real> values) {
    if (!values.empty()) json[name] = json_numbers(values);
  };
  add("returned", solution.answer.point(kReturned));
  add("best", solution.answer.point(kBest));
  add("standard_deviation", solution.deviations());
  if (const auto test = results::noise_test(record)) json["p"] = json_number(test->p);
  if (const std::string doubt = reports::doubt_text(record); !doubt.empty()) json["doubt"] = doubt;
  if (!solution.deviations().empty()) {
    const std::int64_t freedom = record.uncertainty->degrees_of_freedom;
    json["degrees_of_freedom"] = freedom;
    json["t"] = results::student_quantile(0.975, static_cast<std::size_t>(freedom));
    for (const results::XInterval& each : results::intervals_of(record))
      json["interval"].push_back(json_numbers(std::vector{each.low, each.high}));
    for (const auto& row : record.uncertainty->correlation)
      json["correlation"].push_back(json_numbers(row));
  }
  if (!solution.answer.units.empty()) json["units"] = solution.answer.units;
  for (std::size_t i = 0; solution.answer.is_bound_active() && i < solution.point().size(); ++i)
    json["active_bounds"].push_back(solution.answer.bound(i));
  for (const results::LikelihoodProfile& profile : solution.profiles)
    json["profile"].push_back(results::to_json(profile));
  if (record.failures) json["failed_evaluations"] = record.failures->total;
  if (solution.answer.residual_norm)
    json["residual_norm"] = json_number(*solution.answer.residual_norm);
  return json;
}

std::string text_of(const std::vector<Solution>& solutions, const std::string& format) {
  if (format == "csv") return csv_text(solutions);
  std::string text;
  if (format == "json") {
    Json all = Json::array();
    for (const Solution& solution : solutions) all.push_back(to_json(solution));
    return json_text(all, 1) + "\n";
  }
  for (const Solution& solution : solutions)
    text += (text.empty() ? "" : "\n") + table_text(solution);
  return text;
}

// --- profiles

// A fit with the bounds of its problem; UsageError if the run has no standard deviations.
results::ProfiledFit profiled_fit(const Solution& solution, const Problem& problem) {
  const Record& record = *solution.record;
  require(!solution.deviations().empty() && solution.answer.residual_norm, [&] {
    const std::string doubt = reports::doubt_text(record);
    return fmt::format("a profile requires a fit with standard deviations{}{}",
                       doubt.empty() ? "" : ". ", doubt);
  });
  const std::span<const Real> x = solution.answer.point(kReturned);
  results::ProfiledFit fit{
      .best = {std::pow(*solution.answer.residual_norm, 2), {x.begin(), x.end()}},
      .deviation = record.uncertainty->standard_deviation,
      .variance = record.uncertainty->variance,
      .freedom = std::size_t(record.uncertainty->degrees_of_freedom)};
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  fit.lower.assign(x.size(), -kInfinity);
  fit.upper.assign(x.size(), kInfinity);
  if (const problems::Bounds* const bounds = problem.bounds()) {
    const Vector lower = problem.in_own_units(bounds->lower),
                 upper = problem.in_own_units(bounds->upper);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!std::isnan(lower[Index(i)])) fit.lower[i] = lower[Index(i)];
      if (!std::isnan(upper[Index(i)])) fit.upper[i] = upper[Index(i)];
    }
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    fit.names.push_back(solution.answer.name(i));
    fit.is_log.push_back(x[i] > 0 && results::has_log(record, fit.names[i]));
  }
  return fit;
}

// θ of the methods, one component for each free unknown, and x of the user's units.
class Units {
 public:
  Units(const Problem& problem, const results::ProfiledFit& fit) : fit_(fit) {
    const Index n = problem.unknowns();
    at_0_ = problem.in_own_units(Vector::Zero(n));
    at_1_ = problem.in_own_units(Vector::Ones(n));
    for (Index j = 0; j < n; ++j) {
      const std::string name = name_of_unknown(problem.names(), j);
      for (std::size_t i = 0; i < fit.names.size(); ++i)
        if (name == fit.names[i] || name == "ln " + fit.names[i]) places_.push_back(i);
    }
    require(std::ssize(places_) == n, "the names of the unknowns do not tell them apart");
  }
  std::optional<Index> component(std::size_t unknown) const {
    const auto at = std::ranges::find(places_, unknown);
    return at == places_.end() ? std::nullopt : std::optional<Index>(at - places_.begin());
  }
  Vector to_theta(const std::vector<Real>& x) const {
    Vector theta(std::ssize(places_));
    for (Index j = 0; j < theta.size(); ++j) {
      const std::size_t i = places_[static_cast<std::size_t>(j)];
      const auto k = static_cast<Index>(i);
      const auto z = [&](Real value) { return fit_.is_log[i] ? std::log(value) : value; };
      theta[j] = (z(x[i]) - z(at_0_[k])) / (z(at_1_[k]) - z(at_0_[k]));
    }
    return theta;
  }

 private:
  const results::ProfiledFit& fit_;
  Vector at_0_, at_1_;
  std::vector<std::size_t> places_;  // of the components of θ in x
};

// Puts the profiles in place of earlier ones of the cell.
void keep_profiles(const fs::path& folder, const std::string& cell,
                   const std::vector<results::LikelihoodProfile>& profiles) {
  const fs::path file = folder / "profile.json";
  std::vector<results::ProfiledCell> all;
  if (std::error_code unknown; fs::exists(file, unknown))
    all = results::profiles_from_text(read_text(file), file.string());
  std::erase_if(all, [&](const auto& each) { return each.cell == cell; });
  all.push_back({cell, profiles});
  write_text(file, json_text(results::profiles_to_json(all)) + "\n");
}

// The folder that has the record.
fs::path folder_of(const std::vector<std::string>& folders, const Record& record) {
  for (const fs::path folder : folders)
    if (fs::exists(folder / "runs" / record.file_name())) return folder;
  return folders.front();
}

void add_profiles(Solution& solution, const SolutionArguments& given, Session& session) {
  const Record& record = *solution.record;
  require_trust(given.trust, record);
  const Request request = request_again(session.catalog(), record, record.request.hard_seconds);
  Problem problem = make_problem(session.catalog(), request.problem, request.seed);
  results::ProfiledFit fit = profiled_fit(solution, problem);
  const fs::path from = folder_of(given.folders, record);
  if (problem.is_elsewhere()) evaluations().begin({.folder = from});  // answers and keeps its calls
  const Units units(problem, fit);
  std::vector<std::size_t> unknowns;
  const auto is_asked = [&](const std::string& name) {
    return given.unknowns.empty() || std::ranges::count(given.unknowns, name) > 0;
  };
  std::vector<std::string> free;
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    if (!units.component(i)) continue;
    free.push_back(fit.names[i]);
    if (is_asked(fit.names[i])) unknowns.push_back(i);
  }
  for (const std::string& name : given.unknowns)
    require(std::ranges::count(free, name) > 0, [&] {
      return fmt::format("--unknown: '{}' is no free unknown of the fit; there are {}", name,
                         fmt::join(free, ", "));
    });
  const auto n = static_cast<std::size_t>(problem.unknowns());
  const std::size_t ends = 2 * unknowns.size(), first = 2 + 3 * n;  // measured on calibrations
  constexpr Real kValley = 1000;  // a condition number from which a refit takes ten times as many
  const bool is_valley = record.uncertainty->condition > kValley;
  say(stderr,
      fmt::format("profile: {}, {} to {} forward solves{}\n",
                  reports::counted(unknowns.size(), "unknown"), first + ends * (n > 1 ? n + 2 : 3),
                  first + ends * (9 * n - 3) * (is_valley ? 10 : 1),
                  is_valley ? ", since the data hardly determine some unknowns" : ""));
  const Real t = results::student_quantile(0.975, fit.freedom);
  Refits refits(problem, units.to_theta(fit.best.x), fit.variance, t * t);
  const Vector best = problem.in_own_units(refits.fit());
  fit.best = {refits.least(), {best.begin(), best.end()}};
  fit.variance = refits.least() / static_cast<Real>(fit.freedom);
  const Vector deviations = refits.deviations();
  for (const std::size_t i : unknowns) {
    if (Vector theta = refits.fit(); !(fit.deviation[i] > 0)) {  // a bound holds it
      theta[*units.component(i)] += deviations[*units.component(i)];
      fit.deviation[i] = std::abs(problem.in_own_units(theta)[Index(i)] - fit.best.x[i]);
    }
    solution.profiles.push_back(results::profile_of(
        fit, i,
        [&](std::size_t unknown, const std::vector<Real>& start) -> std::optional<results::Refit> {
          const auto theta = refits(*units.component(unknown), units.to_theta(start));
          if (!theta) return std::nullopt;
          const Vector x = problem.in_own_units(*theta);
          return results::Refit{refits.has_converged() ? refits.sum_of_squares() : std::nan(""),
                                {x.begin(), x.end()}};
        }));
    const results::LikelihoodProfile& done = solution.profiles.back();
    say(stderr, fmt::format("profile: {}: {:.5g} … {:.5g}\n", done.name, done.low, done.high));
  }
  keep_profiles(from, record.cell, solution.profiles);
}

// --- the x of a trained network

// Reads, infers and writes; the sentence about it.
std::string inferred(const SolutionArguments& given, const Catalog& catalog) {
  const TrainedNetwork network = read_network(given.folders.front());
  const Problem problem = read_as(given.folders.front(), [&] {
    const Component component =
        complete_problem(catalog, network.problem.name, network.problem.options);
    require(component.is_learned, "it is not a trained network: its problem has no network");
    Problem made = make_problem(catalog, component, network.seed);
    require_fitting(network, made);
    return made;
  });
  require(given.training_data.empty() || !problem.has_fresh_batches(),
          "--training-data requires a network that was trained with data=N");
  const NumberArray input = given.training_data.empty()
                                ? read_numbers(given.input)
                                : samples_array(problem, problem.batch().input);
  const NumberArray output = infer(problem, network, input, given.input);
  if (!given.training_data.empty())
    write_numbers(given.training_data, samples_array(problem, problem.target()));
  write_numbers(given.out, output);
  return fmt::format("{}: {} inferred by {} trained on {} for {}", given.out,
                     reports::counted(std::size_t(output.shape[0]), "sample"),
                     network.optimizer.spec, network.problem.spec,
                     reports::counted(std::size_t(network.iterations), "iteration"));
}

// How the child process reports to its parent whether the user made a mistake.
constexpr char kSaid = '+', kMistaken = '-';

// In a process of its own, under limits: whatever a file holds costs that process alone.
int infer_isolated(const SolutionArguments& given, Session& session) {
  require(given.folders.size() == 1, "one trained network at a time");
  require(given.input.empty() != given.training_data.empty(),
          "x of a trained network requires either --input or --training-data");
  require(!given.out.empty(), "name the output file with --out x.npy or --out x.csv");
  const Catalog& catalog = session.catalog();
  const auto work = [&] {
    try {
      return kSaid + inferred(given, catalog);
    } catch (const UsageError& mistake) {
      return std::string(1, kMistaken) + mistake.what();
    }
  };
  const std::int64_t memory = given.memory_bytes > 0 ? given.memory_bytes : Limits{}.memory_bytes;
  const auto [text, failure, is_interrupted] = isolated_text(work, given.seconds, memory);
  if (!text || text->empty()) {
    say(stderr, fmt::format("isoline: {} was not written: {}\n", given.out,
                            text ? "the process did not answer" : failure));
    return kWorse;
  }
  require(text->front() != kMistaken, [&] { return text->substr(1); });
  say(stdout, text->substr(1) + "\n");
  return kGood;
}

int run(const SolutionArguments& given, Session& session) {
  const bool is_network = !given.input.empty() || !given.training_data.empty();
  if (std::error_code unknown; is_network || fs::is_regular_file(given.folders.front(), unknown))
    return infer_isolated(given, session);
  require(given.format != "npy" || !given.out.empty(),
          "--format npy writes a binary file: name it with --out x.npy");
  const results::Study study = study_of(given.folders);
  std::vector<Solution> solutions = solutions_of(study, given);
  require(!solutions.empty(), [&] {
    return fmt::format(
        "no record of {}{} in {} contains an x; records of network training, and those that "
        "earlier versions wrote, do not contain it",
        given.optimizer == "best" ? "any optimizer" : given.optimizer,
        given.problem.empty() ? "" : " on " + given.problem, reports::joined(given.folders));
  });
  for (Solution& solution : solutions) {
    if (!given.profile) break;
    try {
      add_profiles(solution, given, session);
    } catch (const UsageError& error) {  // others may have one
      if (solutions.size() == 1) throw;
      say(stderr, fmt::format("{}, seed {}: {}\n", solution.record->request.problem.spec,
                              seed_text(solution.record->request.seed), error.what()));
    }
  }
  if (given.format == "npy") {
    require(solutions.size() == 1, [&] {
      return fmt::format("--format npy writes one x, but {} problems match: choose with --problem",
                         solutions.size());
    });
    const auto x = solutions[0].point();
    make_output_folder(std::filesystem::path(given.out).parent_path());
    write_npy(given.out, {{static_cast<Index>(x.size())}, {x.begin(), x.end()}});
  } else {
    const std::string text = text_of(solutions, given.format);
    if (given.out.empty())
      say(stdout, text);
    else
      write_output(given.out, text, text.substr(0, text.find('\n')));
  }
  const bool is_doubtful = std::ranges::any_of(solutions, [](const Solution& solution) {
    return solution.record->status == Status::unconfirmed;
  });
  return is_doubtful ? kWorse : kGood;
}

}  // namespace

void register_solution(VerbRegistry& registry) {
  registry.add(verb_of<SolutionArguments>(
      {.name = "solution",
       .help_position = 47,
       .summary =
           "Print the unknowns x that runs found, with the command that repeats each run, or "
           "those that a trained network infers",
       .examples =
           R"(  isoline solution results/quick     for each problem, the run of least loss
  isoline solution results/quick --problem rosenbrock --optimizer ceres-bfgs
  isoline solution results/quick --problem rosenbrock --format npy --out x.npy
  isoline solution results/mine --profile --trust    intervals by profiles
  isoline solution net.json --input observed.csv --out x.csv)",
       .notes =
           "The exit code is 2 if a point that is printed is `unconfirmed`: its method stopped by "
           "its own test, and the harness did not find a solution there; the line below says why. "
           "`returned` is the point that the run returned, and `best` the evaluated point of least "
           "loss, if it is a different point. Standard deviations belong to the returned point of "
           "a least-squares problem that offers derivatives. With --format npy, the file contains the "
           "point of least loss; "
           "`isoline run --start FILE` starts from it."},
      declare, run));
}

}  // namespace isoline::benchmarks
