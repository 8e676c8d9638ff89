// A group of the kernel's own (cgroup v2), where this process may make one: what is in it is killed
// at once, however fast it multiplies.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace isoline::benchmarks {

class ControlGroup {
 public:
  // Below the control group of this process; nothing where there is none that may be divided.
  static std::unique_ptr<ControlGroup> make(std::uint64_t mark);
  ~ControlGroup();  // it is empty by then
  ControlGroup(const ControlGroup&) = delete;
  ControlGroup& operator=(const ControlGroup&) = delete;

  void take(pid_t process) const;  // and all that it starts from then on
  void kill() const;

 private:
  explicit ControlGroup(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path folder_;
};

}  // namespace isoline::benchmarks
