// What is fuzzed: readers of texts and files that others wrote. Each takes any bytes at all and
// either reads them or refuses them by a UsageError; anything else is a finding.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace isoline::fuzz {

// Each has a corpus in corpus/<name>/.
void spec(std::string_view bytes);
void command_line(std::string_view bytes);
void suite(std::string_view bytes);
void record(std::string_view bytes);
void claims(std::string_view bytes);
void checkpoint(std::string_view bytes);
void network(std::string_view bytes);
void npy(std::string_view bytes);
void wire(std::string_view bytes);

// Calls `read`. A refusal must be a sentence, not what a library says to itself.
void expect_read_or_refused(const std::function<void()>& read);

// A file in memory that is read by its path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const;

 private:
  int descriptor_;
};

}  // namespace isoline::fuzz
