// Pictures of a sample: what was observed, what each method inferred, and what was to be found.
#include <optional>
#include <span>

#include "reports/sections/panels.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Picture picture_of(std::string title, std::span<const float> field, Index N) {
  return {std::move(title), N, {field.begin(), field.end()}};
}

}  // namespace

Figure picture_figure(const Comparison& c, std::size_t p) {
  Figure out;
  std::vector<Picture> inferred;
  FieldFrames last;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (const std::size_t run : c.cell(p, s).runs) {
      const Record* record = c.runs[run].record;
      std::optional<FieldFrames> shown = c.study->fields_of(*record);
      if (!shown || !shown->has_truth() || shown->shape[1] != shown->shape[2]) continue;
      const std::span<const float> x = shown->x(shown->iterations.size() - 1);
      inferred.push_back(picture_of(shown_spec(c.optimizers[s].label), x, shown->shape[1]));
      last = std::move(*shown);
      break;
    }
  if (inferred.empty()) return out;
  out.pictures.push_back(picture_of("y*", last.target(), last.shape[1]));
  for (Picture& picture : inferred) out.pictures.push_back(std::move(picture));
  out.pictures.push_back(picture_of("x*", last.truth(), last.shape[1]));
  out.reading =
      "The first sample of the validation, as inferred after the last iteration of the first seed. "
      "The x share the grey scale of x*.";
  return out;
}

}  // namespace isoline::reports
