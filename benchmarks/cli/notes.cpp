// Examples and notes of each verb.
#include "benchmarks/cli/notes.h"

#include <map>

namespace isoline::benchmarks {
namespace {

struct Notes {
  const char* examples;
  const char* text = nullptr;
};

constexpr const char* kRun =
    "  isoline run                                  the suite quick, then its report\n"
    "  isoline run notebook --seeds 5 --jobs 4      another suite, on five seeds\n"
    "  isoline run --problem 'sine[xi=1|32],heat' --optimizer 'adam[rate=1e-3],ceres-lm'\n"
    "  isoline run quick --optimizer adam --dry-run     what of it would be run, and how long\n"
    "  isoline run quick --retry failed,crashed     what went wrong, once more\n"
    "  isoline run quick --shard 3/16               a part of it; `isoline merge` unites them\n"
    "  isoline run --problem square --optimizer gd --seeds =3 --in-process     for a debugger";
constexpr const char* kRunNotes =
    "The same command goes on where it was stopped. A cell that crashes costs no other one: each has "
    "a\nprocess of its own, but with --in-process.\n"
    "Exit codes: 0 good, 2 cells failed or records vanished, 130 interrupted.";

constexpr const char* kPlan =
    "  isoline plan quick                           cells, what of them is done, predicted time\n"
    "  isoline plan quick --shards 16 --from results/before     sixteen parts of the same time\n"
    "  isoline plan quick --shards 16 --json        for the matrix of a workflow";
constexpr const char* kPlanNotes =
    "A cell is predicted by what it, or its like with other seeds, took in the records below the\n"
    "result folder and those of --from; else by declared prices times a measured forward solve.\n"
    "With --shards the predictions are written to predicted.json, once: `isoline run --shard` divides\n"
    "the plan by it alone, so that every task finds the same parts whenever it begins.";

constexpr const char* kReport =
    "  isoline report results/quick\n"
    "  isoline report results/a results/b --out report --by cost --tolerance 1e-3";
constexpr const char* kReportNotes =
    "Results know 51 tolerances, five a decade from 1 to 1e-10: one between two of them counts as the\n"
    "next stricter one. Work is oracle calls at declared prices, which any machine repeats; cost is\n"
    "the same calls at measured prices. Times are comparable in runs with --exclusive: others are\n"
    "marked ≈.";

constexpr const char* kCompare =
    "  isoline compare results/old results/new\n"
    "  isoline compare baseline.json results/quick --tolerance 1e-6 --all\n"
    "  isoline compare results/old results/new --markdown     for the summary of a job";
constexpr const char* kCompareNotes =
    "Exit codes: 0 no worse and no better; 2 worse, or NEW lacks a cell of BASE; 3 better only;\n"
    "4 not comparable: a clock ended a cell, its record is in doubt, or it is of another build\n"
    "and --tolerance is not given. Cells are paired by what was asked of them, with seed and\n"
    "budget, so that a changed default is compared, and named.\n"
    "Time is judged where both sides have 9 repetitions (run --repeat 9): Mann-Whitney with\n"
    "Benjamini-Hochberg at 0.05, and the whole 95 % interval of the ratio outside the noise that\n"
    "the repetitions show. Without --time-cells the 20 slowest such cells of BASE are judged.";

constexpr const char* kBaseline =
    "  isoline baseline results/quick --out baseline.json\n"
    "  isoline compare baseline.json results/quick";
constexpr const char* kBaselineNotes =
    "A line a cell: status, digest of the trace, final figures, work to 1e-1, 1e-3 and 1e-6.\n"
    "Each cell is run again from starts that differ in the last bit. A cell whose figures then\n"
    "move by more than a tenth of the tolerance of a comparison is chaotic: it is judged by status and\n"
    "by which of 1e-1, 1e-3 and 1e-6 it reaches, so that rounding alone makes nothing worse.\n"
    "Runs of the portable preset (ISOLINE_PRESET=portable) give the same baseline on every\n"
    "x86-64-v3 machine.";

constexpr const char* kReplayNotes =
    "The cell is run in a process of its own, with the problem, options, seed, budget and threads of\n"
    "the record, and written nowhere. A record that a clock or a kill ended is compared up to the last\n"
    "iteration that both have. Exit codes: 0 equal; 2 another result, whose first difference is named;\n"
    "4 not comparable: another build answered, whose parts are named, or the record's component is\n"
    "not there.";

constexpr const char* kMergeNotes =
    "Records of the same cell and build become one with the timings of all. Where they differ in\n"
    "anything but timings and provenance nothing is written, the cells are named on standard error,\n"
    "the optimizer with most of them first, and the exit code is 2. Remove the wrong records, or\n"
    "--force their runs, and merge again.";

constexpr const char* kSubmit =
    "  isoline submit --slurm --array 16 --time 2h -- quick --seeds 20      prints two jobs\n"
    "  isoline submit --slurm --partition long --yes -- sip-paper           submits them";
constexpr const char* kSubmitNotes =
    "The first job is an array with a task a shard, the second merges and reports when all have ended.\n"
    "The program, the kernels of its libraries and the predictions that divide the plan are kept in\n"
    "the result folder, which all nodes must see. A task that the scheduler stops keeps the state of\n"
    "its cells, goes back into the queue and goes on.\n"
    "Exit codes: 0 good, 1 wrong usage, 2 the scheduler refused.";

constexpr const char* kStatusNotes =
    "It reads the records alone, with the plan and the predictions beside them, and starts nothing.\n"
    "Exit codes: 0 good so far, 2 cells failed.";

constexpr const char* kBestNotes =
    "Runs measure their targets from the best loss known where a problem declares none. The table\n"
    "is built into the program, and is part of the build that a record names.";

constexpr const char* kClaims =
    "  isoline claims --list                        what is claimed, and where\n"
    "  isoline claims exponential                   one group of claims\n"
    "  isoline claims sip-better-in-x-worse-in-loss     one claim, with all that decides it\n"
    "  isoline claims --no-run --out results/quick      what the runs of a suite decide";
constexpr const char* kClaimsNotes =
    "A claim is reproduced where what is measured lies within the source's own error of reading,\n"
    "partly where only the direction holds.\n"
    "Exit codes: 0 good, 2 a claim is not reproduced or a run failed, 4 none can be compared.";

constexpr const char* kNew =
    "  isoline new problem my-chain                 problems/my_chain.cpp, for a program of your own\n"
    "  isoline new optimizer my-method --c          my_method.c, for a library\n"
    "  isoline new problem my-simulator --python    my_simulator.py, for a process";
constexpr const char* kNewNotes =
    "What it writes builds and passes its checks as it is; nothing is overwritten. Beside it goes what\n"
    "it is built with, where that is missing: CMakeLists.txt, or isoline.h.";

constexpr const char* kTune =
    "  isoline tune rosenbrock,heat --optimizer gd,adam --table rates.json\n"
    "  isoline tune square --optimizer gd --grid rate=1e-3..1x7 --unit cauchy\n"
    "  isoline tune --suite quick --optimizer adam --json";
constexpr const char* kTuneNotes =
    "The best value has the least median work to the target; of equals the one that leaves least, "
    "then\nthe one nearest to the default. Values that tie with the best and a best value at the edge of "
    "its\ngrid are named.";

constexpr const char* kExport =
    "  isoline export results/quick --out curves.csv             a row a kept point of each run\n"
    "  isoline export results/quick --format coco --out exdata   for COCO's post-processing\n"
    "  isoline export results.tar.gz --format bencher --out metrics.json";
constexpr const char* kExportNotes =
    "Numbers read back as the same numbers; inf, -inf and nan are written so. Bencher's format has no\n"
    "infinity: what half of the runs never reach is left out there, and reached-1e-6 tells how many do.";

const std::map<std::string_view, Notes>& notes() {
  static const std::map<std::string_view, Notes> all = {
      {"run", {kRun, kRunNotes}},
      {"plan", {kPlan, kPlanNotes}},
      {"report", {kReport, kReportNotes}},
      {"compare", {kCompare, kCompareNotes}},
      {"baseline", {kBaseline, kBaselineNotes}},
      {"replay",
       {"  isoline replay results/quick/runs/03a4d51c22cbf199-821e62446af5cbbe.json",
        kReplayNotes}},
      {"merge", {"  isoline merge results/a results/b --out results/both", kMergeNotes}},
      {"submit", {kSubmit, kSubmitNotes}},
      {"status",
       {"  isoline status results/quick\n  isoline status results/quick --json", kStatusNotes}},
      {"best", {"  isoline best results/quick --out benchmarks/best.json", kBestNotes}},
      {"claims", {kClaims, kClaimsNotes}},
      {"list", {"  isoline list\n  isoline list optimizers --names"}},
      {"describe", {"  isoline describe sip\n  isoline describe 'sine[xi=32]' --json"}},
      {"check", {"  isoline check rosenbrock\n  isoline check 'poisson[N=8|16]' --seed 3"}},
      {"audit", {"  isoline audit gd adam sip\n  isoline audit --out results/quick --all"}},
      {"new", {kNew, kNewNotes}},
      {"validate", {"  isoline validate results/quick my-suite.json"}},
      {"tune", {kTune, kTuneNotes}},
      {"train", {"  isoline train 'sine[xi=32]' --optimizer sip --iterations 1000 --out net.json"}},
      {"infer", {"  isoline infer net.json --input observed.csv --output x.csv"}},
      {"export", {kExport, kExportNotes}},
      {"completion", {"  isoline completion bash > ~/.isoline-completion"}},
      {"help", {"  isoline help\n  isoline help run"}},
      {"version", {"  isoline version"}}};
  return all;
}

}  // namespace

std::string notes_of(std::string_view verb) {
  const Notes& found = notes().at(verb);
  const std::string text = std::string("Examples:\n") + found.examples;
  return found.text == nullptr ? text : text + "\n\n" + found.text;
}

}  // namespace isoline::benchmarks
