// Every registered component says what it is, where the tree says it lives.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "benchmarks/plan/catalog.h"
#include "networks/network.h"
#include "tests/structure/sources.h"

namespace isoline::benchmarks {

using networks::network_registry;
using optimizers::register_optimizers;
using problems::register_problems;
namespace {

const Catalog& catalog() {
  static const Catalog all = builtin_catalog();
  return all;
}

// The files of a room that register something.
std::vector<Source> component_files(const std::string& room) {
  std::vector<Source> files;
  for (const Source& source : sources()) {
    if (source.room() != room || source.is_header()) continue;
    if (source.text.find("void register_" + source.stem() + "(") == std::string::npos) continue;
    files.push_back(source);
  }
  return files;
}

// A file is named after its entry, or its entries begin with its name, or it quotes their names.
bool belongs(const std::string& entry, const Source& file) {
  std::string name = file.stem();
  std::ranges::replace(name, '_', '-');
  return entry == name || entry.starts_with(name + "-") ||
         file.text.find("\"" + entry + "\"") != std::string::npos;
}

template <class Entries>
void expect_files_and_entries_agree(const std::string& room, const Entries& entries) {
  const std::vector<Source> files = component_files(room);
  EXPECT_GE(files.size(), 3U) << room << ": the components were not found";
  for (const auto& [name, entry] : entries)
    EXPECT_TRUE(std::ranges::any_of(files, [&](const auto& file) { return belongs(name, file); }))
        << name << " is in no file of " << room;
  for (const Source& file : files)
    EXPECT_TRUE(std::ranges::any_of(entries, [&](const auto& e) { return belongs(e.first, file); }))
        << room << "/" << file.stem() << " names nothing that it adds";
}

TEST(Components, AreInFilesThatNameThem) {
  expect_files_and_entries_agree("problems", catalog().problems);
  expect_files_and_entries_agree("optimizers", catalog().optimizers);
  expect_files_and_entries_agree("networks", network_registry());
}

template <class Entry>
void expect_described(const Entry& entry) {
  EXPECT_FALSE(entry.title.empty()) << entry.name;
  EXPECT_FALSE(entry.formula.empty()) << entry.name;
  EXPECT_FALSE(entry.source.empty()) << entry.name;
  std::set<std::string> options;
  for (const OptionField& option : entry.options) {
    EXPECT_FALSE(option.doc.empty()) << entry.name << ": " << option.name;
    EXPECT_TRUE(options.insert(option.name).second) << entry.name << ": " << option.name;
    EXPECT_NE(option.name, "lr") << entry.name << ": the option is `rate` everywhere";
  }
  if (entry.needs_argument.empty())
    return;  // else it is not meant by "*", and says how it is named
  EXPECT_FALSE(entry.in_all) << entry.name;
  EXPECT_TRUE(entry.needs_argument.starts_with(entry.name + "[")) << entry.needs_argument;
}

TEST(Components, HaveATitleAFormulaASourceAndDocumentedOptions) {
  for (const auto& [name, entry] : catalog().problems) expect_described(entry);
  for (const auto& [name, entry] : catalog().optimizers) expect_described(entry);
}

TEST(Components, DefaultsAreWithinTheirOwnRanges) {
  for (const auto& [name, entry] : catalog().problems.ready())
    EXPECT_NO_THROW(complete_problem(catalog(), name, OptionValues())) << name;
  for (const auto& [name, entry] : catalog().optimizers.ready()) {
    const OptionValues defaults = complete_optimizer(catalog(), name, OptionValues()).options;
    EXPECT_NO_THROW(complete_optimizer(catalog(), name, defaults)) << name;
  }
}

// A component that vanishes is missed here.
const std::string kProblems =
    "scaling square exponential sine poisson heat rosenbrock powell-singular beale "
    "helical-valley brown-badly-scaled box3d wood brown-dennis broyden-tridiagonal "
    "variably-dimensioned hig-toy linear-chain coupled-oscillators quantum-dipole poisson-hig "
    "burgers wave-packet navier-stokes process";
const std::string kOptimizers =
    "gd momentum nesterov adagrad adadelta rmsprop adam adamw newton saddle-free-newton "
    "gauss-newton levenberg-marquardt inverse-gradient sip sip-theorem-3 sip-newton hig supervised "
    "two-stage rescaled "
    "adahessian hessian-free kfac ceres-gauss-newton ceres-lm ceres-dogleg "
    "ceres-subspace-dogleg ceres-bfgs ceres-lbfgs ceres-ncg ceres-steepest-descent "
    "nlopt-lbfgs nlopt-var2 nlopt-tnewton nlopt-slsqp nlopt-mma nlopt-ccsaq nlopt-bobyqa "
    "nlopt-cobyla nlopt-neldermead nlopt-sbplx levenberg-marquardt-cg process";

template <class Entries>
void expect_all_there(const std::string& names, const Entries& entries) {
  std::istringstream all(names);
  for (std::string name; all >> name;) EXPECT_TRUE(entries.contains(name)) << name;
}

TEST(Components, AllThatWereFoundedAreThere) {
  expect_all_there(kProblems, catalog().problems);
  expect_all_there(kOptimizers, catalog().optimizers);
}

TEST(Components, ANameRegisteredTwiceIsAnError) {
  Catalog twice = builtin_catalog();
  EXPECT_THROW(register_problems(twice.problems), UsageError);
  EXPECT_THROW(register_optimizers(twice.optimizers), UsageError);
}

}  // namespace
}  // namespace isoline::benchmarks
