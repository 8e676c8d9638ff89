// What a shared library breaks of the struct of core/foreign/isoline.h is told in a sentence that
// names the library.
#include <gtest/gtest.h>

#include "core/foreign/plugin_library.h"
#include "problems/problem.h"
#include "tests/plugin/libraries.h"

namespace isoline::benchmarks {
namespace {

// The sentence about a defect, of the library's loading or of its first problem's making.
std::string complaint(const char* defect) {
  const Defect here(defect);
  try {
    Catalog catalog;
    add_plugin(catalog, kTrials);
    make_problem(catalog, complete_problem(catalog, "trial-products", OptionValues()), 0);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing";
}

struct Law {
  const char *defect, *sentence;
};

const Law kLaws[] = {
    {"version", "no. 0: a component must have version 1 of isoline.h, got 2"},
    {"bytes", "`bytes` must be sizeof(isoline_component), "},
    {"null name", "no. 0: `name` is null"},
    {"bad name", "`name` must be lower-case letters, digits and hyphens, 64 at most"},
    {"empty title", "trial-products: `title` is empty"},
    {"null source", "trial-products: `source` is null"},
    {"null dimension", "its capabilities include dimension(), which is null"},
    {"null instance", "its capabilities include instance(), which is null"},
    {"null forward", "its capabilities include forward(), which is null"},
    {"null pushforward", "its capabilities include pushforward(), which is null"},
    {"null pullback", "its capabilities include pullback(), which is null"},
    {"null jacobian", "its capabilities include jacobian(), which is null"},
    {"null inverse", "its capabilities include inverse(), which is null"},
    {"null step", "its capabilities include step(), which is null"},
    {"inverse of no kind", "dimension() must say what its inverse is"},
    {"alien capability", "capabilities 0x10000000000 are not valid for a problem"},
    {"no capability", "a problem must have ISOLINE_FORWARD"},
    {"two kinds of step", "either ISOLINE_STEP or ISOLINE_SOLVE"},
    {"null options", "`options` is null"},
    {"endless options", "it may have 100 options, got 1099511627776"},
    {"option outside", "the default of option 'size' must be in [0, 1], got 5"},
    {"endless components", "isoline_plugin() must return null after the last component, got 1000"},
    {"nothing at all", "isoline_plugin() has no component"},
    {"no inputs", "dimension() must give inputs from 1 to 134217728, got 0"},
    {"2^40 inputs", "dimension() must give inputs from 1 to 134217728, got 1099511627776"},
    {"no outputs", "dimension() must give outputs from 1 to 134217728, got 0"},
    {"2^40 outputs", "dimension() must give outputs from 1 to 134217728, got 1099511627776"},
    {"2^40 kept", "dimension() must give kept from 0 to 134217728, got 1099511627776"},
    {"no dimension", "dimension() has no answer"},
    {"no instance", "instance() has no answer"},
    {"null instance of it", "open() returned null"}};

TEST(PluginLaws, ThatAreBrokenAreToldWithTheLibraryAndWhatWasGiven) {
  for (const auto& [defect, sentence] : kLaws) {
    const std::string told = complaint(defect);
    EXPECT_NE(told.find(sentence), std::string::npos) << defect << ": " << told;
    EXPECT_TRUE(told.starts_with(kTrials + ": ")) << defect << ": " << told;
  }
  EXPECT_EQ(complaint("of no name"), "nothing");
}

// What a method returns or asks, as the message of its cell.
std::string message_of_overreach(const char* defect) {
  const Defect here(defect);
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"square"}, {"trial-overreach"});
  return all.records.size() == 1 && all.records[0].status == Status::failed ? all.records[0].message
                                                                            : "it did not fail";
}

TEST(PluginLaws, AMethodIsRefusedWhatItDidNotDeclareWhateverItMakesOfThat) {
  EXPECT_NE(message_of_overreach("").find("jacobian"), std::string::npos)
      << message_of_overreach("");
  EXPECT_NE(message_of_overreach("gradient first").find("need linearize() first"),
            std::string::npos);
  EXPECT_NE(message_of_overreach("unknown verdict").find("got 7"), std::string::npos);
  EXPECT_NE(message_of_overreach("failed step").find("trial-overreach: step() failed"),
            std::string::npos);
}

TEST(PluginLaws, AForwardWithoutAnAnswerIsNotANumber) {
  const Defect here("no answer");
  const Catalog catalog = catalog_with({"trials.so"});
  const FinishedMatrix all = run(catalog, {"trial-products"}, {"gd"});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].status, Status::diverged) << all.records[0].message;
}

TEST(PluginLaws, WhatIsNoLibraryIsNamed) {
  const auto told = [](const std::string& path) {
    try {
      load_plugin(path);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(told("nowhere.so").find("nowhere.so: no such file"), std::string::npos);
  EXPECT_NE(told(kPlugins).find("is a folder"), std::string::npos) << told(kPlugins);
  EXPECT_NE(told(ISOLINE_SOURCE_DIR "/README.md").find("cannot be loaded as a library"),
            std::string::npos);
  EXPECT_NE(told(kPlugins + "/empty.so").find("does not export isoline_plugin()"),
            std::string::npos);
}

}  // namespace
}  // namespace isoline::benchmarks
