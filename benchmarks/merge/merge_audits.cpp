// Joins audits by the name of the optimizer.
#include "benchmarks/merge/merge_audits.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/audited.h"

namespace isoline::benchmarks {
namespace fs = std::filesystem;

namespace {

struct Source {
  Json audit;
  fs::path folder;
};

void read_old_disputes(const fs::path& folder, AuditUnion& out) {
  for (const std::string& name : disputed_in(folder).audits)
    if (out.disputed.insert(name).second)
      out.conflicts.push_back(
          {name, fmt::format("its audit: in conflict since an earlier merge ({})",
                             (folder / "conflicts.json").string())});
}

// As they are written again, so that equal measurements have equal text; none where it is damaged.
std::vector<AuditedOptimizer> audits_in(const fs::path& file, AuditUnion& out) {
  try {
    return audit_from_json(parse_json(read_text(file, kMostBytes, Links::refused), file.string()));
  } catch (const std::exception& error) {
    out.unreadable.push_back(fmt::format("{} is no audit: {}", file.string(), error.what()));
    return {};
  }
}

}  // namespace

AuditUnion unite_audits(const std::vector<fs::path>& folders) {
  AuditUnion out;
  for (const fs::path& folder : folders) read_old_disputes(folder, out);
  std::map<std::string, Source> by_name;
  bool is_any = false;
  for (const fs::path& folder : folders) {
    const fs::path file = folder / "audit.json";
    if (!is_there(file)) continue;
    is_any = true;
    for (const AuditedOptimizer& audited : audits_in(file, out)) {
      const auto [known, is_new] =
          by_name.try_emplace(audited.name, Source{to_json(audited), folder});
      if (is_new || known->second.audit == to_json(audited)) continue;
      if (out.disputed.insert(audited.name).second)
        out.conflicts.push_back(
            {audited.name, fmt::format("its audit: {} and {} measured different things",
                                       known->second.folder.string(), folder.string())});
    }
  }
  if (!is_any) return out;
  Json all = audit_to_json({});
  for (const auto& [name, source] : by_name)
    if (!out.disputed.contains(name)) all["optimizers"].push_back(source.audit);
  out.json = std::make_shared<const Json>(std::move(all));
  return out;
}

}  // namespace isoline::benchmarks
