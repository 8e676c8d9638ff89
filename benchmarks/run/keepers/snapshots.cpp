// y*, x* and x of the first sample that judges, where x and y are fields.
#include "benchmarks/run/keepers/keeper.h"
#include "core/files.h"
#include "core/frames.h"

namespace isoline::benchmarks {
namespace {

struct Snapshots {
  Frames frames;

  void begin(const Meter& f) {
    const std::optional<Field>& field = f.problem().field();
    if (!field) return;
    const Picture target(f.judging().target, field);
    const Picture truth(f.judging().truth, field, f.problem().history());
    const Matrix& context = f.judging().context;
    const auto cells = static_cast<std::size_t>(field->rows * field->columns);
    open_frames(frames, field->rows, field->columns, target.cells(), truth.cells(),
                {context.data(), field->context.empty() ? 0 : cells});
  }

  void keep(const Meter& f, int) {
    const std::optional<Field>& field = f.problem().field();
    if (!field) return;
    const problems::Point& at = f.judged_point();
    const Picture x(at.x(), field, f.problem().history());  // of a history, y is a part
    keep_frame(frames, f.iteration(), x.cells(),
               field->is_history() ? std::span<const Real>() : Picture(at.y, field).cells());
  }

  std::string defect() const {
    return are_sound(frames) ? "" : "fields of an invalid size or at invalid iterations";
  }

  void write(const Trace&, Parts& parts) const {
    const std::vector<std::size_t> chosen = chosen_frames(frames);
    if (frames.rows == 0 || chosen.empty()) return;
    FieldFrames fields;
    const auto add = [&](const float* plane) {  // stored column by column; a file holds rows
      for (Index i = 0; i < frames.rows; ++i)
        for (Index j = 0; j < frames.columns; ++j)
          fields.numbers.push_back(plane[j * frames.rows + i]);
    };
    add(frames.target);
    if (frames.has_truth) add(frames.truth);
    for (const std::size_t place : chosen) {
      fields.iterations.push_back(frames.iteration[place]);
      add(frames.x[place]);
    }
    if (frames.has_truth && frames.has_y) {
      add(frames.y);
      if (frames.has_context) add(frames.context);
    }
    const auto cells =
        static_cast<std::size_t>(frames.rows) * static_cast<std::size_t>(frames.columns);
    fields.shape = {static_cast<Index>(fields.numbers.size() / cells), frames.rows, frames.columns};
    fields.digest = digest(field_file(fields));
    parts.fields = std::move(fields);
  }
};

}  // namespace

Keeper snapshots_keeper() { return keeper_of<Snapshots>(); }

}  // namespace isoline::benchmarks
