// Differences across kinks: ways that cross one which its component declares are drawn anew.
#include <gtest/gtest.h>

#include "core/workspace.h"
#include "problems/conformance.h"

namespace isoline::problems {
namespace {

// y = |x| + x², with its kink as near to the start as short steps go, and told or not.
class Folded final : public Physics {
 public:
  explicit Folded(bool tells) : tells_(tells) {}
  Index inputs() const override { return 2; }
  Index outputs() const override { return 2; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    y = x.array().abs() + x.array().square();
    if (tells_) w.as<Sides>().is_right = x.array().reshaped() > 0;
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    Jv = (w.x.array().sign() + 2 * w.x.array()) * v.array();
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override { pushforward(u, JTu, w); }

 private:
  struct Sides final : Scratch, Pieces {
    Success is_right;
    void add_choices(PieceDigest& digest) override {
      for (const bool choice : is_right) digest.add(choice);
    }
  };
  bool tells_;
};

bool examines_well(bool tells_its_kink) {
  // Most of the halved steps are longer than the way to the kink.
  bool all = true;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Problem problem({.physics = std::make_unique<Folded>(tells_its_kink),
                           .start = Vector::Constant(2, 3e-5),
                           .start_scale = StartScale::own,
                           .target = Vector::Ones(2)});
    RandomStream stream(seed, "folded", "conformance");
    for (const Finding& finding : examine(problem, stream)) all = all && finding.holds();
  }
  return all;
}

TEST(Kinks, AreNotCrossedByWaysAlongWhichDifferencesAreTaken) {
  EXPECT_TRUE(examines_well(true));
  EXPECT_FALSE(examines_well(false)) << "else the redrawing proves nothing";
}

// Every choice counts, whichever it is.
TEST(Kinks, ArePassedWhereAChoiceDiffers) {
  Folded folded(true);
  const auto piece = [&](Real first, Real second) {
    Workspace w;
    Matrix y(2, 1);
    folded.forward(Eigen::Vector2d(first, second), Matrix(), y, w);
    PieceDigest digest;
    dynamic_cast<Pieces&>(*w.own).add_choices(digest);
    return digest.value();
  };
  EXPECT_EQ(piece(1, 1), piece(2, 0.1));
  EXPECT_NE(piece(1, 1), piece(-1, 1));
  EXPECT_NE(piece(-1, 1), piece(1, -1));
}

}  // namespace
}  // namespace isoline::problems
