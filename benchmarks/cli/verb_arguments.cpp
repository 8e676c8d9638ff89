// Every verb's arguments, as its help lists them.
#include "benchmarks/cli/verb_arguments.h"

#include "benchmarks/cli/reporting.h"
#include "reports/exports/exports.h"

namespace isoline::benchmarks {
namespace {

constexpr WholeLaw kJobs{1, 1024}, kThreads{1, 256}, kShards{1, 100'000};
constexpr const char* kFolders = "Result folders of `isoline run`";

void declare_plugins(VerbArguments& verb, std::vector<std::string>& plugins) {
  verb.texts("--plugin", plugins,
             "Shared library whose problems and optimizers join those of `isoline list`; may be "
             "given more than once")
      .one_each();
}

void declare_cells(VerbArguments& verb, RunArguments& given) {
  verb.text("SUITE", given.suite,
            "Name of a suite, or path of one (default: quick); --problem and --optimizer keep the "
            "cells that have these");
  verb.text("--problem", given.problem, "Problems: 'sine[xi=1|32,phi=45],square'").joined();
  verb.text("--optimizer", given.optimizer, "Optimizers: 'adam[rate=1e-3],ceres-lm'").joined();
  verb.text("--seeds", given.seeds, "5 (0 to 4), 0..9, or =5");
  verb.whole("--iterations", given.iterations, "Most iterations of a cell");
  verb.whole("--work", given.work, "Most work of a cell, in forward solves");
  verb.time("--time", given.seconds,
            "Most time of a cell: 10s, 2m; a cell that uses twice that of a processor is killed");
  verb.real("--target", given.target, between(0, 1),
            "Stop at f_L + TARGET s, where s is the scale of the loss; where x is sought, at "
            "TARGET of its error (default: 1e-10)");
  verb.whole("--threads", given.threads, "Threads of the libraries within a cell", kThreads);
  verb.text("--rates", given.rates, "Table of tuned rates: builtin, none or a file").shown();
  verb.flag("--allow-large", given.allow_large, "Plan more than a million cells");
  declare_plugins(verb, given.plugins);
}

void declare_what_is_done(VerbArguments& verb, RunArguments& given) {
  verb.text("--out", given.out,
            "Result folder (default: results/SUITE; for a matrix of your own or a part of a suite, "
            "a name made of its cells, the same for the same plan)");
  verb.flag("--force", given.force, "Repeat cells that are done");
  verb.flag("--reuse", given.reuse, "Keep cells that another build has done");
  verb.texts("--retry", given.retry,
             "Repeat cells that ended with such a status: failed,crashed,timeout,memory")
      .between_commas();
}

void declare_what_is_kept(VerbArguments& verb, RunArguments& given) {
  verb.flag("--no-report", given.no_report, "Write no report");
  verb.flag("--keep-output", given.keeps_output,
            "Keep in each record what its cell wrote to the terminal, up to 64 KiB");
  verb.flag(
      "--fields", given.keeps_fields,
      "Keep x of problems on a grid, at six iterations, for every seed: else for seed 0 alone");
  verb.flag("--spectrum", given.keeps_spectra,
            "Keep the singular values of J = ∂y/∂θ at iterations 0, 1, 2, 4, 8, … and the last; "
            "cells that are done without them are repeated");
}

}  // namespace

void declare(VerbArguments& verb, RunArguments& given) {
  declare_cells(verb, given);
  verb.whole("--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  verb.flag("--exclusive", given.exclusive, "One cell at a time, for tables of wall time");
  verb.whole("--repeat", given.repeat, "Timings wanted of each cell", {1, 1000});
  verb.memory("--memory", given.memory_bytes, "Most memory of a cell (default: 4GB)");
  declare_what_is_done(verb, given);
  declare_what_is_kept(verb, given);
  verb.text("--shard", given.shard,
            "Run the third of sixteen parts, 3/16, into shards/3-of-16 of the result folder; auto: "
            "the part of this task of a SLURM array, or what ISOLINE_SHARD says");
  const Argument& dry = verb.flag("--dry-run", given.is_dry,
                                  "Print the plan: cells, cached, inapplicable, predicted time");
  verb.flag("--all", given.lists_all, "With --dry-run: list every cell, not the first 20")
      .needs(dry);
  verb.flag("--in-process", given.in_process,
            "Run the cells in this process, for a debugger: no isolation, no limits, no records")
      .excludes(dry);
  verb.flag("--quiet", given.quiet, "Print failures only");
}

void declare(VerbArguments& verb, PlanArguments& given) {
  declare_cells(verb, given.run);
  verb.whole("--jobs", given.run.jobs, "Cells at a time (default: one a core)", kJobs);
  declare_what_is_done(verb, given.run);
  verb.whole("--shards", given.shards,
             "Divide the plan into so many parts of about the same time, and keep the predictions "
             "that they go by in predicted.json of the result folder",
             kShards);
  verb.texts("--from", given.earlier, "Earlier result folders, whose times predict these")
      .between_commas();
  verb.flag("--all", given.run.lists_all, "List every shard, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON");
}

void declare(VerbArguments& verb, ReportArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "Where to write (default: report/ in the first DIR)");
  verb.text("--by", given.by, "What is counted, in orders, tables and plots")
      .one_of({reports::kMeasureNames.begin(), reports::kMeasureNames.end()})
      .shown();
  verb.real("--tolerance", given.tolerance, between(1e-10, 1),
            "Relative loss gap, or relative error in x, below which a problem counts as solved")
      .shown("1e-6");
  verb.flag("--open", given.opens, "Open the page in the browser of the desktop");
}

void declare(VerbArguments& verb, CompareArguments& given) {
  verb.text("BASE", given.before, "Result folder or baseline").required();
  verb.text("NEW", given.after, "Result folder").required();
  verb.real("--tolerance", given.tolerance, between(0, 1),
            "Relative tolerance of figures (default: equal bit for bit)");
  verb.texts("--time-cells", given.timed,
             "Cells (digests, or their beginnings) whose time is judged, 20 at most")
      .between_commas();
  verb.real("--noise", given.noise, between(0, 10),
            "Least band of noise of times, relative (default: 0.1)");
  verb.text("--allow", given.allowed,
            "File that lists cells which NEW may lack (isoline.allowed/1), with reasons");
  verb.flag("--common", given.is_common_only, "Let NEW lack any cell of BASE");
  verb.flag("--all", given.lists_all, "List every difference, not the first 20 lines");
  const Argument& json = verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--markdown", given.as_markdown, "Print Markdown").excludes(json);
}

void declare(VerbArguments& verb, BaselineArguments& given) {
  verb.texts("RESULTS", given.folders, "Result folders of `isoline run`").required();
  verb.text("--out", given.out, "The file (default: standard output)");
  verb.whole("--perturbations", given.perturbations,
             "Runs of each cell from a start that differs in the last bit", {0, 100});
  verb.whole("--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, ReplayArguments& given) {
  verb.texts("RECORD", given.records, "Records of `isoline run`: files in runs/").required();
  verb.memory("--memory", given.memory_bytes, "Most memory of a cell (default: 4GB)");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, MergeArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "The new result folder").required();
}

void declare(VerbArguments& verb, SubmitArguments& given) {
  verb.texts("RUN", given.run, "After --, what would stand after `isoline run`");
  verb.flag("--slurm", given.is_slurm, "By SLURM, which this machine can reach");
  verb.whole("--array", given.tasks,
             "Most tasks; fewer where SLURM's MaxArraySize or --least has it", kShards);
  verb.time("--time", given.seconds,
            "Most time of a task: 2h; one that is not done by then goes on in the next "
            "(default: the partition's)");
  verb.time("--least", given.least_seconds, "Least predicted time of a task (default: 5m)");
  verb.text("--partition", given.partition, "Partition (default: the cluster's)");
  verb.texts("--sbatch", given.options, "A further option of sbatch: --sbatch=--account=physics")
      .one_each();
  verb.flag("--yes", given.is_agreed, "Submit the two jobs; else they are printed");
}

void declare(VerbArguments& verb, StatusArguments& given) {
  verb.text("DIR", given.folder, "Result folder, of a run or of one in shards").required();
  verb.flag("--json", given.as_json, "Print JSON");
}

void declare(VerbArguments& verb, BestArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--out", given.out, "Table of best losses; of two losses the lesser is kept").shown();
}

void declare(VerbArguments& verb, ClaimArguments& given) {
  verb.texts("ID", given.names, "Claims, or groups of them (default: all)");
  verb.text("--out", given.out, "Result folder that holds the runs").shown();
  verb.whole("--jobs", given.jobs, "Cells at a time (default: one a core)", kJobs);
  verb.flag("--list", given.is_list, "List the claims, and run nothing");
  verb.flag("--all", given.lists_all, "List every claim, not the first 20");
  verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--no-run", given.no_run, "Judge by the runs that are there");
  verb.flag("--long", given.with_long, "Run also what takes hours");
}

void declare(VerbArguments& verb, ListArguments& given) {
  verb.text("KIND", given.kind, "problems, networks, optimizers, suites or all")
      .one_of({"problems", "networks", "optimizers", "suites", "all"})
      .shown();
  verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--names", given.names_only, "Print names only, one a line");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, DescribeArguments& given) {
  verb.text("NAME", given.name, "A name of `isoline list`, or a spec").required();
  verb.flag("--json", given.as_json, "Print JSON");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, CheckArguments& given) {
  verb.text("SPEC", given.spec, "Problems, as in `isoline run` (default: all)");
  verb.seed("--seed", given.seed, "Seed of the instance and of the directions");
  verb.flag("--json", given.as_json, "Print JSON");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, AuditArguments& given) {
  verb.texts("OPTIMIZER", given.names, "Names of optimizers (default: all)");
  verb.text("--out", given.out, "Folder to write audit.json to, as reports read it");
  verb.flag("--all", given.lists_all, "Print every table whole, not the first 20 lines");
  verb.flag("--json", given.as_json, "Print JSON");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, ValidateArguments& given) {
  verb.texts("PATH", given.paths, "Files, or folders to search for *.json").required();
}

void declare(VerbArguments& verb, TuneArguments& given) {
  verb.text("SPEC,--problem", given.problem,
            "Problems, as in `isoline run`; with --suite those to keep");
  verb.text("--suite", given.suite, "The pairs of this suite, with its budgets");
  verb.text("--optimizer", given.optimizer,
            "Names of optimizers (default: all that have an option to tune)")
      .joined();
  verb.text("--grid", given.grid,
            "Option and its values, low..high x count (default: the option that a method "
            "declares, at seven values around its default and more at an edge)");
  verb.text("--unit", given.unit,
            "Unit of the grid: one, the problem's Cauchy step, or the published rate")
      .one_of({"one", "cauchy", "published"})
      .shown();
  verb.text("--tuning-seeds", given.seeds, "Seeds, apart from those that judge").shown();
  verb.whole("--work", given.work, "Most work of a run");
  verb.whole("--iterations", given.iterations, "Most iterations of a run");
  verb.whole("--jobs", given.jobs, "Runs at a time (default: one a core)", kJobs);
  verb.text("--out", given.folder, "Folder of the records").shown();
  verb.text("--table", given.table, "Table of rates to write or to add to");
  verb.flag("--all", given.lists_all, "List every pair, not the first 20");
  verb.flag("--json", given.as_json, "Print the rows of the table as JSON");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, TrainArguments& given) {
  verb.text("PROBLEM", given.problem, "Problem: 'sine[xi=32]'; mode=learn is implied").required();
  verb.text("--out", given.out, "Where to write it: .json, or any other name for raw numbers")
      .required();
  verb.text("--optimizer", given.optimizer, "Training method").shown();
  verb.whole("--iterations", given.iterations, "Steps of training");
  verb.seed("--seed", given.seed, "Seed of the start and of the samples");
  verb.whole("--threads", given.threads, "Threads of the libraries", kThreads);
  verb.time("--time", given.seconds,
            "Most time of training: 10s, 2m; training that takes twice that is killed");
  verb.memory("--memory", given.memory_bytes, "Most memory (default: 4GB)");
  verb.flag("--quiet", given.quiet, "Show no progress");
  declare_plugins(verb, given.plugins);
}

void declare(VerbArguments& verb, NewArguments& given) {
  verb.text("KIND", given.kind, "problem or optimizer").one_of({"problem", "optimizer"}).required();
  verb.text("NAME", given.name, "Its name: lower-case letters, digits and hyphens").required();
  const Argument& c = verb.flag("--c", given.is_c, "In C, for --plugin");
  verb.flag("--python", given.is_python, "In Python, for process[command=…]").excludes(c);
}

void declare(VerbArguments& verb, InferArguments& given) {
  verb.text("NETWORK", given.network, "File of the trained network").required();
  verb.text("--input", given.input,
            "Observations, one a row: .npy of shape (samples, numbers) or (samples, N, N), or .csv")
      .required();
  verb.text("--output", given.output, "Where to write the inferred x: .npy or .csv").required();
  verb.time("--time", given.seconds, "Most time: 10s, 2m (default: 10m)");
  verb.memory("--memory", given.memory_bytes, "Most memory (default: 4GB)");
}

void declare(VerbArguments& verb, ExportArguments& given) {
  verb.texts("DIR", given.folders, kFolders).required();
  verb.text("--format", given.format,
            "csv: a row a kept point; coco: data folders for its post-processing; bencher: Bencher "
            "Metric Format")
      .one_of({reports::kExportNames.begin(), reports::kExportNames.end()})
      .shown();
  verb.text("--out", given.out, "Where to write: a file; of coco a new folder").required();
}

void declare(VerbArguments& verb, CompletionArguments& given) {
  verb.text("SHELL", given.shell, "bash").one_of({"bash"}).shown();
}

}  // namespace isoline::benchmarks
