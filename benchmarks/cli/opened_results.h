// Result folders as a user names them: an archive stands for the folder it was made of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "benchmarks/archive/unpack.h"

namespace isoline::benchmarks {

class OpenedResults {
 public:
  // UsageError where one is an archive that is not sound.
  explicit OpenedResults(const std::vector<std::string>& given);

  const std::vector<std::string>& folders() const { return folders_; }
  // A text that names these folders, by the names that the user gave.
  std::string by_given_names(std::string text) const;

 private:
  std::vector<std::string> given_, folders_;
  std::vector<std::unique_ptr<UnpackedArchive>> archives_;
};

}  // namespace isoline::benchmarks
