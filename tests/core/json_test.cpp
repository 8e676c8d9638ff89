// Numbers and files survive.
#include "core/json.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

TEST(Numbers, SurviveTheRoundTripToTheLastBit) {
  for (const Real value : {0.1, -0.0, 1e-308, 5e-324, 1.7976931348623157e308, 1.0 / 3}) {
    const Real back = real_of(Json::parse(json_number(value).dump()));
    EXPECT_EQ(std::signbit(back), std::signbit(value));
    EXPECT_EQ(back, value);
  }
}

TEST(Numbers, InfinityAndNotANumberSurvive) {
  EXPECT_EQ(real_of(Json::parse(json_number(INFINITY).dump())), INFINITY);
  EXPECT_EQ(real_of(Json::parse(json_number(-INFINITY).dump())), -INFINITY);
  EXPECT_TRUE(std::isnan(real_of(Json::parse(json_number(NAN).dump()))));
}

TEST(Numbers, WhatIsNoNumberIsAUsageError) {
  EXPECT_THROW(real_of(Json("one")), UsageError);
  EXPECT_THROW(real_of(Json()), UsageError);
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

TEST(Files, WhatIsNoJsonNamesItsOrigin) {
  try {
    parse_json("{\"a\": ", "suite.json");
    FAIL() << "half a document was accepted";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("suite.json"), std::string::npos);
  }
}

std::string complaint_of_json(const std::string& text) {
  try {
    parse_json(text, "given.json");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

// 200,000 levels overflow the stack of whoever copies, compares or writes such a tree.
TEST(Json, ThatNestsWithoutEndIsRefused) {
  for (const std::string opening : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 200'000; ++i) text += opening;
    EXPECT_NE(complaint_of_json(text).find("nested deeper"), std::string::npos);
  }
  EXPECT_EQ(complaint_of_json("[\"[[[[\\\"[[[[\"]" + std::string(1000, ' ')), "");
  EXPECT_EQ(complaint_of_json(std::string(150, '[') + std::string(150, ']')), "");
}

TEST(Json, OfNumbersThatNoDoubleHoldsIsAUsageError) {
  EXPECT_NE(complaint_of_json("[1e400]").find("given.json"), std::string::npos);
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

// Published test vectors of FNV-1a, 64 bits (Fowler, Noll, Vo).
TEST(Digest, IsFnv1a) {
  EXPECT_EQ(digest(""), "cbf29ce484222325");
  EXPECT_EQ(digest("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(digest("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace isoline
