// Files under hostile names, temporary files of other programs, and the formats NPY and JSON.
#include "core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/json.h"
#include "core/output.h"
#include "core/records/json_view.h"
#include "core/records/npy.h"
#include "core/records/record.h"
#include "core/text.h"
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
  expect_said(complaint_about(folder.path() / "a"), "symbolic links");
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
    write_text(folder.path() / name, "foreign");
    EXPECT_FALSE(is_abandoned(folder.path() / name)) << name;
  }
  const fs::path named = temporary_by(gone, folder.path() / "folder.json");
  fs::create_directory(named);
  EXPECT_FALSE(is_abandoned(named)) << "it is no file";
}

TEST(Files, HiddenFoldersOfProcessesThatWereKilledAreRemovedByTheNext) {
  const TemporaryFolder owned;
  const fs::path told = owned.path() / "path";
  const pid_t child = fork();
  if (child == 0) {
    const HiddenFolder folder;
    write_text(folder.path() / "file", "text");
    write_text(told, folder.path().string());
    _exit(0);  // as a kill does, it leaves the folder
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(is_there(read_text(told)));
  const HiddenFolder next;
  EXPECT_FALSE(is_there(read_text(told)));
  EXPECT_TRUE(is_there(next.path()));
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
  EXPECT_THROW(move_into(aside, file), UsageError) << "no free name is left";
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
TEST(Files, OfAUserAreWrittenThroughWhatIsNoFileAndNeverInThePlaceOfAnothers) {
  const TemporaryFolder owned;
  const fs::path file = owned.path() / "file", link = owned.path() / "link";
  write_output("/dev/null", "mark 1", "mark");
  EXPECT_EQ(fs::status("/dev/null").type(), fs::file_type::character);
  write_output(file, "mark 1", "mark");
  fs::create_symlink("file", link);
  write_output(link, "mark 2", "mark");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_text(file), "mark 2");
  const fs::path half = temporary_by(number_of_the_gone(), file);
  write_text(half, "half");
  write_output(file, "mark 2", "mark");
  EXPECT_FALSE(is_there(half)) << "of a process that was killed";
  const fs::path pipe = owned.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  write_output(pipe, "mark 3", "mark");
  std::array<char, 16> got{};
  EXPECT_EQ(read(reader, got.data(), got.size()), 6);
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  write_text(file, "a letter of mine");
  EXPECT_THROW(write_output(file, "mark 4", "mark"), UsageError);
  EXPECT_EQ(read_text(file), "a letter of mine");
  EXPECT_THROW(write_output(owned.path(), "mark 5", "mark"), UsageError);
}

TEST(Files, ThatTheSystemDoesNotOpenAreToldFromDamagedOnes) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_NOFILE, &none);
    try {
      read_text("/proc/self/exe");
    } catch (const AccessError&) {
      _exit(0);
    } catch (...) {
    }
    _exit(1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

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

// A written file is on the disk, or an error says that it may not be.
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

// Arrays in files: NumPy's format and text.

// The bytes of numpy.save for the array [[1, 2, 3], [4, 5, 6]] as '<f4' in column-major order, the
// header as numpy 1.24 writes it.
std::string by_numpy() {
  std::string header = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }";
  header.append(118 - 1 - header.size(), ' ').push_back('\n');
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);
  bytes += header;
  for (const float value : {1.F, 4.F, 2.F, 5.F, 3.F, 6.F}) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    bytes.append(raw, 4);
  }
  return bytes;
}

std::string refusal_of(const std::string& bytes) {
  return refusal([&] { npy_from_bytes(bytes); });
}

TEST(Npy, ReadsWhatNumpyWrites) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.npy", by_numpy());
  const NumberArray array = read_npy(folder.path() / "a.npy");
  EXPECT_EQ(array.shape, (std::vector<Index>{2, 3}));
  EXPECT_EQ(array.values, (std::vector<Real>{1, 2, 3, 4, 5, 6}));
}

TEST(Npy, SurvivesTheRoundTripAtEveryRank) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.npy";
  for (const std::vector<Index>& shape : {std::vector<Index>{4}, {2, 2}, {1, 2, 2}, {0, 7}}) {
    Index count = 1;
    for (const Index size : shape) count *= size;
    NumberArray array{shape, {}};
    for (Index i = 0; i < count; ++i) array.values.push_back(0.1 * static_cast<Real>(i));
    write_npy(file, array);
    EXPECT_EQ(read_npy(file).values, array.values);
    EXPECT_EQ(read_npy(file).shape, shape);
    EXPECT_EQ(read_text(file).find('\n') % 64, 63U);  // numbers begin at a multiple of 64
  }
}

TEST(Npy, RefusesWhatItCannotTakeWithOneSentence) {
  const std::string good = by_numpy();
  EXPECT_NE(refusal_of("hello").find("a .npy file"), std::string::npos);
  EXPECT_NE(refusal_of(good.substr(0, good.size() - 3)).find("bytes of numbers"),
            std::string::npos);
  std::string complex = good;
  complex.replace(complex.find("<f4"), 3, "<c8");
  EXPECT_NE(refusal_of(complex).find("'<c8'"), std::string::npos);
  std::string infinite = good;
  const float nan = NAN;
  std::memcpy(infinite.data() + infinite.size() - 4, &nan, 4);
  EXPECT_NE(refusal_of(infinite).find("not finite"), std::string::npos);
}

// A file of the format's first version, with any header and numbers of zero.
std::string npy_of(const std::string& header, std::size_t bytes) {
  std::string file("\x93NUMPY\x01\x00", 8);
  file += {static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  return file + header + std::string(bytes, '\0');
}

std::string shaped(const std::string& shape, const char* order = "False") {
  return fmt::format("{{'descr': '<f8', 'fortran_order': {}, 'shape': {}, }}\n", order, shape);
}

TEST(Npy, HeadersThatCannotBeAreRefusedBeforeRoomIsMade) {
  const auto expect = [](const std::string& header, std::size_t bytes, const char* part) {
    EXPECT_NE(refusal_of(npy_of(header, bytes)).find(part), std::string::npos)
        << header.substr(0, 80);
  };
  // As many letters as a header's length can say made std::regex recurse until the stack ended.
  for (const std::string& header :
       {std::string(60'000, ' '), "{'descr': '" + std::string(60'000, 'a') + "'}",
        shaped("(" + std::string(60'000, '1') + ")"), shaped("(" + std::string(60'000, ' ') + ")")})
    expect(header, 0, "at most 10000");
  // 2³² · 2³² is 0 in 64 bits: an index into what was allocated for it would lead anywhere.
  for (const char* order : {"False", "True"})
    for (const char* shape :
         {"(4294967296, 4294967296)", "(9223372036854775807, 2)", "(3, 6148914691236517206)",
          "(0, 9223372036854775807, 9223372036854775807)"})
      expect(shaped(shape, order), 16, "more numbers than");
  expect(shaped("(1000000000000,)"), 16, "it contains 16 bytes");
  expect(shaped("(2305843009213693952,)"), 0, "it contains 0 bytes");  // of 8: 0 bytes in 64 bits
  for (const char* shape : {"(-1,)", "(-2, -2)", "(99999999999999999999,)", "(1.5,)", "(x,)",
                            "(1 2)", "(,)", "5", "[5]", "(True,)"})
    expect(shaped(shape), 16, "its header must ");
  std::string many = "(";
  for (int i = 0; i < 100; ++i) many += "1,";
  expect(shaped(many + ")"), 8, "more than 64");
}

TEST(Npy, AHeaderThatIsNoDictionaryOfThreeKeysIsRefused) {
  for (const char* header :
       {"", "{", "{}", "[]", "{'descr': '<f8', 'fortran_order': False, }",
        "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (), }",
        "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (), 'more': 1, }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (), } and more", "{'descr': '<f8",
        "{'descr' '<f8'}", "{'descr': '<f8', 'fortran_order': Maybe, 'shape': (), }"})
    EXPECT_NE(refusal_of(npy_of(header, 8)), "") << header;
  EXPECT_EQ(refusal_of(npy_of(shaped("()"), 8)), "") << "one number without an index";
  EXPECT_EQ(refusal_of(npy_of("{\"shape\":(1,),\"descr\":\"<f8\",\"fortran_order\":False}", 8)),
            "");
}

TEST(Csv, IsReadWithOrWithoutAHeaderAndRefusesHoles) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.csv";
  write_text(file, "a,b\n1, 2\n3,4e1\r\n");
  EXPECT_EQ(read_numbers(file).values, (std::vector<Real>{1, 2, 3, 40}));
  EXPECT_EQ(read_numbers(file).shape, (std::vector<Index>{2, 2}));
  for (const std::string text : {"1,2\n3\n", "1,2\n3,nan\n", "1,2\n3,x\n"}) {
    write_text(file, text);
    EXPECT_THROW(read_numbers(file), UsageError) << text;
  }
}

TEST(Csv, HasNumbersAsSpreadsheetsAndFortranWriteThem) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.csv";
  for (const std::string text :
       {"+0.5,-2.\n", "\"0.5\",\"-2\"\r\n", "0.5;-2\n", "  5.0D-01\t-2d0\n", "\xEF\xBB\xBF.5,-2\n",
        "# of a fit\n\"a\";\"b\"\n+5E-1; -2\n\n"}) {
    write_text(file, text);
    EXPECT_EQ(read_numbers(file).values, (std::vector<Real>{0.5, -2})) << text;
    EXPECT_EQ(read_numbers(file).shape, (std::vector<Index>{1, 2})) << text;
  }
}

// A decimal comma, a letter for a digit, a heading alone, nothing.
TEST(Csv, WithoutAPlainNumberNamesItsLine) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.csv";
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"0,5;2\n", "line 1"}, {"a,b\n1,2\n3,4O\n", "line 3"}, {"1O,2\n", "line 1"},
      {"a,b\n", "'a,b'"},    {"1,--2\n", "'--2'"},           {"", "a.csv"}};
  for (const auto& [text, part] : damages) {
    write_text(file, text);
    try {
      read_numbers(file);
      ADD_FAILURE() << text;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

// JSON: numbers are read back exactly, a view without a tree equals the tree, and errors name what
// is missing or of another type.

TEST(Numbers, SurviveTheRoundTripToTheLastBit) {
  for (const Real value : {0.1, -0.0, 1e-308, 5e-324, 1.7976931348623157e308, 1.0 / 3}) {
    const Real back = real_of(Json::parse(json_number(value).dump()));
    EXPECT_EQ(std::signbit(back), std::signbit(value));
    EXPECT_EQ(back, value);
  }
  for (const Real value : {Real{INFINITY}, -Real{INFINITY}})
    EXPECT_EQ(real_of(Json::parse(json_number(value).dump())), value);
  EXPECT_TRUE(std::isnan(real_of(Json::parse(json_number(NAN).dump()))));
  EXPECT_THROW(real_of(Json("one")), UsageError);
  EXPECT_THROW(real_of(Json()), UsageError);
}

std::string complaint_of_json(const std::string& text) {
  return refusal([&] { parse_json(text, "given.json"); });
}

TEST(Json, IsRefusedInWordsWithoutTheNamesOfItsLibrary) {
  EXPECT_EQ(complaint_of_json("\x93NUMPY"), "given.json is binary, not JSON");
  const std::string complaint = complaint_of_json("{,}");
  EXPECT_EQ(complaint.find("exception"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("line 1"), std::string::npos) << complaint;
}

// 200,000 levels overflow the stack of a function that copies, compares or writes such a tree.
TEST(Json, ThatNestsWithoutEndIsRefused) {
  for (const std::string opening : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 200'000; ++i) text += opening;
    EXPECT_NE(complaint_of_json(text).find("nested deeper"), std::string::npos);
  }
  EXPECT_EQ(complaint_of_json("[\"[[[[\\\"[[[[\"]" + std::string(1000, ' ')), "");
  EXPECT_EQ(complaint_of_json(std::string(150, '[') + std::string(150, ']')), "");
}

// Of which the parsers of other programs take the first or the last.
TEST(Json, WithTwoMembersOfOneNameIsRefused) {
  const std::string twins = R"([{"a": 1, "b": {"a": 2, "c": 3, "a": 4}}])";
  EXPECT_NE(complaint_of_json(twins).find("two members \"a\""), std::string::npos);
  EXPECT_NE(refusal([&] { JsonReader().parse(twins, "it"); }).find("two members"),
            std::string::npos);
  EXPECT_NE(refusal([&] { outline_of(twins, "it"); }).find("two members"), std::string::npos);
  EXPECT_EQ(complaint_of_json(R"([{"a": 1}, {"a": {"a": 2}}])"), "");
}

TEST(Json, OfNumbersThatNoDoubleHoldsIsAUsageError) {
  EXPECT_NE(complaint_of_json("[1e400]").find("given.json"), std::string::npos);
  EXPECT_NE(complaint_of_json("{\"a\": ").find("given.json"), std::string::npos);
  EXPECT_NE(complaint_of_json("[" + std::string(400, '9') + "]").find("given.json"),
            std::string::npos);
}

TEST(Json, ThatIsShownIsTheSameJson) {
  const Json json = {{"message", "\x1b[2J \u009b \x7f \u202e \n \" \\ θ"}};
  const std::string shown = printable(json_text(json));
  EXPECT_EQ(Json::parse(shown), json);
  EXPECT_EQ(shown.find('\x7f'), std::string::npos);
}

// Whatever a component says or a path is made of, JSON is written of it.
TEST(Json, IsWrittenOfTextThatIsNoUtf8) {
  EXPECT_EQ(json_text(Json{{"message", "x\xff"}}), "{\"message\":\"x\uFFFD\"}");
  EXPECT_EQ(json_text(Json(std::string("cut \xCE"))), "\"cut \uFFFD\"");
}

constexpr const char* kText = R"({"integer":-7,"large":18446744073709551615,
  "real":5.266142885157513e-10,"text":"½ \"quoted\"","truth":true,"nothing":null,"list":[0,1,2],
  "reals":[1.0,"inf","-inf","nan",3],"lists":{"b":[1],"a":[]},"words":["x","y"]})";

TEST(JsonView, ReadsEachTypeAsItStands) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_EQ(json.json(), Json::parse(kText));
  EXPECT_EQ(json.at("integer").get<std::int64_t>(), -7);
  EXPECT_EQ(json.at("text").get<std::string>(), "½ \"quoted\"");
  EXPECT_TRUE(json.at("truth").get<bool>());
  EXPECT_TRUE(json.at("nothing").is_null());
  EXPECT_TRUE(json.contains("list"));
  EXPECT_FALSE(json.contains("absent"));
  EXPECT_EQ(json.at("list").get<std::vector<std::int64_t>>(), (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(json.at("words").get<std::vector<std::string>>(), (std::vector<std::string>{"x", "y"}));
  const auto lists = json.at("lists").items();
  ASSERT_EQ(lists.size(), 2U);
  EXPECT_EQ(lists[0].first, "b");
  EXPECT_EQ(lists[0].second.get<std::vector<std::int64_t>>(), std::vector<std::int64_t>{1});
  EXPECT_TRUE(lists[1].second.values().empty());
}

TEST(JsonView, RealsKeepEveryBitAndWhatIsNotFinite) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_EQ(real_of(json.at("real")), 5.266142885157513e-10);
  const std::vector<Real> reals = reals_of(json.at("reals"));
  ASSERT_EQ(reals.size(), 5U);
  EXPECT_EQ(reals[1], INFINITY);
  EXPECT_EQ(reals[2], -INFINITY);
  EXPECT_TRUE(std::isnan(reals[3]));
  EXPECT_EQ(reals[4], 3);
}

TEST(JsonView, SaysWhatItLacksAndWhatItFoundInstead) {
  JsonReader reader;
  const JsonView json = reader.parse(kText, "it");
  EXPECT_NE(refusal([&] { json.at("absent"); }).find("absent"), std::string::npos);
  EXPECT_NE(refusal([&] { json.at("text").get<std::int64_t>(); }).find("integer"),
            std::string::npos);
  EXPECT_NE(refusal([&] { real_of(json.at("text")); }).find("number"), std::string::npos);
  EXPECT_NE(refusal([&] { reals_of(json.at("words")); }).find("number"), std::string::npos);
  EXPECT_NE(refusal([&] { json.at("large").get<std::int64_t>(); }).find("integer"),
            std::string::npos);
  const std::string cut = std::string(kText).substr(0, 60);
  EXPECT_NE(refusal([&] { reader.parse(cut, "runs/a.json"); }).find("runs/a.json"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { reader.parse(kText, "it"); }), "") << "the reader is good for the next";
}

// Each law on an element that one of the column breaks is broken by the outline.
TEST(Outline, KeepsOfALongColumnWhatLawsOnItsElementsAskFor) {
  Json document{{"short", {1, 2, 3}}, {"mixed", Json::array()}, {"rows", Json::array()}};
  Json column = Json::array();
  for (int i = 0; i < 100; ++i) column.push_back(i);
  document["counts"] = column;
  column[50] = -7;
  document["negative"] = column;
  column[50] = "nan";
  column[51] = 0.5;
  column[52] = std::uint64_t{1} << 63;
  document["mixed"] = column;
  column[53] = nullptr;
  document["rows"] = column;
  const Json outline = outline_of(json_text(document), "given");
  EXPECT_EQ(outline["short"], document["short"]);
  EXPECT_EQ(outline["counts"], (Json{0, 99}));
  EXPECT_EQ(outline["negative"], (Json{-7, 99}));
  EXPECT_EQ(outline["mixed"],
            (Json{0.5, 0.5, 0, 99, std::uint64_t{1} << 63, std::uint64_t{1} << 63, "nan"}));
  EXPECT_EQ(outline["rows"], document["rows"]) << "null is neither number nor text";
}

// `validate` looks at outlines of records.
TEST(Outline, LosesNothingThatTheSchemaOfRecordsAsksFor) {
  const std::string schema = json_text(run_schema());
  for (const char* law : {"minItems", "maxItems", "uniqueItems", "contains", "multipleOf"})
    EXPECT_EQ(schema.find(law), std::string::npos) << law;
}

TEST(Outline, OfWhatIsNoJsonIsAUsageErrorThatNamesItsOrigin) {
  for (const std::string& text : {std::string("{"), std::string("[1e400]"), std::string(2000, '[')})
    EXPECT_NE(refusal([&] { outline_of(text, "given.json"); }).find("given.json"),
              std::string::npos);
}

}  // namespace
}  // namespace isoline
