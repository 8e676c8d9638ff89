// JSON with numbers that survive, files written whole, and the digest.
#include "core/json.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/errors.h"

namespace isoline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what, const fs::path& path) {
  throw std::runtime_error(fmt::format("cannot {} {}: {}", what, path.string(), strerror(errno)));
}

void write_all(int file, std::string_view text, const fs::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

Json json_number(Real value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Real real_of(const Json& value) {
  if (value.is_number()) return value.get<Real>();
  const std::string text = value.is_string() ? value.get<std::string>() : "";
  if (text == "nan") return std::nan("");
  if (text == "inf") return INFINITY;
  if (text == "-inf") return -INFINITY;
  throw UsageError(fmt::format("expected a number, got {}", value.dump()));
}

Json json_numbers(const Real* values, std::size_t count) {
  Json list = Json::array();
  for (std::size_t i = 0; i < count; ++i) list.push_back(json_number(values[i]));
  return list;
}

std::string read_text(const fs::path& path) {
  constexpr std::size_t kChunk = 1 << 16;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string text;
  ssize_t count = file < 0 ? -1 : 1;
  while (count > 0) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    while ((count = ::read(file, text.data() + size, kChunk)) < 0 && errno == EINTR) continue;
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  if (file >= 0) ::close(file);
  if (count < 0) throw UsageError(fmt::format("cannot read {}", path.string()));
  return text;
}

void write_text(const fs::path& path, std::string_view text) {
  const fs::path temporary = path.string() + fmt::format(".{}.tmp", ::getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail("create", temporary);
  try {
    write_all(file, text, temporary);
    if (::fsync(file) != 0) fail("flush", temporary);
  } catch (...) {
    ::close(file);
    ::unlink(temporary.c_str());
    throw;
  }
  ::close(file);
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    errno = reason;
    fail("rename to", path);
  }
}

Json parse_json(const std::string& text, const std::string& origin) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw UsageError(fmt::format("{} is no JSON: {}", origin, error.what()));
  }
}

Json read_json(const fs::path& path) { return parse_json(read_text(path), path.string()); }

void write_json(const fs::path& path, const Json& value) { write_text(path, value.dump(1) + "\n"); }

std::string digest(std::string_view text) { return fmt::format("{:016x}", fnv1a(text)); }

}  // namespace isoline
