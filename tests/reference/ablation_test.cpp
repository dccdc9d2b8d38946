/// \file
/// Why strict formulations fail: every block of the first order of the mass matrix switched on and off at the state at
/// which `consistent` becomes singular (docs/ill-conditioning.md).
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "golden.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {
namespace {

using Matrix = Eigen::MatrixXd;

class Ablation : public testing::Test {
 protected:
  Ablation() {
    enroll_static_plugins(registry_);
    const Scene scene = read("consistent");
    RunOptions options;
    options.end = *scene.end;
    options.output = 0.01;
    const auto equations = scene.formulation->compile(scene.model);
    const RunSummary run = simulate(*scene.model, *equations, *scene.integrator, scene.initial, options, {});
    failing_ = run.final;
    const Layout& layout = scene.model->layout();
    const auto n = static_cast<Eigen::Index>(layout.speeds);
    rigid_ = Matrix::Zero(n, n);
    for (const Slot& hinge : layout.hinges) {
      for (std::size_t i = hinge.speed; i < hinge.speed + hinge.speeds; ++i)
        rigid_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = 1;
    }
    scale_ = raw("quadratic", scene.initial).diagonal().cwiseSqrt().cwiseInverse();
    M0_ = mass("ruthless");
    M1_ = mass("symmetric") - M0_;
  }
  Scene read(const std::string& formulation) {
    return read_scene(std::string(SCENES) + "/two-link-slew.yaml", registry_,
                      {formulation, "", {"loads.slew.time_scale=1.2"}});
  }
  Matrix raw(const std::string& formulation, const State& state) {
    const Scene scene = read(formulation);
    const DenseSystem s = scene.formulation->compile(scene.model)->system(state.time, state.y);
    const auto n = static_cast<Eigen::Index>(s.size);
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(s.mass.data(), n,
                                                                                                    n);
  }
  /// At the failing state, each coordinate in the unit in which its inertia at the start is one.
  Matrix mass(const std::string& formulation) {
    return scale_.asDiagonal() * raw(formulation, failing_) * scale_.asDiagonal();
  }
  [[nodiscard]] double determinant(const Matrix& M) const { return M.determinant() / M0_.determinant(); }
  static double least(const Matrix& M) {
    return Eigen::SelfAdjointEigenSolver<Matrix>(0.5 * (M + M.transpose())).eigenvalues()[0];
  }

  Registry registry_;
  State failing_;
  Matrix rigid_, M0_, M1_;
  Eigen::VectorXd scale_;
};

TEST_F(Ablation, strict_forms_lack_the_elastic_columns_of_the_first_order_and_nothing_else_makes_them_fail) {
  const Matrix P = rigid_, Q = Matrix::Identity(P.rows(), P.cols()) - P;
  const Matrix strict = mass("consistent"), whole = mass("quadratic");
  EXPECT_NEAR(failing_.time, 0.527, 0.001);
  EXPECT_LT((strict - M0_ - M1_ * P).norm(), 3e-12 * M0_.norm());
  EXPECT_NEAR(determinant(strict), 0, 1e-6) << "singular";
  // With the whole of the first order nothing is wrong.
  EXPECT_NEAR(determinant(M0_ + M1_), 0.995, 0.001);
  EXPECT_NEAR(least(M0_ + M1_) / least(M0_), 1, 0.01);
  // With the square and all beyond added, and the missing columns still missing, it stays indefinite.
  EXPECT_NEAR(determinant(strict + whole - M0_ - M1_), 0.09, 0.01);
  EXPECT_LT(least(strict + whole - M0_ - M1_), -5e-5);
  EXPECT_NEAR(determinant(whole), 1.048, 0.001);
  // Either of the missing blocks alone makes it worse by far, as does every block by itself.
  EXPECT_NEAR(determinant(strict + P * M1_ * Q), -326, 2);
  EXPECT_NEAR(determinant(strict + Q * M1_ * Q), -295, 2);
  for (const Matrix& alone : {Matrix(P * M1_ * P), Matrix(Q * M1_ * P), Matrix(Q * M1_ * Q)})
    EXPECT_LT(determinant(M0_ + alone), -200);
}

/// Along the nearly massless direction M₁ does nothing, as a sum of shares of hinges and modes that cancel; strict
/// truncation keeps two of the four.
TEST_F(Ablation, shares_of_hinges_and_modes_cancel_along_the_weakest_direction) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(M0_);
  const Eigen::VectorXd v = eigen.eigenvectors().col(0), hinges = rigid_ * v, modes = v - hinges;
  const double own = eigen.eigenvalues()[0], rr = hinges.dot(M1_ * hinges), er = modes.dot(M1_ * hinges),
               ee = modes.dot(M1_ * modes);
  EXPECT_NEAR(own, 2.7e-4, 0.1e-4);
  EXPECT_GT(rr, 2 * own);
  EXPECT_GT(ee, 2 * own);
  EXPECT_LT(std::abs(rr + 2 * er + ee), 0.01 * own);
  EXPECT_LT(rr + er, -0.1 * own);
}

}  // namespace
}  // namespace withy::test
