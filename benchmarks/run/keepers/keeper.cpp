// The places of the keepers' data in a trace.
#include "benchmarks/run/keepers/keeper.h"

#include <sstream>

#include "core/errors.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

// use(keeper, its place among the bytes of the trace), in their order.
template <class Use>
void for_each_keeper(const Use& use) {
  constexpr std::size_t kLine = 64;  // bytes, to which each is aligned
  std::size_t at = 0;
  for (const Keeper& keeper : keepers()) {
    use(keeper, at);
    at += (keeper.bytes + kLine - 1) / kLine * kLine;
    require(at <= Trace::kKept, "the data of the keepers have no room in a trace");
  }
}

}  // namespace

optimizers::Observers open_keepers(Trace& trace) {
  optimizers::Observers observers;
  for_each_keeper([&](const Keeper& keeper, std::size_t at) {
    keeper.construct(trace.kept + at);
    observers.push_back(keeper.observe(trace.kept + at));
  });
  trace.has_kept = true;
  return observers;
}

std::string defect_of_all(const Trace& trace) {
  std::string defect = defect_of(trace);
  if (!defect.empty() || !trace.has_kept) return defect;
  for_each_keeper([&](const Keeper& keeper, std::size_t at) {
    if (defect.empty()) defect = keeper.defect(trace.kept + at);
  });
  return defect;
}

void write_parts(const Trace& trace, Parts& parts) {
  if (!trace.has_kept) return;
  for_each_keeper(
      [&](const Keeper& keeper, std::size_t at) { keeper.write(trace.kept + at, trace, parts); });
}

std::vector<std::string> lines_of(const char* text) {
  std::vector<std::string> lines;
  std::istringstream in(valid_utf8(text));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace isoline::benchmarks
