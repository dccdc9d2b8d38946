/// \file
/// The kinetic energy of first order on seeded random trees: what its mass matrix is, and that it is conserved.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "random_case.hpp"
#include "withy/core/plugin/central_difference.hpp"

namespace withy::test {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Matrix mass_of(const DenseSystem& s) {
  const auto n = static_cast<Eigen::Index>(s.size);
  return Eigen::Map<const Matrix>(s.mass.data(), n, n);
}
Eigen::VectorXd force_of(const DenseSystem& s) {
  return Eigen::Map<const Eigen::VectorXd>(s.force.data(), static_cast<Eigen::Index>(s.size));
}

/// One tree in every truncation of one strain kinematics.
struct Truncated {
  Case first_order, strict, none, ruthless;

  Truncated(unsigned seed, const SceneWish& wish, bool linear)
      : first_order(seed, wish, linear ? "symmetric-linear" : "symmetric"),
        strict(seed, wish, linear ? "inconsistent" : "consistent"),
        none(seed, wish, linear ? "linear" : "quadratic"),
        ruthless(seed, wish, "ruthless") {}
  [[nodiscard]] State deflected(double factor) const {
    State s = first_order.state;
    for (const Slot& b : first_order.scene.model->layout().bodies) {
      for (std::size_t i = 0; i < b.positions; ++i) s.y[b.position + i] *= factor;
    }
    return s;
  }
  /// M, or any function of a state, to first order in the elastic coordinates: by a difference of eighth order.
  template <class Function>
  [[nodiscard]] auto slope(Function&& of) const {
    return central_difference([&](double h) { return of(deflected(h)); }, 0.05);
  }
};

SceneWish wish_of(unsigned seed) {
  return {.bodies = 2 + static_cast<int>(seed % 5),
          .planar = seed % 3 == 0,
          .any_root = seed % 2 == 0,
          .any_family = seed % 4 == 0};
}

/// M₀ + d/dε M(x, εq), symmetric; and the strict matrix is M₀ + M₁P, P the projection on the rates of hinges.
TEST(FirstOrderOfTheKineticEnergy,
     is_the_derivative_of_the_untruncated_mass_matrix_and_strict_keeps_its_rigid_columns) {
  for (const bool linear : {false, true}) {
    for (unsigned seed = 1; seed <= 24; ++seed) {
      const Truncated t(seed, wish_of(seed), linear);
      const Layout& layout = t.first_order.scene.model->layout();
      const State& state = t.first_order.state;
      const Matrix M0 = mass_of(t.ruthless.equations->system(0, state.y));
      const Matrix M = mass_of(t.first_order.equations->system(0, state.y));
      const Matrix M1 = t.slope([&](const State& s) -> Matrix { return mass_of(t.none.equations->system(0, s.y)); });
      const double size = M0.norm() + M1.norm() + 1e-12;
      EXPECT_LT((M - M.transpose()).norm(), 1e-13 * size) << seed;
      EXPECT_LT((M - M0 - M1).norm(), 1e-10 * size) << seed;
      Matrix strict = M0;
      for (const Slot& hinge : layout.hinges) {
        const auto at = static_cast<Eigen::Index>(hinge.speed), count = static_cast<Eigen::Index>(hinge.speeds);
        strict.middleCols(at, count) = M.middleCols(at, count);
      }
      EXPECT_LT((mass_of(t.strict.equations->system(0, state.y)) - strict).norm(), 3e-12 * size) << seed;
    }
  }
}

/// Along any motion u·(f − f(0) + D q̇) + ½ uᵀ Ṁ u = 0: velocity terms do the work that changes the kinetic energy.
TEST(FirstOrderOfTheKineticEnergy, is_conserved_by_its_velocity_terms) {
  for (const char* formulation : {"symmetric", "symmetric-linear"}) {
    for (unsigned seed = 1; seed <= 24; ++seed) {
      const Case c(seed, wish_of(seed), formulation);
      const Layout& layout = c.scene.model->layout();
      if (layout.speeds == 0) continue;
      const auto n = static_cast<Eigen::Index>(layout.speeds);
      const Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(c.state.y.data() + layout.positions, n);
      Work work = c.equations->make_work();
      std::vector<double> x_dot(c.equations->size());
      ASSERT_TRUE(c.equations->position_rates(0, c.state.y, x_dot, work).ok());
      const auto twice_energy = [&](double h) {
        std::vector<double> y = c.state.y;
        for (std::size_t i = 0; i < layout.positions; ++i) y[i] += h * x_dot[i];
        return double(u.dot(mass_of(c.equations->system(0, y)) * u));
      };
      State still = c.state;
      std::fill_n(still.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
      Eigen::VectorXd velocity =
          force_of(c.equations->system(0, c.state.y)) - force_of(c.equations->system(0, still.y));
      for (const BodyNode& body : c.scene.model->bodies()) {
        const Eigen::MatrixXd& D = body.body->shape().damping;
        if (D.size() == 0) continue;
        const auto at = static_cast<Eigen::Index>(layout.body(body.name)->speed);
        velocity.segment(at, D.rows()) += D * u.segment(at, D.rows());
      }
      double rate = 1;
      for (std::size_t i = 0; i < layout.positions; ++i) rate = std::max(rate, std::abs(x_dot[i]));
      const double half_rate_of_M = 0.5 * central_difference(twice_energy, 1e-2 / rate);
      const double size = u.cwiseAbs().dot(velocity.cwiseAbs()) + std::abs(half_rate_of_M) + 1e-9;
      EXPECT_NEAR(u.dot(velocity) + half_rate_of_M, 0, 1e-9 * size) << formulation << ", seed " << seed;
    }
  }
}

/// The force of weight is the gradient of a potential, the untruncated one to second order in q.
TEST(FirstOrderOfTheKineticEnergy, has_the_weight_of_a_potential_of_second_order) {
  for (unsigned seed = 1; seed <= 18; ++seed) {
    const Truncated t(seed, wish_of(seed), false);
    const Layout& layout = t.first_order.scene.model->layout();
    if (layout.speeds == 0) continue;
    const auto potential = [&](const std::vector<double>& y) {
      const auto at = [&](double factor) {
        std::vector<double> scaled = y;
        double strain = 0;
        for (const BodyNode& body : t.none.scene.model->bodies()) {
          const Eigen::MatrixXd& K = body.body->shape().stiffness;
          if (K.size() == 0) continue;
          const Slot& slot = *layout.body(body.name);
          Eigen::Map<Eigen::VectorXd> q(scaled.data() + slot.position, K.rows());
          q *= factor;
          strain += 0.5 * q.dot(K * q);
        }
        return t.none.equations->energies(scaled).potential - strain;
      };
      // V(0) + V′ + ½ V″ at factor 1, by central differences of sixth order.
      const double h = 0.05;
      const double v0 = at(0), a1 = at(h), b1 = at(-h), a2 = at(2 * h), b2 = at(-2 * h), a3 = at(3 * h),
                   b3 = at(-3 * h);
      const double first = (45 * (a1 - b1) - 9 * (a2 - b2) + (a3 - b3)) / (60 * h);
      const double second = (270 * (a1 + b1) - 27 * (a2 + b2) + 2 * (a3 + b3) - 490 * v0) / (180 * h * h);
      return v0 + first + 0.5 * second;
    };
    std::vector<double> still = t.first_order.state.y;
    std::fill_n(still.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
    Eigen::VectorXd weight = force_of(t.first_order.equations->system(0, still));
    for (const BodyNode& body : t.none.scene.model->bodies()) {
      const Eigen::MatrixXd& K = body.body->shape().stiffness;
      if (K.size() == 0) continue;
      const Slot& slot = *layout.body(body.name);
      weight.segment(static_cast<Eigen::Index>(slot.speed), K.rows()) +=
          K * Eigen::Map<const Eigen::VectorXd>(still.data() + slot.position, K.rows());
    }
    Work work = t.first_order.equations->make_work();
    for (std::size_t k = 0; k < layout.speeds; ++k) {
      std::vector<double> y = still, direction(still.size());
      y[layout.positions + k] = 1;
      ASSERT_TRUE(t.first_order.equations->position_rates(0, y, direction, work).ok());
      const double slope = central_difference(
          [&](double h) {
            std::vector<double> moved = still;
            for (std::size_t i = 0; i < layout.positions; ++i) moved[i] += h * direction[i];
            t.first_order.equations->normalize(moved);
            return potential(moved);
          },
          1e-2);
      EXPECT_NEAR(weight[static_cast<Eigen::Index>(k)], -slope, 1e-8 * (1 + weight.cwiseAbs().maxCoeff()))
          << "seed " << seed << ", " << layout.speed_names[k];
    }
  }
}

/// Change of the accelerations, over the greatest, where all of a floating tree moves with 3.7 m/s more.
double felt_of_a_uniform_velocity(unsigned seed, const std::string& formulation, double deflections) {
  Case c(seed, {.bodies = 4}, formulation);
  const Layout& layout = c.scene.model->layout();
  for (const Slot& b : layout.bodies)
    for (std::size_t i = 0; i < b.positions; ++i) c.state.y[b.position + i] *= deflections;
  const std::vector<double> before = c.derivatives(c.state);
  const double added[] = {3, -2, 1};
  for (std::size_t i = 0; i < 3; ++i) c.state.y[layout.positions + layout.hinge("h0")->speed + 3 + i] += added[i];
  const std::vector<double> after = c.derivatives(c.state);
  double change = 0, greatest = 0;
  for (std::size_t i = layout.positions; i < before.size(); ++i) {
    change = std::max(change, std::abs(after[i] - before[i]));
    greatest = std::max(greatest, std::abs(before[i]));
  }
  return change / greatest;
}

/// Galileo's principle holds in all formulations but in those whose kinetic energy is truncated; there it is lost with
/// the first power of the deflections.
TEST(FirstOrderOfTheKineticEnergy, alone_feels_a_velocity_that_all_bodies_have_in_common) {
  double most = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    for (const std::string& formulation : formulations) {
      const double felt = felt_of_a_uniform_velocity(seed, formulation, 1);
      if (formulation == "symmetric") {
        most = std::max(most, felt);
        EXPECT_LT(felt_of_a_uniform_velocity(seed, formulation, 0), 1e-10) << seed;
      } else if (formulation != "symmetric-linear") {  // there it takes several flexible bodies in a row
        EXPECT_LT(felt, 1e-10) << formulation << ", " << seed;
      }
    }
  }
  EXPECT_GT(most, 1e-3);
}

}  // namespace
}  // namespace withy::test
