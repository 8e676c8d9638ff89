// Which of several files of fields belongs to the record that is kept.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace isoline::benchmarks {

// What the union of the records beside a file "CELL-BUILD.npy" of several folders names as its
// digest; "" where it names none.
std::string digest_of_fields(const std::vector<std::filesystem::path>& folders,
                             const std::filesystem::path& name);

}  // namespace isoline::benchmarks
