// isoline_records FOLDER: writes a result folder of invented records, to hold `isoline report` and
// its like to their bar: a hundred thousand records of 64 points and 12 columns, unless told else.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tests/reports/synthetic.h"

int main(int argc, char** argv) {
  CLI::App app("Write a result folder of invented records");
  isoline::reports::SyntheticSize size;
  std::string folder;
  app.add_option("FOLDER", folder, "The new result folder")
      ->required()
      ->check(CLI::NonexistentPath);
  app.add_option("--problems", size.problems)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--optimizers", size.optimizers)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seeds", size.seeds)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--points", size.points, "Kept points of each curve")
      ->check(CLI::Range(1, 165))
      ->capture_default_str();
  app.add_option("--random-seed", size.random_seed, "Of all that is drawn")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  isoline::reports::write_synthetic_study(folder, size);
  fmt::print("{} records in {}\n", size.records(), folder);
}
