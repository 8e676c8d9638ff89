// Arrays in files: NumPy's format and text.
#include "core/records/npy.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/files.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

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
  EXPECT_NE(refusal_of("hello").find("no .npy file"), std::string::npos);
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
      expect(shaped(shape, order), 16, "more numbers than a file");
  expect(shaped("(1000000000000,)"), 16, "it holds 16 bytes");
  expect(shaped("(2305843009213693952,)"), 0, "it holds 0 bytes");  // of 8: 0 bytes in 64 bits
  for (const char* shape : {"(-1,)", "(-2, -2)", "(99999999999999999999,)", "(1.5,)", "(x,)",
                            "(1 2)", "(,)", "5", "[5]", "(True,)"})
    expect(shaped(shape), 16, "its header must be like");
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
  EXPECT_EQ(refusal_of(npy_of(shaped("()"), 8)), "") << "one number of no index";
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

}  // namespace
}  // namespace isoline
