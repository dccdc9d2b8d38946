/// \file
/// Beams on a hub that a motion turns, against published frequencies.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

/// Rotating cantilever, hub radius 0 (Wright et al. 1982 and others; theory section 6): eigenvalues of the dense system
/// at constant rate about the straight blade, a steady state. flap across the plane of rotation, lag in it:
/// lag² = flap² − η².
struct Rotating {
  double eta, flap1, flap2;
};
const Rotating rotating[] = {{0, 3.51602, 22.03449},  {1, 3.68165, 22.18101}, {2, 4.13732, 22.61492},
                             {4, 5.58500, 24.27335},  {6, 7.36037, 26.80908}, {10, 11.20233, 33.64037},
                             {12, 13.17015, 37.60311}};

/// Frequencies of the free speeds, lowest first, from M ü = f by central differences in q and q̇.
std::vector<double> free_frequencies(const LoadedScene& s) {
  const State& state = s.scene.initial;
  const Layout& layout = s.scene.model->layout();
  const auto modes = static_cast<Eigen::Index>(layout.bodies[0].speeds);
  const auto first = layout.bodies[0].position;
  const auto force = [&](std::size_t index, double change) {
    State moved = state;
    moved.y[index] += change;
    const DenseSystem part = free_part(s.equations->system(0, moved.y));
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(part.force.data(), modes));
  };
  constexpr double h = 1e-5;
  Eigen::MatrixXd K(modes, modes), D(modes, modes);
  for (Eigen::Index i = 0; i < modes; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i);
    K.col(i) = (force(at, -h) - force(at, h)) / (2 * h);
    const std::size_t rate = layout.positions + layout.bodies[0].speed + static_cast<std::size_t>(i);
    D.col(i) = (force(rate, -h) - force(rate, h)) / (2 * h);
  }
  // Straight and inextensible: nothing couples through Coriolis accelerations.
  EXPECT_LT(D.cwiseAbs().maxCoeff(), 1e-6 * K.cwiseAbs().maxCoeff());
  const DenseSystem part = free_part(s.equations->system(0, state.y));
  const Eigen::Map<const Eigen::MatrixXd> M(part.mass.data(), modes, modes);  // symmetric at q = 0
  const Eigen::MatrixXd symmetric = 0.5 * (K + K.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric, Eigen::MatrixXd(M));
  std::vector<double> all;
  for (const double squared : eigen.eigenvalues()) all.push_back(squared);
  return all;
}

TEST(RotatingCantilever, frequencies_are_those_published) {
  for (const char* formulation : {"ruthless", "inconsistent", "consistent", "quadratic", "exact"}) {
    const bool stiffens = std::string(formulation) != "ruthless" && std::string(formulation) != "inconsistent";
    for (const Rotating& c : rotating) {
      for (const bool flap : {true, false}) {
        // ρA = 1, L = 1, EI = 1: η is the rate, μ the frequency.
        const LoadedScene s(
            "format: withy/1\nformulation: " + std::string(formulation) +
            "\nbodies:\n  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  blade: {type: beam, length: 1, "
            "mass_per_length: 1, bending_" +
            (flap ? "z" : "y") +
            ": {stiffness: 1, modes: 8, family: orthogonal-polynomials}}\nhinges:\n  axle: {type: revolute, axis: [0, "
            "0, "
            "1], parent: world, child: hub}\n  root: {type: weld, parent: hub, child: blade}\nmotions: {spin: {type: "
            "constant-rate, hinge: axle, rate: " +
            std::to_string(c.eta) + "}}\n");
        const std::vector<double> squared = free_frequencies(s);
        const double fixed[] = {rotating[0].flap1, rotating[0].flap2};
        const double published[] = {c.flap1, c.flap2};
        for (std::size_t k = 0; k < 2; ++k) {
          // Without second-order kinematics nothing stiffens; ruthless does not soften in the plane either.
          double expected = std::pow(stiffens ? published[k] : fixed[k], 2);
          if (!flap && std::string(formulation) != "ruthless") expected -= c.eta * c.eta;
          EXPECT_NEAR(squared[k], expected, 2e-4 * std::abs(expected) + 1e-4)
              << formulation << ", eta " << c.eta << (flap ? " flap " : " lag ") << k + 1;
        }
      }
    }
  }
}

}  // namespace
}  // namespace withy::test
