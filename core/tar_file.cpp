// The one door to libarchive, which is told to write and read this one format and no other.
#include "core/tar_file.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <array>

#include "core/errors.h"

namespace isoline {
namespace {

constexpr std::size_t kBlock = 1 << 16;

struct FreeWriter {
  void operator()(archive* of) const { archive_write_free(of); }
};
struct FreeReader {
  void operator()(archive* of) const { archive_read_free(of); }
};
struct FreeEntry {
  void operator()(archive_entry* entry) const { archive_entry_free(entry); }
};

// Warnings of the library are no less than errors: what it doubts is not what we wrote.
void require_good(int code, archive* of, const std::filesystem::path& path) {
  require(code == ARCHIVE_OK, [&] {
    const char* why = archive_error_string(of);
    return fmt::format("{}: {}", path.string(), why == nullptr ? "not to be used" : why);
  });
}

}  // namespace

struct TarWriter::State {
  std::filesystem::path path;
  std::unique_ptr<archive, FreeWriter> file{archive_write_new()};

  void check(int code) const { require_good(code, file.get(), path); }
};

TarWriter::TarWriter(const std::filesystem::path& path) : state_(new State{path}) {
  archive* file = state_->file.get();
  state_->check(archive_write_add_filter_gzip(file));
  state_->check(archive_write_set_filter_option(file, "gzip", "timestamp", nullptr));
  state_->check(archive_write_set_filter_option(file, "gzip", "compression-level", "6"));
  state_->check(archive_write_set_format_pax_restricted(file));  // plain ustar where a name fits
  state_->check(archive_write_open_filename(file, path.c_str()));
}

TarWriter::~TarWriter() = default;

void TarWriter::add(const std::string& name, std::string_view text) {
  constexpr int kMode = 0644;
  const std::unique_ptr<archive_entry, FreeEntry> entry(archive_entry_new());
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), kMode);
  archive_entry_set_size(entry.get(), static_cast<std::int64_t>(text.size()));
  archive_entry_set_mtime(entry.get(), 0, 0);
  state_->check(archive_write_header(state_->file.get(), entry.get()));
  while (!text.empty()) {
    const la_ssize_t written = archive_write_data(state_->file.get(), text.data(), text.size());
    state_->check(written > 0 ? ARCHIVE_OK : ARCHIVE_FATAL);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void TarWriter::close() { state_->check(archive_write_close(state_->file.get())); }

struct TarReader::State {
  std::filesystem::path path;
  std::unique_ptr<archive, FreeReader> file{archive_read_new()};
  std::array<char, kBlock> block{};

  void check(int code) const { require_good(code, file.get(), path); }
};

TarReader::TarReader(std::filesystem::path path) : state_(new State{std::move(path)}) {
  archive* file = state_->file.get();
  state_->check(archive_read_support_filter_gzip(file));
  state_->check(archive_read_support_format_tar(file));
  state_->check(archive_read_open_filename(file, state_->path.c_str(), kBlock));
}

TarReader::~TarReader() = default;

std::optional<TarEntry> TarReader::next() {
  archive_entry* entry = nullptr;
  const int code = archive_read_next_header(state_->file.get(), &entry);
  if (code == ARCHIVE_EOF) return std::nullopt;
  state_->check(code);
  const char* name = archive_entry_pathname(entry);
  require(name != nullptr,
          [&] { return fmt::format("{}: an entry has no name", state_->path.string()); });
  const bool is_link =
      archive_entry_hardlink(entry) != nullptr || archive_entry_symlink(entry) != nullptr;
  return TarEntry{name, archive_entry_filetype(entry) == AE_IFREG && !is_link};
}

std::string_view TarReader::more() {
  const la_ssize_t count =
      archive_read_data(state_->file.get(), state_->block.data(), state_->block.size());
  state_->check(count >= 0 ? ARCHIVE_OK : ARCHIVE_FATAL);
  return {state_->block.data(), static_cast<std::size_t>(count)};
}

}  // namespace isoline
