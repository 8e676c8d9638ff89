// Files that a user names with --out, and files that the system does not open.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/errors.h"

namespace isoline {

// The system refuses to open a file that may be sound: another user's, too many open files.
struct AccessError : UsageError {
  using UsageError::UsageError;
};

// Creates a folder that a user named, and those above it. UsageError if that fails, or if it cannot
// be written to.
void make_output_folder(const std::filesystem::path& folder);

// Creates the folder of the file. A device, a pipe or the target of a link is written to, not
// replaced. UsageError if the name belongs to a file without the `mark` of our own such files.
void write_output(const std::filesystem::path& path, std::string_view text, std::string_view mark);
void require_ours(const std::filesystem::path& path, std::string_view mark);

}  // namespace isoline
