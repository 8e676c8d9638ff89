// Files read whole, and written whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isoline {

std::string read_text(const std::filesystem::path& path);  // UsageError where it cannot be read

// By a temporary file, fsync and rename: whoever looks finds the old file or the new one.
void write_text(const std::filesystem::path& path, std::string_view text);

// For many files of a folder that has no name yet: each is written without a flush, and one flush
// of them all comes before the folder gets its name. Both throw where the disk says no.
void write_unflushed(const std::filesystem::path& path, std::string_view text);
void flush_all(const std::filesystem::path& folder);

}  // namespace isoline
