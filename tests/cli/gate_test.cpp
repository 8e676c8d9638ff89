// The gate of this repository on runs of the built program: each planted fault fails it, with one
// line that names the cause.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/records/record.h"
#include "core/status.h"
#include "tests/cli/shell.h"
#include "tests/reports/true_record.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

const std::string kRun = "./isoline run --problem square,brown-dennis --iterations 20 --no-report ";

// A baseline of adam, gd and newton on two problems, and the same results beside it.
class PlantedFault : public testing::Test {
 protected:
  void SetUp() override {
    shell.expect(kRun + "--optimizer adam,gd,newton --out new");
    shell.expect("./isoline baseline new --perturbations 1 --out base.json");
    shell.expect("./isoline validate base.json");
  }

  Finished gate(const Expected& expected) const {
    return shell.expect("ISOLINE=./isoline BASELINE=base.json bash " ISOLINE_SOURCE_DIR
                        "/.ci/compare new",
                        expected);
  }

  // Every record of an optimizer as a changed program would have written it.
  void change_records(const std::string& optimizer, const std::function<void(Record&)>& edit) {
    std::vector<Record> records;
    for (const auto& entry : fs::directory_iterator(runs)) {
      Record record = read_record(entry.path());
      if (record.request.optimizer.name != optimizer) continue;
      fs::remove(entry.path());
      records.push_back(std::move(record));
    }
    ASSERT_EQ(records.size(), 2U);
    for (Record& record : records) {
      edit(record);
      record.cell = cell_digest(record.request);
      write_text(runs / record.file_name(), to_json(record).dump());
    }
  }

  // It fails, and the last line on standard error is the cause.
  void expect_fault(int exit_code, const std::string& cause) {
    const Finished result = gate({.exit_code = exit_code});
    const std::size_t last = result.err.rfind('\n', result.err.size() - 2);
    const std::string line = result.err.substr(last == std::string::npos ? 0 : last + 1);
    EXPECT_TRUE(contains(line, cause)) << result.err;
    EXPECT_EQ(read_text(shell.folder() / "new/comparison.md"), result.out);
  }

  Shell shell;
  fs::path runs = shell.folder() / "new" / "runs";
};

TEST_F(PlantedFault, NoneLetsTheSameResultsPass) { gate({.out = {"Comparison: equal"}}); }

TEST_F(PlantedFault, InADefaultFailsTheGate) {
  change_records("adam", [](Record& record) {
    record.request.optimizer.options.set("epsilon", 1e-2);  // from 1e-8
    end_at(record, 1.5 * record.summary.loss);
    record.build_parts["optimizer"] = "0123456789abcdef";
    record.build = "fedcba9876543210";
  });
  expect_fault(kWorse,
               "worse: adam: default of epsilon 1e-8 → 0.01 (2 cells); 2 cells of adam on ");
  gate({.exit_code = kWorse, .out = {"another source of the optimizer (2 cells of adam on "}});
}

TEST_F(PlantedFault, InAFormulaFailsTheGate) {
  change_records("gd", [](Record& record) { end_at(record, record.summary.loss * (1 + 1e-5)); });
  expect_fault(kWorse, "worse: 2 cells of gd on ");
}

TEST_F(PlantedFault, AMissingOptimizerFailsTheGate) {
  fs::remove_all(shell.folder() / "new");
  ASSERT_EQ(shell(kRun + "--optimizer adam,gd --out new").exit_code, 0);
  expect_fault(kWorse, "worse: NEW lacks 2 cells of newton on ");
  write_text(shell.folder() / "allowed.json",
             R"({"schema": "isoline.allowed/1",
                 "cells": [{"optimizer": "newton", "reason": "it moved out"}]})");
  shell.expect("./isoline compare base.json new --tolerance 1e-6 --allow allowed.json");
}

TEST_F(PlantedFault, ACellThatAClockCutFailsTheGate) {
  change_records("newton", [](Record& record) { record.is_nondeterministic = true; });
  expect_fault(kNotComparable, "a clock or a kill ended it in NEW");
}

TEST_F(PlantedFault, BetterResultsPass) {
  change_records("gd", [](Record& record) { end_at(record, record.summary.loss * 0.5); });
  gate({.out = {"Comparison: better, nothing worse"}});
}

TEST_F(PlantedFault, InARecordIsFoundByValidate) {
  const fs::path file = fs::directory_iterator(runs)->path();
  Record record = read_record(file);
  end_at(record, 2 * record.summary.loss);
  write_text(runs / "copy.json", to_json(record).dump());
  shell.expect(
      "./isoline validate new",
      {.exit_code = 2, .out = {"is of the same cell and build and differs at /curve/loss/"}});
  fs::remove(runs / "copy.json");
  shell.expect("./isoline validate new");
  record.request.seed = 77;
  write_text(file, to_json(record).dump());
  shell.expect("./isoline validate new", {.exit_code = 2, .out = {"its cell is "}});
}

}  // namespace
}  // namespace isoline::benchmarks
