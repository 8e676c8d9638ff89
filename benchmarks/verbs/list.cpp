// isoline list: lists problems, networks, optimizers and suites.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "benchmarks/cli/verb.h"
#include "benchmarks/plan/catalog.h"
#include "benchmarks/plan/suite.h"
#include "core/json.h"
#include "core/text.h"
#include "networks/network_entry.h"

namespace isoline::benchmarks {

using networks::network_registry;
namespace {

struct ListArguments {
  std::string kind = "all";
  bool as_json = false, names_only = false;
};

void declare(VerbArguments& verb, ListArguments& given) {
  verb.text("KIND", given.kind, "problems, networks, optimizers, suites or all")
      .one_of({"problems", "networks", "optimizers", "suites", "all"})
      .shown();
  verb.flag("--json", given.as_json, "Print JSON");
  verb.flag("--names", given.names_only, "Print names only, one per line");
  verb.plugins();
}

template <class Entry>
const std::string& name_to_give(const Entry& entry) {
  return entry.needs_argument.empty() ? entry.name : entry.needs_argument;
}

Json listing(Session& session, const std::string& kind) {
  Json all = Json::object();
  if (kind == "all" || kind == "problems")
    for (const auto& [name, entry] : session.catalog().problems)
      all["problems"].push_back(
          {{"name", name_to_give(entry)}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "networks")
    for (const auto& [name, entry] : network_registry())
      all["networks"].push_back({{"name", name}, {"title", entry.title}, {"source", entry.source}});
  if (kind == "all" || kind == "optimizers")
    for (const auto& [name, entry] : session.catalog().optimizers)
      all["optimizers"].push_back({{"name", name_to_give(entry)},
                                   {"title", entry.title},
                                   {"family", name_of(entry.family)},
                                   {"source", entry.source}});
  if (kind == "all" || kind == "suites")
    for (const auto& [name, text] : builtin_suites())
      all["suites"].push_back({{"name", name},
                               {"title", read_suite(name).title},
                               {"version", read_suite(name).version}});
  return all;
}

void print(const Json& all, bool names_only) {
  for (const auto& [kind, entries] : all.items()) {
    if (!names_only) say(stdout, fmt::format("{} {}\n", entries.size(), kind));
    for (const Json& entry : entries) {
      const auto name = entry.at("name").get<std::string>();
      if (names_only)
        say(stdout, fmt::format("{}\n", name));
      else
        say(stdout, fmt::format("  {:24} {}\n", name, entry.at("title").get<std::string>()));
    }
    if (!names_only) say(stdout, "\n");
  }
  if (!names_only) say(stdout, "`isoline describe NAME` shows the details.\n");
}

int run(const ListArguments& given, Session& session) {
  const Json all = listing(session, given.kind);
  if (given.as_json)
    say(stdout, fmt::format("{}\n", json_text(all, 2)));
  else
    print(all, given.names_only);
  return kGood;
}

}  // namespace

void register_list(VerbRegistry& registry) {
  registry.add(verb_of({.name = "list",
                        .help_position = 140,
                        .summary = "List the problems, networks, optimizers and suites",
                        .examples = "  isoline list\n  isoline list optimizers --names"},
                       declare, run));
}

}  // namespace isoline::benchmarks
