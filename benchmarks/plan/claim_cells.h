// Claims of papers: sentences with a published value, the cells that decide them, and the values
// that are read from these cells. Reports judge the claims; this module reads them and finds their
// cells.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/plan/suite.h"
#include "core/records/record.h"

namespace isoline::benchmarks {

using Json = nlohmann::json;

struct Claim {
  std::string group;  // the file it stands in
  std::string id, sentence;
  std::shared_ptr<const Json> json;  // as reports/sections/evidence.h says, its cells by digests
  // One of each set of cells, the longest first.
  struct Cells {
    bool is_long = false;  // takes hours: runs only with --long
    std::vector<Request> requests;
  };
  std::vector<Cells> cells;
};

// The claims of one file; UsageError if it is invalid, or if a term is not among its cells.
std::vector<Claim> claims_from_json(const Catalog& catalog, const Rates& rates, const Json& file,
                                    const std::string& origin);
std::vector<Claim> builtin_claims_of(const Catalog& catalog);

// Those with these ids, or of these groups; all without any. UsageError names the nearest.
std::vector<Claim> chosen_claims(std::vector<Claim> claims, const std::vector<std::string>& names);

// The cells of these claims, each once; long ones only on request.
std::vector<Request> cells_of(const std::vector<Claim>& claims, bool with_long);

Json json_of(const std::vector<Claim>& claims);  // a list, for the report

std::string_view
embedded_papers();  // benchmarks/papers.json: the contents of the texts, and the scripts

// The records of runs that take hours, by name of file. `published_records` reads them, and
// gives options that a component got later their defaults, so that claims find them.
const std::map<std::string, std::string_view>& builtin_published();
std::vector<Record> published_records(const Catalog& catalog);

}  // namespace isoline::benchmarks
