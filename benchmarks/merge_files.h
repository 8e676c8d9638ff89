// How a merge writes many files: unflushed until all are there, and shared among threads.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace isoline {

// Without a flush of each: the folder gets its name only after one of all.
void save(const std::filesystem::path& path, const std::string& text);
void flush(const std::filesystem::path& folder);

void share(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace isoline
