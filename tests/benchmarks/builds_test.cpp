// What computes a run is known by its sources: an edit changes the part that it belongs to, and no
// other; a record of another build is not taken for one of this.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/plan/build_parts.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/runner.h"
#include "core/files.h"
#include "core/records/provenance.h"
#include "tests/benchmarks/hostile.h"
#include "tests/temporary_folder.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::string shell(const std::string& command) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  EXPECT_EQ(std::system((command + " >" + out.string() + " 2>&1").c_str()), 0) << command << "\n"
                                                                               << read_text(out);
  return read_text(out);
}

// A tree in small: two optimizers that share a header, one problem, records and a run loop.
class SmallTree {
 public:
  SmallTree() {
    write("core/array.h", "// arrays\n");
    write("core/records/record.h", "// records\n");
    write("core/threads.h", "// threads\n");
    write("networks/network.h", "#include \"core/array.h\"\n");
    write("networks/unet/passes.h", "#include \"networks/network.h\"\n");
    write("networks/unet/forward.cpp",
          "#include \"core/threads.h\"\n#include \"networks/unet/passes.h\"\n");
    write("networks/unet.cpp", "#include \"networks/unet/passes.h\"\nvoid register_unet();\n");
    write("problems/problem.h", "#include \"networks/network.h\"\n");
    write("problems/problem.cpp", "#include \"problems/problem.h\"\n");
    write("problems/heat.cpp", "#include \"problems/problem.h\"\nvoid register_heat();\n");
    write("optimizers/meter.h", "#include \"problems/problem.h\"\n");
    write("optimizers/judging.cpp", "#include <cmath>\n\n#include \"optimizers/meter.h\"\n");
    write("optimizers/shared.h", "// shared\n");
    write("optimizers/shared.cpp", "#include \"optimizers/shared.h\"\n");
    write("optimizers/adam.cpp", "#include \"optimizers/shared.h\"\nvoid register_adam();\n");
    write("optimizers/gd.cpp", "#include \"optimizers/meter.h\"\nvoid register_gd();\n");
    write("benchmarks/run/execute.cpp",
          "#include \"core/records/record.h\"\n#include \"optimizers/meter.h\"\n");
    write("benchmarks/run/progress.cpp", "// no part of a result\n");
  }
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file) << text;
  }
  void edit(const fs::path& file) const {
    std::ofstream(folder_.path() / file, std::ios::app) << "// edited\n";
  }

  // The exit status of writing the table.
  int run_digests() const {
    const std::string command = "cmake -DROOT=" + folder_.path().string() +
                                " -DOUTPUT=" + (folder_.path() / "table.cpp").string() +
                                " -P " ISOLINE_SOURCE_DIR "/cmake/SourceDigests.cmake";
    return std::system((command + " >/dev/null 2>&1").c_str());
  }

  // The lines of the table, as the build writes them.
  std::set<std::string> table() const {
    EXPECT_EQ(run_digests(), 0);
    std::ifstream in(folder_.path() / "table.cpp");
    std::set<std::string> lines;
    for (std::string line; std::getline(in, line);)
      if (line.starts_with("      {\"")) lines.insert(line.substr(7));
    EXPECT_EQ(lines.size(), 5U);  // harness, unet, heat, adam, gd
    return lines;
  }

  // The names whose digests an edit of this file changes.
  std::set<std::string> changed_by(const fs::path& file) const {
    const std::set<std::string> before = table();
    edit(file);
    std::set<std::string> names;
    for (const std::string& line : table())
      if (!before.contains(line)) names.insert(line.substr(1, line.find('"', 1) - 1));
    return names;
  }

 private:
  TemporaryFolder folder_;
};

using Names = std::set<std::string>;

TEST(Builds, AnEditOfOneOptimizerChangesItsPartAndNoOther) {
  const SmallTree tree;
  EXPECT_EQ(tree.changed_by("optimizers/gd.cpp"), Names{"optimizers/gd.cpp"});
  EXPECT_EQ(tree.changed_by("problems/heat.cpp"), Names{"problems/heat.cpp"});
  EXPECT_EQ(tree.changed_by("optimizers/shared.h"), Names{"optimizers/adam.cpp"});
  EXPECT_EQ(tree.changed_by("optimizers/shared.cpp"), Names{"optimizers/adam.cpp"});
}

// forward.cpp has no header of its own and includes one of the harness first.
TEST(Builds, AnEditOfThePartsOfANetworkChangesThatNetworkAndNoOther) {
  const SmallTree tree;
  for (const char* file :
       {"networks/unet.cpp", "networks/unet/passes.h", "networks/unet/forward.cpp"})
    EXPECT_EQ(tree.changed_by(file), Names{"networks/unet.cpp"}) << file;
  EXPECT_EQ(tree.changed_by("networks/network.h"), (Names{"harness"}));
}

TEST(Builds, AFileThatNoDigestCoversStopsTheBuild) {
  const SmallTree tree;
  tree.write("networks/unet/backward.cpp", "#include \"core/threads.h\"\n");
  EXPECT_NE(tree.run_digests(), 0);
  tree.write("networks/unet/backward.cpp", "#include \"networks/unet/passes.h\"\n");
  EXPECT_EQ(tree.run_digests(), 0);
}

TEST(Builds, AnEditOfTheCoreOrTheRunLoopChangesTheHarness) {
  const SmallTree tree;
  for (const char* file : {"core/array.h", "problems/problem.cpp", "optimizers/meter.h",
                           "optimizers/judging.cpp", "benchmarks/run/execute.cpp"})
    EXPECT_EQ(tree.changed_by(file), Names{"harness"}) << file;
  for (const char* file : {"core/records/record.h", "benchmarks/run/progress.cpp"})
    EXPECT_EQ(tree.changed_by(file), Names{}) << file;
}

TEST(Builds, EveryComponentOfTheTreeHasADigestOfItsOwn) {
  const Catalog catalog = builtin_catalog();
  std::set<std::string> problems, optimizers;
  for (const auto& [name, entry] : catalog.problems) problems.insert(source_digest(entry.file));
  for (const auto& [name, entry] : catalog.optimizers) optimizers.insert(source_digest(entry.file));
  EXPECT_GE(problems.size(), 12U);    // families of problems and of methods
  EXPECT_GE(optimizers.size(), 14U);  // share a file
  EXPECT_TRUE(tree_sources().contains("harness"));
  EXPECT_EQ(source_digest("/somewhere/problems/heat.cpp"), tree_sources().at("problems/heat.cpp"));
}

TEST(Builds, OfAProgramBuiltElsewhereAreOfItsOwnFiles) {
  const std::string whole = source_digest("mine/twist.cpp");  // nobody lists it: the whole program
  set_program_sources("mine/twist.cpp 0123456789abcdef\nmain.cpp fedcba9876543210\n");
  EXPECT_EQ(source_digest("/home/me/mine/twist.cpp"), "0123456789abcdef");
  EXPECT_EQ(source_digest("other.cpp"), whole);
}

TEST(Builds, PartsAreThoseOfPlatformHarnessProblemOptimizerAndNetwork) {
  const Catalog catalog = builtin_catalog();
  const auto parts_of = [&](const std::string& problem, const std::string& optimizer) {
    return build_parts(named({.problem = complete_problem(catalog, parse_spec(problem)),
                              .optimizer = complete_optimizer(catalog, parse_spec(optimizer))}));
  };
  const BuildParts direct = parts_of("sine", "sip"), learned = parts_of("sine[mode=learn]", "sip");
  EXPECT_EQ(direct.at("platform"), platform_digest());
  EXPECT_EQ(direct.at("problem"), tree_sources().at("problems/sine.cpp"));
  EXPECT_FALSE(direct.contains("network"));
  EXPECT_EQ(learned.at("network"), tree_sources().at("networks/mlp.cpp"));
  EXPECT_NE(direct.at("optimizer"), learned.at("optimizer"));  // gd inside, or Adam
  EXPECT_EQ(parts_of("sine", "gd").at("optimizer"), tree_sources().at("optimizers/gd.cpp"));
  EXPECT_EQ(learned.at("optimizer"),
            parts_of("sine[mode=learn]", "sip[network-optimizer=adam[rate=0.1]]").at("optimizer"));
}

TEST(Builds, WhatWasAskedIsTheSpecAsTyped) {
  const Catalog catalog = builtin_catalog();
  const auto asked = [&](const std::string& text) {
    return complete_optimizer(catalog, parse_spec(text)).asked;
  };
  EXPECT_EQ(asked("adam"), "adam");
  EXPECT_EQ(asked("adam[lr=1e-1]"), "adam[rate=0.1]");
  EXPECT_EQ(asked("adam[rate=1e-3]"), "adam[rate=0.001]");  // the default, and typed
  Rates::Row row;
  row.options.set("rate", std::string("0.5"));
  const Component tuned = with_rates(catalog, parse_spec("adam"), &row);
  EXPECT_EQ(tuned.asked, "adam");
  EXPECT_EQ(tuned.spec, "adam[rate=0.5]");
  const Request request =
      named({.problem = complete_problem(catalog, parse_spec("sine[xi=10]")), .optimizer = tuned});
  EXPECT_EQ(request_from_json(to_json(request)).problem.asked, "sine[xi=10]");
  EXPECT_EQ(request_from_json(to_json(request)).optimizer.asked, "adam");
}

TEST(Builds, AnUntrackedSourceMakesTheTreeDirty) {
  const TemporaryFolder folder;
  const std::string there = folder.path().string(), info = there + "/build/info.h";
  const auto is_dirty = [&] {
    shell("cmake -DSOURCE=" + there + " -DOUTPUT=" + info +
          " -DFILES= -P " ISOLINE_SOURCE_DIR "/cmake/BuildInfo.cmake");
    return read_text(info).find("kDirty = true") != std::string::npos;
  };
  std::ofstream(folder.path() / ".gitignore") << "build/\n";
  shell("git -C " + there + " init -q && git -C " + there + " add . && git -C " + there +
        " -c user.name=a -c user.email=a@example.org commit -q -m a");
  std::ofstream(folder.path() / "notes.txt") << "no source\n";
  EXPECT_FALSE(is_dirty());
  fs::create_directories(folder.path() / "problems");
  std::ofstream(folder.path() / "problems/x.cpp") << "// new\n";
  EXPECT_TRUE(is_dirty());
}

// Two cells of the same request, of which the second fails; then another build.
class OtherBuild : public testing::Test {
 protected:
  OtherBuild() {
    requests = {request_for(catalog, "square", {}, "gd", {}),
                request_for(catalog, "square", {}, "hostile", {})};
    run(false);
    for (Request& request : requests) request.optimizer.sources = "0000000000000000";
  }
  Outcome run(bool reuse) {
    Store store(folder.path());
    return run_all(catalog, requests, store, {.reuse = reuse});
  }
  Catalog catalog = hostile_catalog();
  TemporaryFolder folder;
  std::vector<Request> requests;
};

TEST_F(OtherBuild, IsNotTakenForThisOne) {
  const Outcome outcome = run(false);
  EXPECT_EQ(outcome.reused, 0);
  EXPECT_EQ(outcome.run, 2);
  const auto record = Store(folder.path()).find(requests[0]);
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->build_parts.at("optimizer"), "0000000000000000");
  EXPECT_EQ(record->build, build_digest(requests[0]));
}

TEST_F(OtherBuild, IsReusedWhereThatIsAskedAndItsFailuresRunAgain) {
  const Outcome outcome = run(true);
  EXPECT_EQ(outcome.reused, 1);
  EXPECT_EQ(outcome.reused_from_other_builds, 1);
  EXPECT_EQ(outcome.run, 1);  // what failed
  EXPECT_EQ(outcome.statuses.at(Status::failed), 1);
}

}  // namespace
}  // namespace isoline::benchmarks
