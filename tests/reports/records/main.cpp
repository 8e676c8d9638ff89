// isoline_records FOLDER [SIZE]: writes a result folder of invented records, to hold
// `isoline report` and its like to their bar. SIZE is a spec such as 'size[problems=64,seeds=5]'.
#include <fmt/format.h>

#include <exception>

#include "core/spec.h"
#include "tests/reports/synthetic.h"

namespace isoline::reports {
namespace {

struct Options {
  Index problems = 100, optimizers = 50, seeds = 20, points = 64;
};

void fields(Options& o, auto& field) {
  field("problems", o.problems, between(1, 1e6), "problems");
  field("optimizers", o.optimizers, between(1, 1e6), "optimizers");
  field("seeds", o.seeds, between(1, 1e6), "seeds of each pair");
  field("points", o.points, between(1, 165), "kept points of each curve");
}

SyntheticSize size_of(const char* spec) {
  const OptionValues given = options_of(parse_spec(spec));
  const auto options =
      read_options<Options>(complete_options(option_table<Options>(), "size", given));
  return {.problems = static_cast<std::size_t>(options.problems),
          .optimizers = static_cast<std::size_t>(options.optimizers),
          .seeds = static_cast<std::size_t>(options.seeds),
          .points = static_cast<std::size_t>(options.points)};
}

}  // namespace
}  // namespace isoline::reports

int main(int argc, char** argv) {
  using namespace isoline::reports;
  try {
    if (argc < 2 || argc > 3)
      throw isoline::UsageError("usage: isoline_records FOLDER ['size[problems=100]']");
    if (std::filesystem::exists(argv[1]))
      throw isoline::UsageError(fmt::format("{} is there already", argv[1]));
    const SyntheticSize size = argc == 3 ? size_of(argv[2]) : SyntheticSize{};
    write_synthetic_study(argv[1], size);
    fmt::print("{} records in {}\n", size.records(), argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
