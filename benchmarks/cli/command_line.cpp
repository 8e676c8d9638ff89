// Every verb's arguments and help, and the one place where CLI11 parses them.
#include "benchmarks/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/cli/notes.h"
#include "benchmarks/cli/numbers.h"
#include "benchmarks/cli/reporting.h"
#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verbs.h"
#include "core/errors.h"
#include "core/records/provenance.h"
#include "core/suggest.h"

namespace isoline::benchmarks {
namespace {

constexpr WholeLaw kJobs{1, 1024}, kThreads{1, 256};

std::string refuse_empty(std::string& text) { return text.empty() ? "it must not be empty" : ""; }

// An option or a flag of a verb. A function a type keeps CLI11's templates out of the verbs, where
// they would be laid out anew at each call.
template <class Value>
[[gnu::noinline]] CLI::Option* option(CLI::App& verb, const char* name, Value& value,
                                      const char* about) {
  return verb.add_option(name, value, about)->check(CLI::Validator(refuse_empty, ""));
}

// A number that `read` reads by its law, of the option's name and the text.
template <class Value, class Read>
CLI::Option* number(CLI::App& verb, const char* name, const char* type, Value& value,
                    const char* about, const Read& read) {
  const std::function<void(const std::string&)> set = [=, &value](const std::string& text) {
    value = static_cast<Value>(read(name, text));
  };
  return verb.add_option_function(name, set, about)->type_name(type);
}

// A whole number; its default, where it has one, stands in the help.
template <class Value>
void whole(CLI::App& verb, const char* name, Value& value, const char* about, WholeLaw law = {}) {
  CLI::Option* made = number(verb, name, "INT", value, about,
                             [law](auto& of, auto& text) { return read_whole(of, text, law); });
  if (value >= law.low) made->default_str(std::to_string(value));
}

CLI::Option* real(CLI::App& verb, const char* name, double& value, const Range& range,
                  const char* about) {
  return number(verb, name, "FLOAT", value, about,
                [range](auto& of, auto& text) { return read_real(of, text, range); });
}

void seed(CLI::App& verb, std::uint64_t& value, const char* about) {
  number(verb, "--seed", "UINT", value, about, read_seed)->default_str(std::to_string(value));
}

void time(CLI::App& verb, double& seconds, const char* about) {
  number(verb, "--time", "TIME", seconds, about, read_time);
}

void memory(CLI::App& verb, std::int64_t& bytes, const char* about) {
  number(verb, "--memory", "SIZE", bytes, about, read_bytes);
}

[[gnu::noinline]] CLI::Option* flag(CLI::App& verb, const char* name, bool& value,
                                    const char* about) {
  return verb.add_flag(name, value, about);
}

template <class Arguments>
struct Declared {
  CLI::App& verb;
  Arguments& given;
};

class CommandLine {
 public:
  // `runs`: or only reads.
  CommandLine(const std::string& program, Session& session, bool runs);
  int read(int count, char** arguments);  // and runs; the exit code

 private:
  template <class Arguments>
  Declared<Arguments> add(const char* name, const char* about,
                          int (*verb)(const Arguments&, Session&)) {
    const auto given = std::make_shared<Arguments>();
    CLI::App& declared = *app_.add_subcommand(name, about);
    declared.callback([this, given, verb] {
      if (runs_) exit_code_ = verb(*given, session_);
    });
    return {declared, *given};
  }
  std::vector<std::string> verbs() const;

  void add_run();
  void add_report();
  void add_compare();
  void add_baseline();
  void add_replay();
  void add_merge();
  void add_best();
  void add_claims();
  void add_list();
  void add_describe();
  void add_check();
  void add_audit();
  void add_validate();
  void add_tune();
  void add_train();
  void add_infer();
  void add_completion();

  const std::string program_;
  Session& session_;
  const bool runs_;
  CLI::App app_;
  int exit_code_ = kGood;
};

CommandLine::CommandLine(const std::string& program, Session& session, bool runs)
    : program_(program), session_(session), runs_(runs), app_(kAbout, program) {
  using This = CommandLine;
  app_.footer(kExamples);
  app_.set_version_flag("--version", "isoline " + version());
  app_.require_subcommand(1);
  for (const auto add_verb :
       {&This::add_run, &This::add_report, &This::add_compare, &This::add_baseline,
        &This::add_replay, &This::add_merge, &This::add_best, &This::add_claims, &This::add_list,
        &This::add_describe, &This::add_check, &This::add_audit, &This::add_validate,
        &This::add_tune, &This::add_train, &This::add_infer, &This::add_completion})
    (this->*add_verb)();
}

std::vector<std::string> CommandLine::verbs() const {
  std::vector<std::string> names;
  for (const CLI::App* verb : app_.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

int CommandLine::read(int count, char** arguments) {
  if (count > 1 && arguments[1][0] != '-') {
    const std::vector<std::string> known = verbs();
    require(std::ranges::find(known, arguments[1]) != known.end(),
            [&] { return unknown_name("verb", arguments[1], known); });
  }
  try {
    app_.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return runs_ ? app_.exit(error) : kGood;  // --help, --version
    throw UsageError(fmt::format("{} (see {} --help)", error.what(), program_));
  }
  return exit_code_;
}

void CommandLine::add_run() {
  const auto [verb, given] = add(
      "run", "Run a suite or a matrix of your own; what is done already is not repeated", run_verb);
  option(
      verb, "SUITE", given.suite,
      "Name of a suite, or path of one (default: quick); --problem and --optimizer keep its cells of these");
  option(verb, "--problem", given.problem, "Problems: 'sine[xi=1|32,phi=45],square'");
  option(verb, "--optimizer", given.optimizer, "Optimizers: 'adam[rate=1e-3],ceres-lm'");
  option(verb, "--seeds", given.seeds, "5 (0 to 4), 0..9, or =5");
  whole(verb, "--iterations", given.iterations, "Most iterations of a cell");
  whole(verb, "--work", given.work, "Most work of a cell, in forward solves");
  time(verb, given.seconds, "Most time of a cell: 10s, 2m; twice that of a processor kills it");
  real(verb, "--target", given.target, between(0, 1),
       "Stop at f_L + TARGET s, s the scale of the loss; where x is sought, at "
       "TARGET of its error (default: 1e-10)");
  whole(verb, "--threads", given.threads, "Threads of the libraries within a cell", kThreads);
  whole(verb, "--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  flag(verb, "--exclusive", given.exclusive, "One at a time, for tables of wall time");
  whole(verb, "--repeat", given.repeat, "Timings wanted of each cell", {1, 1000});
  memory(verb, given.memory_bytes, "Most memory of a cell (default: 4GB)");
  option(verb, "--rates", given.rates, "Table of tuned rates: builtin, none or a file")
      ->capture_default_str();
  option(verb, "--out", given.out,
         "Result folder (default: results/SUITE; of a matrix of your own or a part of a "
         "suite, a name made of its cells, the same for the same plan)");
  flag(verb, "--force", given.force, "Repeat cells that are done");
  flag(verb, "--reuse", given.reuse, "Keep cells that another build has done");
  option(verb, "--retry", given.retry, "Repeat cells that ended so: failed,crashed,timeout,memory")
      ->delimiter(',')
      ->allow_extra_args(false);
  flag(verb, "--allow-large", given.allow_large, "Plan more than a million cells");
  CLI::Option* dry =
      flag(verb, "--dry-run", given.is_dry, "Print the plan: cells, cached, inapplicable, time");
  flag(verb, "--all", given.lists_all, "With --dry-run: every cell, not the first 20")->needs(dry);
  flag(verb, "--no-report", given.no_report, "Leave the report out");
  flag(verb, "--keep-output", given.keeps_output,
       "Keep in each record what its cell wrote to the terminal, up to 64 KiB");
  flag(verb, "--quiet", given.quiet, "Print failures only");
}

void CommandLine::add_report() {
  const std::string about = "Write " + format_names();
  const auto [verb, given] = add("report", about.c_str(), report_verb);
  option(verb, "DIR", given.folders, "Result folders of `isoline run`")->required();
  option(verb, "--out", given.out, "Where to write (default: report/ in the first DIR)");
  const std::vector<std::string> measures(reports::kMeasureNames.begin(),
                                          reports::kMeasureNames.end());
  option(verb, "--by", given.by, "What is counted, in orders, tables and plots")
      ->check(CLI::IsMember(measures))
      ->capture_default_str();
  real(verb, "--tolerance", given.tolerance, between(1e-10, 1),
       "What may be left of a loss, or of an error in x, to count as solved")
      ->default_str("1e-6");
  verb.footer(kReportNotes);
}

void CommandLine::add_compare() {
  const auto [verb, given] =
      add("compare", "Tell what got worse between two results", compare_verb);
  option(verb, "BASE", given.before, "Result folder, baseline, or a report.json")->required();
  option(verb, "NEW", given.after, "Result folder, or a report.json")->required();
  real(verb, "--tolerance", given.tolerance, between(0, 1),
       "Relative tolerance of figures (default: equal bit for bit)");
  option(verb, "--time-cells", given.timed,
         "Cells (digests, or their beginnings) whose time is judged, 20 at most")
      ->delimiter(',');
  real(verb, "--noise", given.noise, between(0, 10),
       "Least band of noise of times, relative (default: 0.1)");
  option(verb, "--allow", given.allowed,
         "File that lists cells which NEW may lack (isoline.allowed/1), with reasons");
  flag(verb, "--common", given.is_common_only, "Let NEW lack any cell of BASE");
  option(verb, "--trend", given.trend,
         "Folder of earlier baselines, whose headline figures are shown, by file name");
  CLI::Option* json = flag(verb, "--json", given.as_json, "As JSON");
  flag(verb, "--markdown", given.as_markdown, "As Markdown")->excludes(json);
  verb.footer(kCompareNotes);
}

void CommandLine::add_baseline() {
  const auto [verb, given] = add(
      "baseline", "Keep what later results are compared with, as one small file", baseline_verb);
  option(verb, "RESULTS", given.folders, "Result folders of `isoline run`")->required();
  option(verb, "--out", given.out, "The file (default: standard output)");
  whole(verb, "--perturbations", given.perturbations,
        "Runs of each cell from a start that differs in the last bit", {0, 100});
  whole(verb, "--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  verb.footer(kBaselineNotes);
}

void CommandLine::add_replay() {
  const auto [verb, given] =
      add("replay", "Run the cell of a record again, and hold the two to each other bit for bit",
          replay_verb);
  option(verb, "RECORD", given.records, "Records of `isoline run`: files in runs/")->required();
  memory(verb, given.memory_bytes, "Most memory of a cell (default: 4GB)");
  verb.footer(kReplayNotes);
}

void CommandLine::add_merge() {
  const auto [verb, given] = add("merge", "Unite result folders into a new one", merge_verb);
  option(verb, "DIR", given.folders, "Result folders of `isoline run`")->required();
  option(verb, "--out", given.out, "The new result folder")->required();
  verb.footer(kMergeNotes);
}

void CommandLine::add_best() {
  const auto [verb, given] =
      add("best", "Keep the best losses of runs, where no least loss is declared", best_verb);
  option(verb, "DIR", given.folders, "Result folders of `isoline run`")->required();
  option(verb, "--out", given.out, "Table of best losses; of two the lesser stays")
      ->capture_default_str();
  verb.footer(kBestNotes);
}

void CommandLine::add_claims() {
  const auto [verb, given] =
      add("claims", "Judge what papers claim, by runs; what is missing is run first", claims_verb);
  option(verb, "ID", given.names, "Claims, or groups of them (default: all)");
  option(verb, "--out", given.out, "Result folder that holds the runs")->capture_default_str();
  whole(verb, "--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  flag(verb, "--list", given.is_list, "List the claims, and do nothing");
  flag(verb, "--json", given.as_json, "As JSON");
  flag(verb, "--no-run", given.no_run, "Judge by the runs that are there");
  flag(verb, "--long", given.with_long, "Run also what takes hours");
  verb.footer(kClaimsNotes);
}

void CommandLine::add_list() {
  const auto [verb, given] =
      add("list", "List the problems, networks, optimizers and suites", list_verb);
  option(verb, "KIND", given.kind, "problems, networks, optimizers, suites or all")
      ->check(CLI::IsMember({"problems", "networks", "optimizers", "suites", "all"}))
      ->capture_default_str();
  flag(verb, "--json", given.as_json, "As JSON");
  flag(verb, "--names", given.names_only, "Names only, one a line");
}

void CommandLine::add_describe() {
  const auto [verb, given] = add(
      "describe", "Tell the formula, options, needs and source of a problem, network or optimizer",
      describe_verb);
  option(verb, "NAME", given.name, "A name of `isoline list`, or a spec")->required();
  flag(verb, "--json", given.as_json, "As JSON");
}

void CommandLine::add_check() {
  const auto [verb, given] =
      add("check", "Hold a problem's derivatives, adjoint and inverse to each other, with figures",
          check_verb);
  option(verb, "SPEC", given.spec, "Problems, as in `isoline run` (default: all)");
  seed(verb, given.seed, "Seed of the instance and of the directions");
  flag(verb, "--json", given.as_json, "As JSON");
}

void CommandLine::add_audit() {
  const auto [verb, given] =
      add("audit", "Measure optimizers' scaling, invariance, order, consistency and oracles",
          audit_verb);
  option(verb, "OPTIMIZER", given.names, "Names of optimizers (default: all)");
  option(verb, "--out", given.out, "Folder to write audit.json to, as reports read it");
  flag(verb, "--json", given.as_json, "As JSON");
}

void CommandLine::add_validate() {
  const auto [verb, given] =
      add("validate", "Hold records, suites and every other JSON file of ours to its schema",
          validate_verb);
  option(verb, "PATH", given.paths, "Files, or folders to search for *.json")->required();
}

void CommandLine::add_tune() {
  const auto [verb, given] =
      add("tune", "Choose one option of each method for each problem, with an equal budget for all",
          tune_verb);
  option(verb, "SPEC,--problem", given.problem,
         "Problems, as in `isoline run`; of a suite those to keep");
  option(verb, "--suite", given.suite, "The pairs of this suite, with its budgets");
  option(verb, "--optimizer", given.optimizer,
         "Names of optimizers (default: all that have an option to tune)");
  option(verb, "--grid", given.grid,
         "Option and its values, low..high x count (default: the option that a method "
         "declares, at seven values around its default and more at an edge)");
  option(verb, "--unit", given.unit,
         "Unit of the grid: one, the problem's Cauchy step, or the published rate")
      ->check(CLI::IsMember({"one", "cauchy", "published"}))
      ->capture_default_str();
  option(verb, "--tuning-seeds", given.seeds, "Seeds, apart from those that judge")
      ->capture_default_str();
  whole(verb, "--work", given.work, "Most work of a run");
  whole(verb, "--iterations", given.iterations, "Most iterations of a run");
  whole(verb, "--jobs", given.jobs, "Runs at a time (default: one a core)", kJobs);
  option(verb, "--out", given.folder, "Folder of the records")->capture_default_str();
  option(verb, "--table", given.table, "Table of rates to write or to add to");
}

void CommandLine::add_train() {
  const auto [verb, given] =
      add("train", "Train a network on a learning problem and write it to a file", train_verb);
  option(verb, "PROBLEM", given.problem, "Problem: 'sine[xi=32]'; mode=learn goes without saying")
      ->required();
  option(verb, "--out", given.out, "Where to write it: .json, or any other name for raw numbers")
      ->required();
  option(verb, "--optimizer", given.optimizer, "Training method")->capture_default_str();
  whole(verb, "--iterations", given.iterations, "Steps of training");
  seed(verb, given.seed, "Seed of the start and of the samples");
  whole(verb, "--threads", given.threads, "Threads of the libraries", kThreads);
  time(verb, given.seconds, "Most time of training: 10s, 2m; twice that kills it");
  memory(verb, given.memory_bytes, "Most memory (default: 4GB)");
  flag(verb, "--quiet", given.quiet, "No progress");
}

void CommandLine::add_infer() {
  const auto [verb, given] =
      add("infer", "Apply a network that `isoline train` wrote to observations", infer_verb);
  option(verb, "NETWORK", given.network, "File of the trained network")->required();
  option(verb, "--input", given.input,
         "Observations, one a row: .npy of shape (samples, numbers) or (samples, N, N), or .csv")
      ->required();
  option(verb, "--output", given.output, "Where to write the inferred x: .npy or .csv")->required();
  time(verb, given.seconds, "When it is ended: 10s, 2m (default: 10m)");
  memory(verb, given.memory_bytes, "Most memory (default: 4GB)");
}

void CommandLine::add_completion() {
  const auto [verb, given] =
      add("completion", "Print the completion script of a shell", completion_verb);
  option(verb, "SHELL", given.shell, "bash")->check(CLI::IsMember({"bash"}))->capture_default_str();
  given.verbs = verbs();
}

}  // namespace

int parse_and_run(const std::string& program, int count, char** arguments, Session& session) {
  return CommandLine(program, session, true).read(count, arguments);
}

void parse_only(const std::string& program, int count, char** arguments) {
  Session none("", {});
  CommandLine(program, none, false).read(count, arguments);
}

}  // namespace isoline::benchmarks
