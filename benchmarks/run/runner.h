// Runs requests in worker processes, several at once, and stores a record of each as it ends.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/outcome.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/store.h"

namespace isoline::benchmarks {

struct RunOptions {
  int jobs = 1;
  bool force = false;           // repeat cells that are done
  bool reuse = false;           // a cell that another build has done counts as done
  std::set<Status> retry = {};  // cells that ended so are repeated
  bool exclusive = false;       // one at a time, for tables of wall time
  int repeat = 1;               // timings wanted of each cell
  Limits limits;
  double checkpoint_seconds = 120;  // how often a long run is kept on disk while it goes
  int perturbation = 0;  // of the starts, in the last bit; of 0 alone the records are results
  Progress::Style progress = Progress::Style::silent;
  bool keeps_output = false;   // of cells, in their records
  bool keeps_fields = false;   // of every seed; else those of seed 0
  bool keeps_spectra = false;  // a record without them is made anew
  std::string command;         // for the record

  // Whether a record that is there, if one is, stands in nobody's way.
  bool redoes(const std::optional<Record>& done) const {
    return force || (done && (retry.contains(done->status) || lacks_spectrum(*done)));
  }

 private:
  bool lacks_spectrum(const Record& done) const {
    return keeps_spectra && !done.spectrum && !is_failure(done.status) &&
           done.status != Status::inapplicable;
  }
};

// Runs the requests that the store has no record of, and no more. Several processes may run into
// one folder: each cell is done by one of them.
Outcome run_all(const Catalog& catalog, const std::vector<Request>& requests, Store& store,
                const RunOptions& options);

int one_a_core();  // how many cells at a time a machine is meant for

}  // namespace isoline::benchmarks
