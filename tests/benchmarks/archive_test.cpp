// A result folder packed and unpacked is the same folder; an archive that lies about itself is
// refused before it does harm.
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "benchmarks/archive/pack.h"
#include "benchmarks/archive/unpack.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/file_text.h"
#include "core/records/manifest.h"
#include "core/sha256.h"
#include "core/tar_file.h"
#include "tests/reports/fixture.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {

using reports::PlainRun;
using reports::plan_of;
using reports::record_of;
using reports::ResultFolder;

namespace {

namespace fs = std::filesystem;

void fill(const ResultFolder& folder) {
  const Record a = record_of({.seed = 0}), b = record_of({.seed = 1});
  folder.add(a);
  folder.add(b);
  folder.add(plan_of({a, b}));
  fs::create_directories(folder.path() / "report/parts");
  folder.add_file("report/index.html", "<!doctype html>");
  folder.add_file("report/parts/deep.txt", "deep");
}

std::map<std::string, std::string> texts_below(const fs::path& folder) {
  std::map<std::string, std::string> texts;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      texts[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  return texts;
}

TEST(Archive, OfAFolderIsThatFolderAgain) {
  const ResultFolder folder;
  fill(folder);
  const TemporaryFolder place;
  const Packed packed = pack_results(folder.path(), place.path() / "results.tar.gz");
  EXPECT_EQ(packed.records, 2U);
  EXPECT_EQ(packed.files, 5U);
  fs::path where;
  {
    const UnpackedArchive unpacked(place.path() / "results.tar.gz");
    where = unpacked.folder();
    EXPECT_EQ(texts_below(where), texts_below(folder.path()));
    EXPECT_EQ(fs::status(where).permissions(), fs::perms::owner_all) << "it is private";
  }
  EXPECT_FALSE(fs::exists(where));
}

TEST(Archive, IsTheSameBytesWheneverAndWhereverItIsMade) {
  const ResultFolder folder, copy;
  fill(folder);
  fs::copy(folder.path(), copy.path(), fs::copy_options::recursive);
  for (const auto& entry : fs::recursive_directory_iterator(copy.path()))
    if (entry.is_regular_file())
      fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(9));
  const TemporaryFolder place;
  pack_results(folder.path(), place.path() / "one.tar.gz");
  pack_results(copy.path(), place.path() / "two.tar.gz");
  EXPECT_EQ(read_text(place.path() / "one.tar.gz"), read_text(place.path() / "two.tar.gz"));
  EXPECT_EQ(names_in(place.path()).size(), 2U) << "nothing half-written is left";
}

TEST(Archive, LeavesOutWhatIsNoPlainFileAndNamesIt) {
  const ResultFolder folder;
  fill(folder);
  fs::create_symlink("/etc/passwd", folder.path() / "runs/link.json");
  folder.add_file("notes.txt", "not among the results");
  folder.add_file("runs/half.json.9c1d52aa-4711.tmp", "half-written");
  const TemporaryFolder place;
  const Packed packed = pack_results(folder.path(), place.path() / "results.tar.gz");
  EXPECT_EQ(packed.left_out, std::vector<std::string>{"runs/link.json"});
  EXPECT_EQ(packed.files, 5U);
}

TEST(Archive, OfNoRecordsIsAMistake) {
  const ResultFolder folder;
  const TemporaryFolder place;
  EXPECT_THROW(pack_results(folder.path(), place.path() / "results.tar.gz"), UsageError);
  EXPECT_THROW(pack_results(place.path() / "absent", place.path() / "r.tar.gz"), UsageError);
  EXPECT_TRUE(names_in(place.path()).empty());
}

// --- archives that lie

using Files = std::vector<std::pair<std::string, std::string>>;

// A manifest that tells the truth of the files, changed as asked, then the files.
void write_archive(const fs::path& path, const Files& files,
                   const std::function<void(Manifest&)>& change = {}) {
  Manifest manifest{.records = 1};
  for (const auto& [name, text] : files)
    manifest.files.push_back({name, static_cast<std::int64_t>(text.size()), sha256(text)});
  if (change) change(manifest);
  TarWriter tar(path);
  tar.add(kManifestName, file_text(manifest));
  for (const auto& [name, text] : files) tar.add(name, text);
  tar.close();
}

std::string refusal(const fs::path& path) {
  try {
    const UnpackedArchive unpacked(path);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

class Lie : public testing::Test {
 protected:
  fs::path path() const { return place_.path() / "lie.tar.gz"; }
  void expect(const std::string& part) const {
    const std::string sentence = refusal(path());
    EXPECT_NE(sentence.find(part), std::string::npos) << part << " in: " << sentence;
  }
  const fs::path& place() const { return place_.path(); }

 private:
  TemporaryFolder place_;
};

const Files kTwo = {{"plan.json", "{}"}, {"runs/a.json", "[]"}};

TEST_F(Lie, TheTruthIsNoLie) {
  write_archive(path(), kTwo);
  EXPECT_EQ(refusal(path()), "");
}

TEST_F(Lie, APathThatLeavesTheFolderIsRefused) {
  for (const std::string name :
       {"../escaped.json", "/tmp/escaped.json", "runs/../../escaped.json", "runs//a.json", "./a",
        "runs\\..\\a", "a\nb", "", "manifest.json"}) {
    write_archive(path(), {{"plan.json", "{}"}}, [&](Manifest& manifest) {
      manifest.files.push_back({name, 2, sha256("{}")});
    });
    EXPECT_NE(refusal(path()), "") << name;
  }
  EXPECT_EQ(names_in(place()), std::vector<std::string>{"lie.tar.gz"});
}

TEST_F(Lie, AnEntryBesideTheManifestIsRefused) {
  write_archive(path(), kTwo, [](Manifest& manifest) { manifest.files.pop_back(); });
  expect("runs/a.json does not stand in its manifest");
  write_archive(path(), {{"plan.json", "{}"}, {"../plan.json", "{}"}},
                [](Manifest& manifest) { manifest.files.pop_back(); });
  expect("../plan.json does not stand in its manifest");
}

TEST_F(Lie, AFileThatIsMissingTwiceThereOrNamedTwiceIsRefused) {
  write_archive(path(), kTwo, [](Manifest& manifest) {
    manifest.files.push_back({"runs/b.json", 2, sha256("[]")});
  });
  expect("runs/b.json is missing");
  write_archive(path(), {{"plan.json", "{}"}, {"plan.json", "{}"}},
                [](Manifest& manifest) { manifest.files.pop_back(); });
  expect("plan.json is there twice");
  write_archive(path(), {{"plan.json", "{}"}, {"plan.json", "{}"}});
  expect("names plan.json twice");
}

TEST_F(Lie, AnotherDigestOrAnotherLengthIsRefused) {
  write_archive(path(), kTwo, [](Manifest& manifest) { manifest.files[1].sha256[0] ^= 1; });
  expect("runs/a.json is not what its manifest says");
  write_archive(path(), kTwo, [](Manifest& manifest) { manifest.files[1].bytes = 1; });
  expect("runs/a.json is longer than its manifest says");
  write_archive(path(), kTwo, [](Manifest& manifest) { manifest.files[1].bytes = 3; });
  expect("runs/a.json is not what its manifest says");
  write_archive(path(), kTwo, [](Manifest& manifest) { manifest.files[1].bytes = -1; });
  expect("-1");
}

TEST_F(Lie, ABombIsRefusedBeforeItIsUnpacked) {
  write_archive(path(), kTwo,
                [](Manifest& manifest) { manifest.files[1].bytes = std::int64_t{1} << 41; });
  expect("more than a terabyte");
  write_archive(path(), kTwo, [](Manifest& manifest) {
    manifest.files[0].bytes = manifest.files[1].bytes = std::int64_t{1} << 62;
  });
  expect("more than a terabyte");
}

// Ten megabytes of zeros are ten kilobytes here: what the manifest does not tell of is not written.
TEST_F(Lie, ALongFileIsReadNoFurtherThanItsManifestGoes) {
  write_archive(path(), {{"plan.json", std::string(10'000'000, '\0')}},
                [](Manifest& manifest) { manifest.files[0].bytes = 1000; });
  expect("longer than its manifest says");
}

TEST_F(Lie, AFileWhereAFolderMustBeIsRefused) {
  write_archive(path(), {{"runs", "{}"}, {"runs/a.json", "[]"}});
  EXPECT_NE(refusal(path()), "");
}

TEST_F(Lie, WhatBeginsWithoutAManifestIsRefused) {
  {
    TarWriter tar(path());
    tar.add("plan.json", "{}");
    tar.close();
  }
  expect("it does not begin with manifest.json");
  write_text(path(), "");
  EXPECT_NE(refusal(path()), "");
  {
    TarWriter tar(path());
    tar.add(kManifestName, "[1, 2");
    tar.close();
  }
  EXPECT_NE(refusal(path()), "");
}

}  // namespace
}  // namespace isoline::benchmarks
