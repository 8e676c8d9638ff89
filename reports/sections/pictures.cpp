// Pictures of a sample: what was observed, what each method inferred, and what was to be found.
#include <optional>

#include "reports/sections/panels.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Picture picture_of(std::string title, const Grid& field, Index N) {
  Picture picture{std::move(title), N, {}};
  for (Index row = 0; row < N; ++row)
    for (Index column = 0; column < N; ++column)
      picture.values.push_back(field(row + N * column, 0));
  return picture;
}

}  // namespace

Figure picture_figure(const Comparison& c, std::size_t p) {
  Figure out;
  std::vector<Picture> inferred;
  Exhibit last;
  for (std::size_t s = 0; s < c.optimizers.size(); ++s)
    for (const std::size_t run : c.cell(p, s).runs) {
      const Record* record = c.runs[run].record;
      if (!record->exhibit || !record->exhibit->is_picture()) continue;
      const std::optional<Exhibit> shown = c.study->pictures_of(*record);
      if (!shown) continue;
      inferred.push_back(picture_of(shown_spec(c.optimizers[s].label), shown->x, shown->grid));
      last = *shown;
      break;
    }
  if (inferred.empty()) return out;
  out.pictures.push_back(picture_of("y*", last.target, last.grid));
  for (Picture& picture : inferred) out.pictures.push_back(std::move(picture));
  out.pictures.push_back(picture_of("x*", last.truth, last.grid));
  out.reading =
      "The first sample of the validation, as inferred after the last iteration of the first seed. "
      "The x share the grey scale of x*.";
  return out;
}

}  // namespace isoline::reports
