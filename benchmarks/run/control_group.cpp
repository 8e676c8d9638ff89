// Control groups by the files of cgroup v2 (Linux, Documentation/admin-guide/cgroup-v2.rst).
#include "benchmarks/run/control_group.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "isoline-";

// "… MOUNT-POINT … - cgroup2 …" of /proc/self/mountinfo.
std::optional<fs::path> mount_point() {
  std::ifstream in("/proc/self/mountinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.find(" - cgroup2 ") == std::string::npos) continue;
    std::istringstream words(line);
    std::string skipped, point;
    words >> skipped >> skipped >> skipped >> skipped >> point;
    return point;
  }
  return std::nullopt;
}

// "0::/user.slice/…" of /proc/self/cgroup.
std::optional<fs::path> own_folder() {
  const auto point = mount_point();
  if (!point) return std::nullopt;
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("0::/")) return *point / line.substr(4);
  return std::nullopt;
}

bool write_line(const fs::path& path, const std::string& line) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool is_written = write(file, line.data(), line.size()) >= 0;
  close(file);
  return is_written;
}

// What a program that was killed left behind; the kernel keeps any in which somebody lives.
void remove_empty_ones(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().filename().string().starts_with(kPrefix)) rmdir(at->path().c_str());
}

}  // namespace

std::unique_ptr<ControlGroup> ControlGroup::make(std::uint64_t mark) {
  static const std::optional<fs::path> own = own_folder();
  if (!own) return nullptr;
  remove_empty_ones(*own);
  const fs::path folder = *own / fmt::format("{}{:x}", kPrefix, mark);
  std::error_code error;
  if (!fs::create_directory(folder, error)) return nullptr;
  std::unique_ptr<ControlGroup> made(new ControlGroup(folder));
  if (access((folder / "cgroup.kill").c_str(), W_OK) != 0) return nullptr;  // before Linux 5.14
  return made;
}

ControlGroup::~ControlGroup() { rmdir(folder_.c_str()); }

void ControlGroup::take(pid_t process) const {
  write_line(folder_ / "cgroup.procs", std::to_string(process));
}

void ControlGroup::kill() const { write_line(folder_ / "cgroup.kill", "1"); }

}  // namespace isoline::benchmarks
