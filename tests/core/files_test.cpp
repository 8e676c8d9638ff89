// Files under hostile names, and temporaries that belong to somebody else.
#include "core/files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

namespace fs = std::filesystem;

std::string complaint_about(const fs::path& path, std::size_t most_bytes = kMostBytes,
                            Links links = Links::followed) {
  return refusal([&] { read_text(path, most_bytes, links); });
}

void expect_said(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << " does not say: " << part;
}

// Opened to be read, a pipe without a writer waits for one.
TEST(Files, APipeIsRefusedAtOnce) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "record.json";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_said(complaint_about(pipe), "it is a pipe");
  expect_said(complaint_about(pipe), pipe.string());
}

TEST(Files, DevicesFoldersAndLinksInACircleAreRefused) {
  const TemporaryFolder folder;
  expect_said(complaint_about("/dev/zero"), "it is a device");
  expect_said(complaint_about(folder.path()), "it is a folder");
  fs::create_symlink(folder.path() / "b", folder.path() / "a");
  fs::create_symlink(folder.path() / "a", folder.path() / "b");
  expect_said(complaint_about(folder.path() / "a"), "Too many levels of symbolic links");
  fs::create_symlink("/dev/zero", folder.path() / "endless.json");
  expect_said(complaint_about(folder.path() / "endless.json"), "it is a device");
  expect_said(complaint_about(folder.path() / "absent"), "no such file");
}

// A hole of 2⁴⁰ bytes takes no room on the disk.
TEST(Files, OfMoreThanTheBoundAreRefusedBeforeTheyAreRead) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "hole.json";
  std::ofstream(file).close();
  fs::resize_file(file, std::uintmax_t{1} << 40);
  expect_said(complaint_about(file), "1099511627776 bytes");
  write_text(file, "12345");
  EXPECT_EQ(complaint_about(file, 5), "");
  expect_said(complaint_about(file, 4), "at most 4");
}

TEST(Files, AreReadToTheEndWhateverTheirSizeIsSaidToBe) {
  EXPECT_NE(read_text("/proc/self/status").find("Threads:"), std::string::npos);  // it says 0
  const TemporaryFolder folder;
  for (const std::size_t size : {0U, 1U, 4095U, 4096U, 4097U, 100'000U}) {
    const std::string text(size, 'x');
    write_text(folder.path() / "file", text);
    EXPECT_EQ(read_text(folder.path() / "file"), text);
  }
}

TEST(Files, ALinkIsFollowedWhereThatIsAskedFor) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "text");
  fs::create_symlink(folder.path() / "file", folder.path() / "link");
  EXPECT_EQ(read_text(folder.path() / "link"), "text");
  expect_said(complaint_about(folder.path() / "link", kMostBytes, Links::refused), "symbolic link");
}

TEST(Files, AFolderIsListedWhateverStandsInIt) {
  const TemporaryFolder folder;
  EXPECT_TRUE(names_in(folder.path() / "absent").empty());
  write_text(folder.path() / "b", "");
  mkfifo((folder.path() / "c").c_str(), 0600);
  fs::create_symlink(folder.path() / "a", folder.path() / "a");  // to itself
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_TRUE(is_there(folder.path() / "a"));
  EXPECT_FALSE(is_there(folder.path() / "d"));
  EXPECT_THROW(names_in(folder.path() / "b"), UsageError) << "a file is no folder";
}

// The number of a process that has been and gone.
pid_t number_of_the_gone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

// As the process of that number would name its temporary.
fs::path temporary_by(pid_t process, const fs::path& path) {
  std::string name = temporary_of(path).string();
  const std::string own = fmt::format("-{}.tmp", getpid());
  name.replace(name.size() - own.size(), own.size(), fmt::format("-{}.tmp", process));
  return name;
}

TEST(Files, ATemporaryOfOursIsAbandonedWhenItsWriterIsGone) {
  const TemporaryFolder folder;
  const fs::path record = folder.path() / "record.json";
  const fs::path mine = temporary_of(record), left = temporary_by(number_of_the_gone(), record);
  write_text(mine, "half");
  write_text(left, "half");
  EXPECT_FALSE(is_abandoned(mine)) << "its writer lives";
  EXPECT_TRUE(is_abandoned(left));
  EXPECT_FALSE(is_abandoned(record));
}

TEST(Files, ATemporaryOfAnotherIsLeftAlone) {
  const TemporaryFolder folder;
  const pid_t gone = number_of_the_gone();
  const std::string elsewhere = fmt::format("record.json.00000000-{}.tmp", gone);
  for (const std::string& name : {std::string("thesis.tmp"), std::string("notes.1.tmp"),
                                  fmt::format("record.json.{}.tmp", gone), elsewhere}) {
    write_text(folder.path() / name, "somebody's");
    EXPECT_FALSE(is_abandoned(folder.path() / name)) << name;
  }
  const fs::path named = temporary_by(gone, folder.path() / "folder.json");
  fs::create_directory(named);
  EXPECT_FALSE(is_abandoned(named)) << "it is no file";
}

TEST(Files, MovedAsideNeverReplaceEachOther) {
  const TemporaryFolder folder;
  const fs::path aside = folder.path() / "damaged", file = folder.path() / "plan.json";
  for (const char* text : {"first", "second", "third"}) {
    write_text(file, text);
    EXPECT_EQ(read_text(move_into(aside, file)), text);
    EXPECT_FALSE(is_there(file));
  }
  EXPECT_EQ(read_text(aside / "plan.json"), "first");
  EXPECT_EQ(names_in(aside).size(), 3U);
  EXPECT_THROW(move_into(aside, file), UsageError) << "there is none left";
}

TEST(Files, AFailedWriteLeavesTheOldFileAndNoOther) {
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  const auto path = folder / "record.json";
  write_text(path, "old");
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THROW(write_text(folder / "taken", "new"), std::runtime_error);  // rename must fail
  EXPECT_THROW(write_text(folder / "absent" / "record.json", "new"), std::runtime_error);
  EXPECT_EQ(read_text(path), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2);
}

// A limit on the size of files stands in for a full disk: write() fails half-way in both.
TEST(Files, AFullDiskIsAnErrorAndLeavesNothingBehind) {
  const TemporaryFolder owned;
  const std::filesystem::path& folder = owned.path();
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{10, before.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_text(folder / "record.json", std::string(100, 'x')), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

// What is told to be written is on the disk, or an error says that it may not be.
TEST(Files, AFlushThatCannotBeIsAnError) {
  const TemporaryFolder owned;
  EXPECT_NO_THROW(flush_all(owned.path()));
  EXPECT_THROW(flush_all(owned.path() / "absent"), std::runtime_error);
  EXPECT_THROW(write_unflushed(owned.path() / "absent" / "a.json", "{}"), std::runtime_error);
}

// Published test vectors of FNV-1a, 64 bits (Fowler, Noll, Vo).
TEST(Digest, IsFnv1a) {
  EXPECT_EQ(digest(""), "cbf29ce484222325");
  EXPECT_EQ(digest("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(digest("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace isoline
