// What the help of the program, and of each verb, says besides the options.
#pragma once

#include <string>
#include <string_view>

namespace isoline::benchmarks {

inline constexpr const char* kAbout =
    "Isoline compares optimizers on physical inverse problems: every problem of a registry "
    "against\n"
    "every optimizer of a registry, one JSON record a run, and a report.";
inline constexpr const char* kExamples =
    "Examples:\n"
    "  isoline run                            the default suite, then its report\n"
    "  isoline run --problem 'sine[xi=1|32]' --optimizer 'adam[rate=1e-3],ceres-lm' --seeds 5\n"
    "  isoline run quick --optimizer adam     the cells of a suite that have this optimizer\n"
    "  isoline describe sip                   formula, options, needs and source\n"
    "  isoline check rosenbrock               are its derivatives right?\n"
    "  isoline audit gd adam sip              scaling, invariance, order: measured\n"
    "  isoline compare results/old results/new    what is worse than before?\n"
    "  isoline claims notebook                is what the notebook prints reproduced?\n"
    "  isoline help run                       the options of a verb, with examples\n\n"
    "Exit codes: 0 good, 1 wrong usage, 2 worse or failed, 3 better only, 4 not comparable,\n"
    "130 interrupted.";

// Examples of the verb, then what must be known of it; "isoline …" begins each example's line.
std::string notes_of(std::string_view verb);

}  // namespace isoline::benchmarks
