// What the targets share.
#include "tests/fuzz/targets.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

#include "core/errors.h"

namespace isoline::fuzz {
namespace {

// Not what std::stoll and std::bad_alloc say, which is one word, nor what std::vector, std::string
// and the library of JSON say. A sentence may begin with any word that was read: "stoll: …".
bool is_a_sentence(const std::string& message) {
  for (const char* foreign :
       {"vector::_M_range_check: __n (which", "basic_string::", "[json.exception."})
    if (message.starts_with(foreign)) return false;
  return message.find(' ') != std::string::npos;
}

}  // namespace

void expect_read_or_refused(const std::function<void()>& read) {
  try {
    read();
  } catch (const UsageError& refusal) {
    if (!is_a_sentence(refusal.what()))
      throw std::logic_error("refused without a sentence: " + std::string(refusal.what()));
  }
}

MemoryFile::MemoryFile(std::string_view bytes)
    : descriptor_(memfd_create("isoline-fuzz", MFD_CLOEXEC)) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written <= 0) throw std::runtime_error("a file in memory cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

}  // namespace isoline::fuzz
