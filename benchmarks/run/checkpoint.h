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
  // `identity` says whose state it is: a file of another cell or build is left alone.
  Checkpoint(std::filesystem::path path, std::string identity, double every_seconds);

  // Brings back method, meter and θ where there is something to go on with. The method is started.
  // A file that says it is that, and is not, is set aside: DamagedCheckpoint, and what was given
  // holds parts of it. The next call finds nothing.
  bool restore(Optimizer& method, Meter& meter, Vector& theta);
  // Writes the state if the last time is long enough ago, or if the process was asked to stop: then
  // true. Where the disk refuses, the run goes on without.
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
