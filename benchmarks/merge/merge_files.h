// How a merge writes many files: unflushed until all are there.
#pragma once

#include <filesystem>
#include <string>

namespace isoline::benchmarks {

// Without a flush of each: the folder gets its name only after one of all.
void save(const std::filesystem::path& path, const std::string& text);
void flush(const std::filesystem::path& folder);

}  // namespace isoline::benchmarks
