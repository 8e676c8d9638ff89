// What the help of the program, and of verbs, says besides their options.
#pragma once

namespace isoline::benchmarks {

inline constexpr const char* kAbout =
    "Isoline compares optimizers on physical inverse problems: every problem of a registry "
    "against\n"
    "every optimizer of a registry, one JSON record a run, and a report.";
inline constexpr const char* kExamples =
    "Examples:\n"
    "  isoline run                        the default suite, then its report\n"
    "  isoline run --problem 'sine[xi=1|32]' --optimizer 'adam[rate=1e-3],ceres-lm' --seeds 5\n"
    "  isoline run quick --optimizer adam     the cells of a suite that have this optimizer\n"
    "  isoline describe sip               formula, options, needs and source\n"
    "  isoline check rosenbrock           are its derivatives right?\n"
    "  isoline audit gd adam sip          scaling, invariance, order: measured\n"
    "  isoline compare results/old results/new    what got worse?\n"
    "  isoline claims notebook            is what the notebook prints reproduced?\n\n"
    "Exit codes: 0 good, 1 wrong usage, 2 worse or failed, 3 better only, 4 not comparable,\n"
    "130 interrupted.";

inline constexpr const char* kReportNotes =
    "Results know 51 tolerances, five a decade from 1 to 1e-10: one between two of them counts as the\n"
    "next stricter one. Work is oracle calls at declared prices, which any machine repeats; cost is\n"
    "the same calls at measured prices. Times mean something of runs with --exclusive: others are\n"
    "marked ≈.";

inline constexpr const char* kCompareNotes =
    "Exit codes: 0 no worse and no better; 2 worse, or NEW lacks a cell of BASE; 3 better only;\n"
    "4 not comparable: a clock ended a cell, its record is in doubt, or it is of another build\n"
    "and --tolerance is not given. Cells are paired by what was asked of them, with seed and\n"
    "budget, so that a changed default is compared, and named.\n"
    "Time is judged where both sides have 9 repetitions (run --repeat 9): Mann-Whitney with\n"
    "Benjamini-Hochberg at 0.05, and the whole 95 % interval of the ratio outside the noise that\n"
    "the repetitions show. Without --time-cells the 20 slowest such cells of BASE are judged.";

inline constexpr const char* kBaselineNotes =
    "A line a cell: status, digest of the trace, final figures, work to 1e-1, 1e-3 and 1e-6.\n"
    "Each cell is run again from starts that differ in the last bit. A cell whose figures then\n"
    "move by more than a tenth of the tolerance of a comparison is chaotic: it is judged by status and\n"
    "by which of 1e-1, 1e-3 and 1e-6 it reaches, so that rounding alone makes nothing worse.\n"
    "Made by the portable preset it means the same on every x86-64-v3 machine:\n"
    "  ISOLINE_PRESET=portable isoline run quick --out results/quick\n"
    "  ISOLINE_PRESET=portable isoline baseline results/quick --out baseline.json\n"
    "  isoline compare baseline.json results/quick";

inline constexpr const char* kReplayNotes =
    "The cell is run in a process of its own, with the problem, options, seed, budget and threads of\n"
    "the record, and written nowhere. A record that a clock or a kill ended is compared up to the last\n"
    "iteration that both have. Exit codes: 0 equal; 2 another result, whose first difference is named;\n"
    "4 not comparable: another build answered, whose parts are named, or the record's component is\n"
    "not there.";

inline constexpr const char* kMergeNotes =
    "Records of the same cell and build become one with the timings of all. Where they differ in\n"
    "anything but timings and provenance the record is left out, the cell is named on standard\n"
    "error, OUT/conflicts.json remembers it, and the exit code is 2; all else is written. To\n"
    "resolve a conflict remove the wrong record, or --force its run, and merge again.";

inline constexpr const char* kBestNotes =
    "Runs measure their targets from the best loss known where a problem declares none. The table\n"
    "is built into the program, and is part of the build that a record names.";

inline constexpr const char* kClaimsNotes =
    "A claim is reproduced where what is measured lies within the source's own error of reading,\n"
    "partly where only the direction holds. --out results/quick judges the runs of a suite.\n"
    "Exit codes: 0 good, 2 a claim is not reproduced or a run failed, 4 none can be compared.";

}  // namespace isoline::benchmarks
