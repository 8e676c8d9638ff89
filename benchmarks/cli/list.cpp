// isoline list: what there is.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/cli/verbs.h"
#include "benchmarks/plan/resources.h"
#include "benchmarks/plan/suite.h"
#include "core/json.h"
#include "networks/network.h"

namespace isoline::benchmarks {

using networks::network_registry;
namespace {

struct ListOptions {
  std::string kind = "all";
  bool as_json = false, names_only = false;
};

Json listing(Session& session, const std::string& kind) {
  Json all = Json::object();
  if (kind == "all" || kind == "problems")
    for (const auto& [name, entry] : session.catalog().problems)
      all["problems"].push_back({{"name", name}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "networks")
    for (const auto& [name, entry] : network_registry())
      all["networks"].push_back({{"name", name}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "optimizers")
    for (const auto& [name, entry] : session.catalog().optimizers)
      all["optimizers"].push_back({{"name", name},
                                   {"title", entry.title},
                                   {"family", name_of(entry.family)},
                                   {"source", entry.source}});
  if (kind == "all" || kind == "suites")
    for (const auto& [name, text] : builtin_suites())
      all["suites"].push_back({{"name", name}, {"title", read_suite(name).title}});
  return all;
}

void print(const Json& all, bool names_only) {
  for (const auto& [kind, entries] : all.items()) {
    if (!names_only) fmt::print("{} {}\n", entries.size(), kind);
    for (const Json& entry : entries) {
      const auto name = entry.at("name").get<std::string>();
      if (names_only)
        fmt::print("{}\n", name);
      else
        fmt::print("  {:24} {}\n", name, entry.at("title").get<std::string>());
    }
    if (!names_only) fmt::print("\n");
  }
  if (!names_only) fmt::print("isoline describe NAME tells more of each.\n");
}

}  // namespace

void add_list(CLI::App& app, Session& session) {
  const auto options = std::make_shared<ListOptions>();
  CLI::App* verb = app.add_subcommand("list", "List the problems, networks, optimizers and suites");
  verb->add_option("KIND", options->kind, "problems, networks, optimizers, suites or all")
      ->check(CLI::IsMember({"problems", "networks", "optimizers", "suites", "all"}))
      ->capture_default_str();
  verb->add_flag("--json", options->as_json, "As JSON");
  verb->add_flag("--names", options->names_only, "Names only, one a line");
  verb->callback([options, &session] {
    const Json all = listing(session, options->kind);
    if (options->as_json)
      fmt::print("{}\n", all.dump(2));
    else
      print(all, options->names_only);
  });
}

}  // namespace isoline::benchmarks
