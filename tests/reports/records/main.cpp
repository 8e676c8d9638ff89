// isoline_records FOLDER [PROBLEMS [OPTIMIZERS [SEEDS]]]: writes a result folder of synthetic
// records, to measure the time and memory of `isoline report` and similar commands.
#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <string>

#include "core/errors.h"
#include "tests/reports/synthetic.h"

int main(int argc, char** argv) {
  using isoline::UsageError;
  try {
    if (argc < 2 || argc > 5)
      throw UsageError("usage: isoline_records FOLDER [PROBLEMS [OPTIMIZERS [SEEDS]]]");
    if (std::filesystem::exists(argv[1]))
      throw UsageError(fmt::format("{} is there already", argv[1]));
    isoline::reports::SyntheticSize size;
    std::size_t* const counts[] = {&size.problems, &size.optimizers, &size.seeds};
    for (int i = 2; i < argc; ++i) *counts[i - 2] = std::stoul(argv[i]);
    write_synthetic_study(argv[1], size);
    fmt::print("{} records in {}\n", size.records(), argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
