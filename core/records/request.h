// The request of a run: a problem, an optimizer, a seed and a budget; and the plan of many.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/options.h"
#include "core/status.h"

namespace isoline {

using Json = nlohmann::json;
class JsonView;

// A component as requested, created once, where a command line, a suite or a record is read: its
// name and all its options, with defaults filled in.
struct Component {
  std::string name;
  OptionValues options;
  std::string spec;         // "sine[xi=32]": the name and what differs from the defaults
  std::string asked;        // the spec as typed, defaults and rates unfilled; old records: empty
  bool is_learned = false;  // a problem over a distribution of y*, solved by a network
  // Digests of what computes it, not in the record's request; the second where it learns: of a
  // problem its network's, of an optimizer its own and those of what steps inside it.
  std::string sources = {}, learning_sources = {};
  std::optional<Foreign> foreign = {};  // the external program, if there is one; see above
};

// Whether complete options select the learning problem. Only this function decides it.
bool asks_to_learn(const OptionValues& options);
// Whether the direct problem with these options is an instance of what the learning one of the same
// name learns: all options agree but those of learning itself.
bool is_instance_of(OptionValues direct, OptionValues learned);

struct Request {
  Component problem, optimizer;
  std::uint64_t seed = 0;
  Budget budget;
  int threads = 1;
  std::string rates;  // the file under benchmarks/rates that set options, or empty; not in the cell
  double hard_seconds = 0;  // when it is killed; 0: the runner's own limit; not in the record
  std::string cell;         // the digest of the request; `named` sets it
};

// How the values of a table of rates were found, by the name of its file: a grid of this project's
// writes NAME-tuned.json, every other table is as published, by its paper or by its user.
enum class RatesKind { none, published, tuned };
RatesKind kind_of_rates(const std::string& file);

std::string cell_digest(const Request& request);

// The cells of requests that differ in their seeds alone: what they share is written once.
class CellNames {
 public:
  explicit CellNames(const Request& request);
  std::string of(std::uint64_t seed) const;

 private:
  std::string before_, after_;  // of the digested text, around the seed
};

// Digests of all that may change a result besides the request, by part: platform, harness, problem,
// optimizer, network.
using BuildParts = std::map<std::string, std::string>;
Request named(Request request);  // with its cell

Json to_json(const Request& request);
Request request_from_json(const Json& json);
Budget budget_from(const JsonView& json);

// Schema isoline.plan/1: every cell ever planned in a result folder, in order.
struct PlannedCell {
  std::string cell, problem, optimizer;  // digest and specs
  std::uint64_t seed = 0;
};
struct Plan {
  std::vector<std::string> suites;  // each with its version, "quick@1"; without one, it is 1
  std::vector<PlannedCell> cells;
};
// Adds a suite that is not there yet. UsageError if another version of it is there: the settings of
// two versions differ, so their results never stand in one ranking.
void add_suite(std::vector<std::string>& suites, const std::string& suite);
std::string file_text(const Plan& plan);
Json to_json(const Plan& plan);
Plan plan_from_text(const std::string& text, const std::string& origin);
Json plan_schema();  // what benchmarks/schemas/plan.json holds

// The largest size of a record or of its snapshots; ours have some ten thousand bytes.
inline constexpr std::size_t kMostRecordBytes = std::size_t{64} << 20;

}  // namespace isoline
