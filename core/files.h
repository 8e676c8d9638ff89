// Files read whole, and written whole or not at all. What stands under a name may be anything: a
// pipe that never ends, a device, a link in a circle. Only regular files of a bounded size are
// read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace isoline {

inline constexpr std::size_t kMostBytes = std::size_t{2} << 30;  // of any file that is read whole

enum class Links { followed, refused };  // symbolic ones, as the last part of a path

// UsageError, which says why, where it cannot be read: never waits, never reads on without end.
std::string read_text(const std::filesystem::path& path, std::size_t most_bytes = kMostBytes,
                      Links links = Links::followed);

// Whether anything stands under that name, be it a link that leads nowhere.
bool is_there(const std::filesystem::path& path);

// The names of what stands in a folder, sorted, whatever it is; none where there is no such folder.
// UsageError where it cannot be listed.
std::vector<std::string> names_in(const std::filesystem::path& folder);

// Through a temporary file, fsync and rename: readers see either the old file or the new one.
void write_text(const std::filesystem::path& path, std::string_view text);

// The name that a file has while this process writes it, "record.json.9c1d52aa-4711.tmp": of the
// machine and the process.
std::filesystem::path temporary_of(const std::filesystem::path& path);

// Whether a path is a regular file of such a name, left by a process of this machine that is gone.
// Files of another machine in a shared folder never count as abandoned.
bool is_abandoned(const std::filesystem::path& path);

// Moves what stands under a name into a folder, beside what is there already: "plan.json.2" where
// "plan.json" is taken. Where it now stands; UsageError where it cannot be moved.
std::filesystem::path move_into(const std::filesystem::path& folder,
                                const std::filesystem::path& path);

// For many files of a folder that has no name yet: each is written without a flush, and one flush
// of them all comes before the folder gets its name. Both throw where the disk says no.
void write_unflushed(const std::filesystem::path& path, std::string_view text);
void flush_all(const std::filesystem::path& folder);

// FNV-1a, 64 bits (Fowler, Noll, Vo): names files by what they hold and keys random streams.
inline constexpr std::uint64_t kDigestStart = 0xcbf29ce484222325;

constexpr std::uint64_t fnv1a(std::string_view text, std::uint64_t state = kDigestStart) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  for (const char letter : text) state = (state ^ static_cast<unsigned char>(letter)) * kPrime;
  return state;
}

std::string digest(std::string_view text);  // as 16 hexadecimal digits

// A private folder in the temporary folder that goes with its scope, and all that is in it.
// UsageError where it cannot be made.
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

}  // namespace isoline
