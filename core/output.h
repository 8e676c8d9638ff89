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

// A device, a pipe or the target of a link is written to, not replaced. UsageError if the name
// belongs to a file without the `mark` of our own such files.
void write_output(const std::filesystem::path& path, std::string_view text, std::string_view mark);
void require_ours(const std::filesystem::path& path, std::string_view mark);

}  // namespace isoline
