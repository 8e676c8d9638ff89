// Every input of the corpora again, in the ordinary build: what a fuzzer or a user once found is
// read or refused by a sentence.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include "core/files.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, void (*)(std::string_view)> kTargets = {
    {"spec", spec},     {"command_line", command_line}, {"suite", suite},     {"record", record},
    {"claims", claims}, {"checkpoint", checkpoint},     {"network", network}, {"npy", npy},
    {"wire", wire}};

const fs::path kCorpora = fs::path(ISOLINE_SOURCE_DIR) / "tests/fuzz/corpus";

TEST(Corpora, AreReadOrRefusedBySentences) {
  for (const auto& [name, read] : kTargets) {
    std::vector<fs::path> inputs;
    for (const auto& entry : fs::directory_iterator(kCorpora / name)) inputs.push_back(entry);
    EXPECT_GE(inputs.size(), 3U) << name;
    std::ranges::sort(inputs);
    for (const fs::path& input : inputs) {
      SCOPED_TRACE(input.string());
      EXPECT_NO_THROW(read(read_text(input))) << input;
    }
  }
}

TEST(Corpora, BelongToTargetsAndStaySmall) {
  constexpr std::uintmax_t kMostBytes = 100'000;
  for (const auto& entry : fs::recursive_directory_iterator(kCorpora))
    if (entry.is_directory())
      EXPECT_TRUE(kTargets.contains(entry.path().filename())) << entry.path();
    else
      EXPECT_LE(entry.file_size(), kMostBytes) << entry.path();
}

}  // namespace
}  // namespace isoline::fuzz
