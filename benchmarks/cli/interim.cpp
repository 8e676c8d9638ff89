// Until core has them.
#include "benchmarks/cli/interim.h"

#include <nlohmann/json.hpp>

#include "core/records/provenance.h"
namespace isoline {
std::string json_text(const Json& value, int indent) { return value.dump(indent); }
void set_program_tree(std::string commit, bool is_dirty) {
  Json& known = const_cast<Json&>(provenance());
  known["isoline_commit"] = known["commit"];
  known["commit"] = std::move(commit);
  known["dirty"] = is_dirty;
}
}  // namespace isoline
