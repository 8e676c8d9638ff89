// Where a record comes from that this program did not run: a curve of others, by their own claims.
#pragma once

#include <string>

namespace isoline {

struct Imported {
  std::string source;   // who says so: a paper and its figure, a repository, a person
  std::string program;  // what computed it, with its version
  std::string curve;    // the file's name
  std::string sha256;   // of that file
};

}  // namespace isoline
