// Archives are the same bytes for the same texts, and are read without trust.
#include "core/tar_file.h"

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/files.h"
#include "core/sha256.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

// FIPS 180-4's examples, of NIST's own page of them.
TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 digest;
  for (const char* part : {"abcdbcdecdefdefgefghfghighij", "hijkijkljklmklmnlmnomnopnopq"})
    digest.add(part);
  EXPECT_EQ(digest.text(), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(digest.text(), sha256("")) << "it begins anew";
}

void write(const std::filesystem::path& path) {
  TarWriter tar(path);
  tar.add("a.json", "{}\n");
  tar.add("runs/b.json", std::string(200'000, 'x'));
  tar.add("runs/" + std::string(150, 'n'), "a name longer than ustar has");
  tar.close();
}

std::string whole(TarReader& tar) {
  std::string text;
  for (std::string_view more = tar.more(); !more.empty(); more = tar.more()) text += more;
  return text;
}

TEST(TarFile, IsTheSameBytesForTheSameTexts) {
  const TemporaryFolder folder;
  write(folder.path() / "one.tar.gz");
  write(folder.path() / "two.tar.gz");
  const std::string bytes = read_text(folder.path() / "one.tar.gz");
  EXPECT_EQ(bytes, read_text(folder.path() / "two.tar.gz"));
  EXPECT_EQ(bytes.substr(4, 4), std::string(4, '\0')) << "the time in the header of gzip";
}

TEST(TarFile, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  write(folder.path() / "one.tar.gz");
  TarReader tar(folder.path() / "one.tar.gz");
  auto entry = tar.next();
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->name, "a.json");
  EXPECT_TRUE(entry->is_file);
  EXPECT_EQ(whole(tar), "{}\n");
  entry = tar.next();
  ASSERT_TRUE(entry);
  EXPECT_EQ(whole(tar), std::string(200'000, 'x'));
  entry = tar.next();
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->name, "runs/" + std::string(150, 'n'));
  EXPECT_FALSE(tar.next());
}

TEST(TarFile, RefusesWhatIsNoneOrIsCutOff) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "one.tar.gz";
  EXPECT_THROW(TarReader(folder.path() / "absent.tar.gz"), UsageError);
  write_text(path, "no archive at all");
  EXPECT_THROW(
      {
        TarReader tar(path);
        while (tar.next()) whole(tar);
      },
      UsageError);
  write(path);
  const std::string bytes = read_text(path);
  for (const std::size_t size : {bytes.size() / 2, bytes.size() - 20}) {
    write_text(path, bytes.substr(0, size));
    EXPECT_THROW(
        {
          TarReader tar(path);
          while (tar.next()) whole(tar);
        },
        UsageError)
        << size;
  }
}

}  // namespace
}  // namespace isoline
