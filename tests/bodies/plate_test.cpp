#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/shape/panel_quadrature.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

class Plate : public testing::Test {
 protected:
  Plate() { enroll_static_plugins(registry_); }
  std::unique_ptr<Body> plate(double length, double width, double poisson_ratio, double modes, double along = 6,
                              double across = 4) {
    return make_plugin<Body>(registry_, "plate",
                             {{"length", Value(length)},
                              {"width", Value(width)},
                              {"mass_per_area", Value(2.7)},
                              {"stiffness", Value(5.0)},
                              {"poisson_ratio", Value(poisson_ratio)},
                              {"modes", Value(modes)},
                              {"functions_along", Value(along)},
                              {"functions_across", Value(across)},
                              {"damping_ratio", Value(0.01)}});
  }
  /// ω a² √(m/D); modal masses are the plate's mass.
  static double parameter(const Body& body, Eigen::Index mode, double length, double width) {
    const double mass = 2.7 * length * width;
    return std::sqrt(body.shape().stiffness(mode, mode) / mass * 2.7 / 5.0) * length * length;
  }
  Registry registry_;
};

TEST_F(Plate, conforms) { expect_body_conforms(*plate(1.2, 0.7, 0.3, 4)); }

/// Square cantilever plate, ν = 0.3: A. W. Leissa, Vibration of Plates, NASA SP-160 (1969), chapter 4.2. Ritz values
/// are upper bounds and fall with every function; they come within 1 % of Leissa's, which are upper bounds themselves,
/// and may fall below them.
TEST_F(Plate, square_cantilever_has_leissas_frequencies_from_above) {
  const double expected[] = {3.4917, 8.5246, 21.429};
  const auto coarse = plate(1, 1, 0.3, 3, 3, 2), fine = plate(1, 1, 0.3, 3, 10, 8);
  const auto usual = plate(1, 1, 0.3, 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double value = parameter(*usual, k, 1, 1);
    EXPECT_NEAR(value, expected[k], 0.01 * expected[k]);
    EXPECT_NEAR(parameter(*fine, k, 1, 1), expected[k], 0.01 * expected[k]);
    EXPECT_LT(value, parameter(*coarse, k, 1, 1));
    EXPECT_LT(parameter(*fine, k, 1, 1), value);
  }
}

/// Against products of 14 times 14 Legendre polynomials in a computation of its own, which are upper bounds too and
/// have 4e-5 to fall.
TEST_F(Plate, has_the_frequencies_of_many_functions_without_being_told_how_many) {
  const auto body = make_plugin<Body>(registry_, "plate",
                                      {{"length", Value(1.2)},
                                       {"width", Value(0.9)},
                                       {"mass_per_area", Value(2.7)},
                                       {"stiffness", Value(5.0)},
                                       {"modes", Value(3.0)}});
  const double expected[] = {3.4589299, 10.609271, 21.465996};
  for (Eigen::Index k = 0; k < 3; ++k) EXPECT_NEAR(parameter(*body, k, 1.2, 0.9), expected[k], 3e-4 * expected[k]);
}

/// With ν = 0 a cylinder bends exactly as a beam: the first mode has the beam's βL = 1.8751041 and its foreshortening,
/// −½∫φ′² with ∫₀ᴸ φ₁′² dx = σβ (2 + σβL) for ∫φ² = L (Blevins 1979, table 8-1); nothing moves across.
TEST_F(Plate, without_poisson_ratio_first_mode_is_the_beams) {
  const auto body = plate(2, 0.3, 0, 1, 10);
  const double beta = 1.875104068711961;                                                                     // βL
  const double sigma_beta = beta * (std::sinh(beta) - std::sin(beta)) / (std::cosh(beta) + std::cos(beta));  // σβL
  EXPECT_NEAR(parameter(*body, 0, 2, 0.3), beta * beta, 1e-10);
  for (const char* name : {"tip", "left", "right"}) {
    const auto at = body->station(std::string(name));
    EXPECT_NEAR(at->phi(2, 0), 2, 1e-10);
    EXPECT_NEAR(at->gamma[0](0, 0), -sigma_beta * (2 + sigma_beta) / 2, 1e-10);
    EXPECT_NEAR(at->gamma[1](0, 0), 0, 1e-10);
  }
}

/// r,x = R e_x along the middle line to second order in q: it keeps its length, and its direction is the x axis of the
/// sections. Central differences of step 1e-4; halving the amplitude divides the third-order defect by eight.
TEST_F(Plate, middle_line_keeps_its_length_to_second_order) {
  const auto body = plate(1.2, 0.7, 0.3, 4);
  Eigen::VectorXd q(4);
  q << 0.08, 0.05, -0.02, 0.015;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(4);
  const auto defect = [&](double size) {
    double worst = 0;
    for (const double x : {0.4, 0.8, 1.1}) {
      const double h = 1e-4;
      const auto at = [&](double s) {
        return point_motion<double>(*body->station(s), StrainOrder::quadratic, size * q, rest);
      };
      const Vector3 tangent = (at(x + h).r - at(x - h).r) / (2 * h);
      worst = std::max(worst, (tangent - at(x).R.col(0)).norm());
    }
    return worst;
  };
  EXPECT_NEAR(std::log2(defect(0.5) / defect(0.25)), 3, 0.25);
}

/// A strip with ν = 0 spun about its clamped edge vibrates in the plane of rotation, as a cantilever does: at Ω = 2
/// √(D/m)/L² its flapping frequency is 4.13732 (Wright et al., J. Appl. Mech. 49, 1982: 4.1373), and in the plane Ω² is
/// taken from its square. Six functions of x: 1e-4.
TEST_F(Plate, spinning_strip_stiffens_as_a_rotating_beam) {
  const std::string text =
      "format: withy/1\ntime: {end: 1}\nformulation: consistent\nbodies:\n  panel: {type: plate, length: 1, width: "
      "0.1, "
      "mass_per_area: 1, stiffness: 1, poisson_ratio: 0, modes: 12, functions_across: 0}\n"
      "hinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: panel}}\n"
      "initial: {hinges: {axle: {rate: [2]}}}\n";
  const Scene scene = parse_scene(text, "strip", registry_, {});
  const auto equations = scene.formulation->compile(scene.model);
  const Slot slot = scene.model->layout().bodies[0];
  const auto n = static_cast<Eigen::Index>(slot.positions);
  const auto first = static_cast<Eigen::Index>(slot.speed);
  const auto modal_force = [&](const DenseSystem& system) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(system.force.data() + first, n));
  };
  const DenseSystem rest = equations->system(0, scene.initial.y);
  const auto size = static_cast<Eigen::Index>(rest.size);
  const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(rest.mass.data(), size, size).block(first, first, n, n);
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {  // the strict formulation is linear in q: any step is exact
    State state = scene.initial;
    state.y[slot.position + static_cast<std::size_t>(k)] = 1e-3;
    K.col(k) = (modal_force(rest) - modal_force(equations->system(0, state.y))) / 1e-3;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (K + K.transpose()), M);
  EXPECT_NEAR(std::sqrt(eigen.eigenvalues()[0] + 4), 4.13732, 1e-4);
}

/// Γ_x and Γ_y of each pair of modes, squared, over the particles and over the plate; a strip of many modes has more of
/// them than its quadrature has nodes.
TEST_F(Plate, particles_have_the_integrals_of_second_order_fields) {
  for (const char* sizes : {"modes: 12, functions_across: 0", "modes: 3"}) {
    const std::string text =
        std::string(
            "format: withy/1\ntime: {end: 1}\nbodies:\n  panel: {type: plate, length: 1, width: 0.1, "
            "mass_per_area: 2, stiffness: 1, poisson_ratio: 0.2, ") +
        sizes + "}\nhinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: panel}}\n";
    const Scene scene = parse_scene(text, "strip", registry_, {});
    const Body& plate = *scene.model->bodies()[0].body;
    const auto n = static_cast<Eigen::Index>(plate.shape().modes());
    const PanelQuadrature x(1, 1, 60), y(0.1, 1, 20);
    for (const std::size_t direction : {0UL, 1UL}) {
      Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(n, n), found = expected;
      for (std::size_t i = 0; i < x.nodes().size(); ++i) {
        for (std::size_t j = 0; j < y.nodes().size(); ++j) {
          const auto at = plate.station(fmt::format("({:.17g}; {:.17g})", x.nodes()[i], y.nodes()[j] - 0.05));
          ASSERT_TRUE(at);
          expected += 2 * x.weights()[i] * y.weights()[j] * at->gamma[direction].cwiseAbs2();
        }
      }
      for (const Particle& p : plate.shape().particles) found += p.mass * p.at.gamma[direction].cwiseAbs2();
      EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm()) << sizes << ", direction " << direction;
    }
  }
}

/// Blanks are no matter, and the edge in other units, as 3 ft of 6 ft, is the edge though its last bits differ.
TEST_F(Plate, places_are_taken_however_they_are_spaced_and_to_their_edges) {
  const double foot = 0.3048;
  const auto body = plate(36 * 0.0254, 6 * foot, 0.3, 2);
  const auto at = [&](const char* name) {
    const auto place = body->station(std::string(name));
    return place ? place->X : Vector3::Constant(std::nan(""));
  };
  for (const char* name : {"(0.5,0.3)", "(0.5, 0.3)", "(0.5 , 0.3)", "( 0.5,0.3 )", "( 0.5 , +0.3 )", "(0.5 ; 0.3)"})
    EXPECT_EQ(at(name), Vector3(0.5, 0.3, 0)) << name;
  EXPECT_LT((at("(0.9144, 0.9144)") - Vector3(0.9144, 3 * foot, 0)).norm(), 1e-15);
  EXPECT_LT((at("(0.9144, -0.9144)") - Vector3(0.9144, -3 * foot, 0)).norm(), 1e-15);
  EXPECT_TRUE(body->station(3 * foot));
  for (const char* name : {"(0.9145, 0)", "(0, 0.9145)", "(0.5 0.3)", "(, 0.3)", "(0.5, )", "(+-0.5, 0)", "(0.5, 0.3"})
    EXPECT_FALSE(body->station(std::string(name))) << name;
}

TEST_F(Plate, more_modes_than_functions_are_refused) {
  Diagnostics diagnostics;
  EXPECT_EQ(make_plugin<Body>(registry_, "plate",
                              {{"length", Value(1.0)},
                               {"width", Value(1.0)},
                               {"mass_per_area", Value(1.0)},
                               {"stiffness", Value(1.0)},
                               {"modes", Value(5.0)},
                               {"functions_along", Value(2.0)},
                               {"functions_across", Value(0.0)}},
                              diagnostics),
            nullptr);
  ASSERT_FALSE(diagnostics.ok());
  EXPECT_NE(diagnostics.errors()[0].message.find("need at most 4"), std::string::npos);
}

}  // namespace
}  // namespace withy::test
