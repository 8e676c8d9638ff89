// Gzipped tar files: written the same to the byte from the same texts, read entry by entry without
// trust in what they say of themselves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isoline {

// Files alone, of mode 0644, of nobody, of no time; the header of gzip names no time either.
class TarWriter {
 public:
  explicit TarWriter(const std::filesystem::path& path);  // UsageError where it cannot be written
  ~TarWriter();
  TarWriter(const TarWriter&) = delete;
  TarWriter& operator=(const TarWriter&) = delete;

  void add(const std::string& name, std::string_view text);
  void close();  // without it the file is not whole

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct TarEntry {
  std::string name;
  bool is_file = false;  // a plain one: no folder, link, device or pipe
};

// Every broken law of the format is a UsageError that names the file.
class TarReader {
 public:
  explicit TarReader(std::filesystem::path path);
  ~TarReader();
  TarReader(const TarReader&) = delete;
  TarReader& operator=(const TarReader&) = delete;

  std::optional<TarEntry> next();
  // More of the entry's bytes, some tens of thousands at most; empty at its end. Holds until the
  // next call.
  std::string_view more();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isoline
