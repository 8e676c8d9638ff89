// The processor as this process reads it, by its own CPUID instruction: under an emulator that is
// the emulated one, where the system's files tell of the host.
#pragma once

#include <string>
#include <vector>

namespace isoline {

struct Processor {
  std::string brand;                  // "Intel(R) Xeon(R) Processor"
  std::vector<std::string> features;  // vector instructions, named as Linux names them

  bool has(const std::string& feature) const;
};

// Read once. A feature counts where the system keeps its registers too.
const Processor& processor();

}  // namespace isoline
