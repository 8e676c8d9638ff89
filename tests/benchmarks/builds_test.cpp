// The digest of a build: an edit changes the digest of its own part only, and a record of another
// build is not reused.

#include <fstream>
#include <set>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "benchmarks/run/runner.h"
#include "core/files.h"
#include "core/records/provenance.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/hostile.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

// A tree in small: two optimizers that share a header, one problem, records and a run loop.
class SmallTree {
 public:
  SmallTree() {
    const std::string network = "#include \"networks/network.h\"\n",
                      problem = "#include \"problems/problem.h\"\n",
                      passes = "#include \"networks/unet/passes.h\"\n",
                      meter = "#include \"optimizers/meter.h\"\n",
                      shared = "#include \"optimizers/shared.h\"\n";
    for (const auto& [file, text] : std::map<std::string, std::string>{
             {"core/array.h", "// arrays\n"},
             {"core/records/record.h", "// records\n"},
             {"core/threads.h", "// threads\n"},
             {"networks/network.h", "#include \"core/array.h\"\n"},
             {"networks/unet/passes.h", network},
             {"networks/unet/forward.cpp", "#include \"core/threads.h\"\n" + passes},
             {"networks/unet.cpp", passes + "void register_unet();\n"},
             {"problems/problem.h", network},
             {"problems/problem.cpp", problem},
             {"problems/heat.cpp", problem + "void register_heat();\n"},
             {"optimizers/meter.h", problem},
             {"optimizers/judging.cpp", "#include <cmath>\n\n" + meter},
             {"optimizers/shared.h", "// shared\n"},
             {"optimizers/shared.cpp", shared},
             {"optimizers/adam.cpp", shared + "void register_adam();\n"},
             {"optimizers/gd.cpp", meter + "void register_gd();\n"},
             {"benchmarks/run/execute.cpp", "#include \"core/records/record.h\"\n" + meter},
             {"benchmarks/run/progress.cpp", "// no part of a result\n"}})
      write(file, text);
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

// forward.cpp has no header of its own and includes one of the harness first.
TEST(Builds, AnEditChangesThePartThatItBelongsToAndNoOther) {
  const SmallTree tree;
  for (const auto& [part, files] : std::map<std::string, std::vector<const char*>>{
           {"optimizers/gd.cpp", {"optimizers/gd.cpp"}},
           {"problems/heat.cpp", {"problems/heat.cpp"}},
           {"optimizers/adam.cpp", {"optimizers/shared.h", "optimizers/shared.cpp"}},
           {"networks/unet.cpp",
            {"networks/unet.cpp", "networks/unet/passes.h", "networks/unet/forward.cpp"}},
           {"harness",
            {"networks/network.h", "core/array.h", "problems/problem.cpp", "optimizers/meter.h",
             "optimizers/judging.cpp", "benchmarks/run/execute.cpp"}}})
    for (const char* file : files)
      EXPECT_EQ(tree.changed_by(file), std::set<std::string>{part}) << file;
  for (const char* file : {"core/records/record.h", "benchmarks/run/progress.cpp"})
    EXPECT_EQ(tree.changed_by(file), std::set<std::string>{}) << file;
}

TEST(Builds, AFileThatNoDigestCoversStopsTheBuild) {
  const SmallTree tree;
  tree.write("networks/unet/backward.cpp", "#include \"core/threads.h\"\n");
  EXPECT_NE(tree.run_digests(), 0);
  tree.write("networks/unet/backward.cpp", "#include \"networks/unet/passes.h\"\n");
  EXPECT_EQ(tree.run_digests(), 0);
}

TEST(Builds, EveryComponentOfTheTreeHasADigestOfItsOwn) {
  std::set<std::string> problems, optimizers;
  for (const auto& [name, entry] : catalog().problems) problems.insert(source_digest(entry.file));
  for (const auto& [name, entry] : catalog().optimizers)
    optimizers.insert(source_digest(entry.file));
  EXPECT_GE(problems.size(), 12U);    // families of problems and of methods
  EXPECT_GE(optimizers.size(), 14U);  // share a file
  EXPECT_TRUE(tree_sources().contains("harness"));
  EXPECT_EQ(source_digest("/somewhere/problems/heat.cpp"), tree_sources().at("problems/heat.cpp"));
}

TEST(Builds, OfAProgramBuiltElsewhereAreOfItsOwnFiles) {
  const std::string whole = source_digest("mine/twist.cpp");  // not listed: the whole program
  set_program_sources("mine/twist.cpp 0123456789abcdef\nmain.cpp fedcba9876543210\n");
  EXPECT_EQ(source_digest("/home/me/mine/twist.cpp"), "0123456789abcdef");
  EXPECT_EQ(source_digest("other.cpp"), whole);
}

TEST(Builds, PartsAreThoseOfPlatformHarnessProblemOptimizerAndNetwork) {
  const auto parts_of = [](const std::string& problem, const std::string& optimizer) {
    return build_parts(cell_of(problem, optimizer));
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
  const auto asked = [](const std::string& text) {
    return complete_optimizer(catalog(), parse_spec(text)).asked;
  };
  EXPECT_EQ(asked("adam"), "adam");
  EXPECT_EQ(asked("adam[lr=1e-1]"), "adam[rate=0.1]");
  EXPECT_EQ(asked("adam[rate=1e-3]"), "adam[rate=0.001]");  // the default, and typed
  Rates::Row row;
  row.options.set("rate", std::string("0.5"));
  const Component tuned = with_rates(catalog(), parse_spec("adam"), &row);
  EXPECT_EQ(tuned.asked, "adam");
  EXPECT_EQ(tuned.spec, "adam[rate=0.5]");
  const Request request = named(
      {.problem = complete_problem(catalog(), parse_spec("sine[xi=10]")), .optimizer = tuned});
  EXPECT_EQ(request_from_json(to_json(request)).problem.asked, "sine[xi=10]");
  EXPECT_EQ(request_from_json(to_json(request)).optimizer.asked, "adam");
}

TEST(Builds, AnUntrackedSourceMakesTheTreeDirty) {
  const TemporaryFolder folder;
  const std::string there = folder.path().string(), info = there + "/build/info.h";
  const auto shell = [](const std::string& command) {
    EXPECT_EQ(std::system((command + " >/dev/null 2>&1").c_str()), 0) << command;
  };
  const auto is_dirty = [&] {
    shell("cmake -DSOURCE=" + there + "/core -DOUTPUT=" + info +
          " -DFILES= -P " ISOLINE_SOURCE_DIR "/cmake/BuildInfo.cmake");
    return read_text(info).find("kDirty = true") != std::string::npos;
  };
  fs::create_directories(folder.path() / "core");  // as of the target that asks
  std::ofstream(folder.path() / "core/CMakeLists.txt");
  std::ofstream(folder.path() / ".gitignore") << "build/\n";
  shell("git -C " + there + " init -q && git -C " + there + " add . && git -C " + there +
        " -c user.name=a -c user.email=a@example.org commit -q -m a");
  std::ofstream(folder.path() / "notes.txt") << "no source\n";
  EXPECT_FALSE(is_dirty());
  fs::create_directories(folder.path() / "problems");
  std::ofstream(folder.path() / "problems/x.cpp") << "// new\n";
  EXPECT_TRUE(is_dirty());
}

// Two cells, of which the second fails; then another build.
TEST(Builds, ARecordOfAnotherIsReusedWhereThatIsAskedWithoutItsFailures) {
  const Catalog catalog = hostile_catalog();
  const TemporaryFolder folder;
  Store store(folder.path());
  std::vector<Request> requests = {request_for(catalog, "square", {}, "gd", {}),
                                   request_for(catalog, "square", {}, "hostile", {})};
  run_all(catalog, requests, store, {});
  for (Request& request : requests) request.optimizer.sources = "0000000000000000";
  const Outcome reused = run_all(catalog, requests, store, {.reuse = true});
  EXPECT_EQ(reused.reused, 1);
  EXPECT_EQ(reused.reused_from_other_builds, 1);
  EXPECT_EQ(reused.run, 1);  // what failed
  EXPECT_EQ(reused.statuses.at(Status::failed), 1);
  requests.pop_back();
  const Outcome own = run_all(catalog, requests, store, {});
  EXPECT_EQ(own.reused, 0);
  EXPECT_EQ(own.run, 1);
  const auto record = store.find(requests[0]);
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->build_parts.at("optimizer"), "0000000000000000");
  EXPECT_EQ(record->build, build_digest(requests[0]));
}

}  // namespace
}  // namespace isoline::benchmarks
