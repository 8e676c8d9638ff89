// The validation of a learning run as it was last judged: its first small samples.
#include <algorithm>

#include "benchmarks/run/keepers/keeper.h"

namespace isoline::benchmarks {
namespace {

struct Samples {
  static constexpr int kNumbers = 4096, kMost = 256;
  struct Columns {
    int rows = 0, columns = 0;
    double value[kNumbers];

    void take(const Matrix& all) {
      if (all.size() == 0 || all.rows() > kNumbers) return;
      const Index most = std::min<Index>(kMost, kNumbers / all.rows());
      columns = static_cast<int>(std::min(most, all.cols()));
      std::copy_n(all.data(), all.rows() * columns, value);
      rows = static_cast<int>(all.rows());
    }
    bool is_sound() const {
      return is_within(rows, kNumbers) && is_within(columns, kNumbers) &&
             is_within(rows * columns, kNumbers);
    }
    Grid grid() const { return {rows, columns, {value, value + Index{rows} * columns}}; }
  };
  Columns target, x, truth;

  void end(const Meter& f, Status) {
    if (!f.problem().is_learned() || f.problem().field()) return;
    target.take(f.judging().target);
    x.take(f.judged_point().x());
    truth.take(f.judging().truth);
  }

  std::string defect() const {
    return target.is_sound() && x.is_sound() && truth.is_sound() ? ""
                                                                 : "samples of an invalid size";
  }

  void write(const Trace&, Parts& parts) const {
    if (x.rows > 0)
      parts.exhibit = Exhibit{.target = target.grid(), .x = x.grid(), .truth = truth.grid()};
  }
};

}  // namespace

Keeper exhibit_keeper() { return keeper_of<Samples>(); }

}  // namespace isoline::benchmarks
