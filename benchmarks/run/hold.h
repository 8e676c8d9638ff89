// Which cells of a result folder a run is doing, told to the other runs in it.
#pragma once

#include <filesystem>
#include <string>

namespace isoline::benchmarks {

// Locks on one file of the folder, a byte a cell. The system takes them back the moment that their
// process ends, however it ends, so that none is ever left behind; and no process started by it
// shares them. Where a file system knows no locks each run does all cells: work is then done twice,
// and nothing is lost. One object a folder and process: closing the file drops all of its locks.
class Holds {
 public:
  explicit Holds(const std::filesystem::path& folder);
  ~Holds();
  Holds(const Holds&) = delete;
  Holds& operator=(const Holds&) = delete;

  bool take(const std::string& cell);  // false while another process has it
  void release(const std::string& cell);

 private:
  int descriptor_;
};

// How many cells of a result folder runs of other processes are doing just now, as far as its file
// system tells; 0 where there is nothing to look at.
std::size_t held_cells(const std::filesystem::path& folder);

}  // namespace isoline::benchmarks
