// The origin of a record: the program, its build and the machine, stored once for all records of a
// build; and the run, which each record states itself.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isoline {

// Empty, or 0, where a record does not say.
struct Build {
  std::string version, commit;
  std::optional<bool> is_dirty;
  std::string isoline_commit;  // of Isoline itself, where the program was built elsewhere
  std::string compiler, build_type, flags, instruction_set;
  std::string processor;                            // its brand, by CPUID
  std::vector<std::string> processor_features;      // by CPUID
  std::string kernel, kernel_chosen_by;             // OpenBLAS'
  std::map<std::string, std::int64_t> cache_bytes;  // that Eigen blocks its products by
  std::int64_t cores = 0;
  std::string system;
  std::map<std::string, std::string> libraries;
};

struct RunProvenance {
  std::string started;  // "2026-11-21T06:45:42Z"
  std::int64_t concurrent_jobs = 0;
  std::optional<bool> is_exclusive;
  std::string command;

  bool operator==(const RunProvenance&) const = default;
  // Nothing else ran beside it, as far as it is known.
  bool is_timed_alone() const { return is_exclusive.value_or(false) || concurrent_jobs <= 1; }
};

struct Provenance {
  Provenance();
  Provenance(std::shared_ptr<const Build> of, RunProvenance at)
      : build(std::move(of)), run(std::move(at)) {}
  explicit Provenance(Build of) : build(std::make_shared<const Build>(std::move(of))) {}

  std::shared_ptr<const Build> build;  // never null; one object for all that a thread reads
  RunProvenance run;
};

std::string version();  // "0.1.0"

// The provenance of this program, read once.
const std::shared_ptr<const Build>& this_build();

// For a program built elsewhere, before it reads its build: records name the commit of its own
// tree, and Isoline's beside it.
void set_program_tree(std::string commit, bool is_dirty);

// Digest of the platform: compiler, flags, instruction set, kernels, caches, and the libraries that
// compute.
const std::string& platform_digest();

}  // namespace isoline
