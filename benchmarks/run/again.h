// Cells of records asked for again, and run where nobody finds what comes of it.
#pragma once

#include <filesystem>

#include "benchmarks/plan/catalog.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

// What the record asked for, of the components that this program has: UsageError where it has them
// no more, or they have other options. Its cell is the one that this program asks for.
Request request_again(const Catalog& catalog, const Record& record, double hard_seconds);

// A result folder that goes with its scope: its records have the cells of others.
class HiddenFolder {
 public:
  HiddenFolder();
  ~HiddenFolder();
  HiddenFolder(const HiddenFolder&) = delete;
  HiddenFolder& operator=(const HiddenFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace isoline::benchmarks
