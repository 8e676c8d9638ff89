// The Jacobian by layers against the matrix.
#include "optimizers/layered_jacobian.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "spectral_trial.h"

namespace isoline::optimizers {
namespace {

struct Layered {
  Problem problem = network("8");
  std::unique_ptr<Trace> trace = std::make_unique<Trace>();
  Meter meter{problem, iterations(1), kAll, *trace};
  Linearization at;
  LayeredJacobian J;

  Layered() {
    Vector theta = problem.start();
    meter.begin(theta);
    meter.linearize(theta, at);
    J.take(at);
  }
};

Matrix normal(Index rows, Index columns) {
  RandomStream stream(0, "layered", "columns");
  return stream.normal_vector(rows * columns).reshaped(rows, columns);
}

TEST(LayeredJacobian, HasTheGramMatrixOfTheJacobian) {
  Layered layered;
  Matrix K;
  layered.J.gram(K);
  const Matrix& J = layered.at.jacobian();
  const Matrix expected = (J * J.transpose()).triangularView<Eigen::Lower>();
  EXPECT_LE((Matrix(K.triangularView<Eigen::Lower>()) - expected).norm(), 1e-13 * expected.norm());
}

TEST(LayeredJacobian, WeighsItsParametersInTheirOwnOrder) {
  Layered layered;
  const Matrix& J = layered.at.jacobian();
  Eigen::Matrix<Index, Eigen::Dynamic, 1> order;
  layered.J.order(layered.problem.layout(), order);
  const Vector w = normal(J.cols(), 1).cwiseAbs2();
  Vector squares;
  layered.J.squared_columns(squares);
  const Vector of_columns = J.colwise().squaredNorm().transpose();
  EXPECT_LE((squares - of_columns(order)).norm(), 1e-13 * of_columns.norm());
  Matrix K;
  layered.J.weighted_gram(w(order), K);
  const Matrix expected = (J * w.asDiagonal() * J.transpose()).triangularView<Eigen::Lower>();
  EXPECT_LE((Matrix(K.triangularView<Eigen::Lower>()) - expected).norm(), 1e-13 * expected.norm());
}

// More columns than are taken at once; its order of parameters does not show in J Jᵀ.
TEST(LayeredJacobian, ItsProductsAreThoseOfTheJacobian) {
  Layered layered;
  const Matrix& J = layered.at.jacobian();
  const Matrix Y = normal(J.rows(), 21);
  Matrix JTY, JJTY, JZ;
  layered.J.pullback(Y, JTY);
  ASSERT_EQ(JTY.rows(), J.cols());
  EXPECT_NEAR(JTY.norm(), (J.transpose() * Y).norm(), 1e-12 * JTY.norm());
  layered.J.pushforward(JTY, JJTY);
  const Matrix expected = J * (J.transpose() * Y);
  EXPECT_LE((JJTY - expected).norm(), 1e-13 * expected.norm());
  const Matrix Z = normal(J.cols(), 21);
  layered.J.pushforward(Z, JZ);
  EXPECT_NEAR(JZ.cwiseProduct(Y).sum(), Z.cwiseProduct(JTY).sum(), 1e-12 * JZ.norm() * Y.norm());
}

}  // namespace
}  // namespace isoline::optimizers
