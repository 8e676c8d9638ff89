// The execution of a plan, which `run`, `claims` and `tune` share, and the checks of its components
// before they run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/plan/rates.h"
#include "benchmarks/run/runner.h"
#include "benchmarks/run/store.h"
#include "core/records/request.h"

namespace isoline::benchmarks {

// UsageError with the first component's complaint, before anything is written. Each is made in a
// process of its own: what crashes there is left to its cells to report.
void require_sound(const Catalog& catalog, const std::vector<Request>& requests);

// FOLDER/rates.json, schema isoline.rates/1: a row for each problem and optimizer as they were run,
// with the name of its table. The rows of earlier plans stay; none, no file. A
// damaged file is set aside.
void write_used_rates(const Rates& rates, const std::vector<Request>& requests, Store& store);

// The plan that is stored, which may be more than is run.
struct WholePlan {
  std::string name;
  std::vector<PlannedCell> cells;
  Rates rates = {};
};

// UsageError, and nothing written, if a component of the plan cannot be created, or a problem of
// another program fails its checks (with --uncertified, none is checked). Otherwise
// stores the plan before anything runs, so that a part never passes for the complete plan; then the
// rates that it uses and the component metadata; then runs the cells. Stores the plan again if
// records have disappeared meanwhile: the folder may have been emptied.
Outcome run_plan(const Catalog& catalog, const WholePlan& whole, std::vector<Request> requests,
                 const std::filesystem::path& folder, const RunOptions& options);
Outcome run_plan(const Catalog& catalog, const std::string& name,
                 const std::vector<Request>& requests, const std::filesystem::path& folder,
                 const RunOptions& options, const Rates& rates = {});

std::vector<PlannedCell> planned_cells(const std::vector<Request>& requests);

// A folder name that says what is planned and differs where the cells do:
// "square-rosenbrock-gd-1a2b3c4d". `title` opens it where there is one.
std::string folder_name_of(const std::vector<Request>& requests, const std::string& title = "");

}  // namespace isoline::benchmarks
