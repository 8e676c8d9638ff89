// A run kept on disk while it goes, so that one that was stopped goes on where it was.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "optimizers/optimizer.h"

namespace isoline::benchmarks {

using optimizers::Meter;
using optimizers::Optimizer;

struct DamagedCheckpoint : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Checkpoint {
 public:
  Checkpoint() = default;  // keeps nothing
  // `identity` names the owner of the state: a file of another cell or build is not touched.
  Checkpoint(std::filesystem::path path, std::string identity, double every_seconds);

  // Restores method, meter and θ if there is a state. The method is started. A file that claims to
  // be such a state and is invalid is moved away: DamagedCheckpoint; the arguments are then partly
  // overwritten. The next call finds nothing.
  bool restore(Optimizer& method, Meter& meter, Vector& theta);
  // Writes the state if the last time is long enough ago, or if the process is to stop: then
  // returns true. If the disk refuses, the run continues without.
  bool save_if_due(Optimizer& method, Meter& meter, Vector& theta);

 private:
  void read(std::string bytes, Optimizer& method, Meter& meter, Vector& theta) const;
  void save(Optimizer& method, Meter& meter, Vector& theta) const;
  void set_aside();

  std::filesystem::path path_;
  std::string identity_;
  double every_seconds_ = 0;
  std::int64_t last_nanoseconds_ = 0;
};

}  // namespace isoline::benchmarks
