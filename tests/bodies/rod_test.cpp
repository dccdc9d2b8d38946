/// \file
/// Exact kinematics of rods: against closed forms, against the beam's second-order expansion, and in statics.
#include <cmath>
#include <numbers>

#include "withy/core/deformation/rod_motion.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/bodies/beam_fixture.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

using std::numbers::pi;

/// Constant twist rate and curvatures: three modes whose strain is 1/m along x, y, z.
class UniformRod final : public Rod {
 public:
  explicit UniformRod(double length) : length_(length) {}
  Eigen::Index modes() const override { return 3; }
  double length() const override { return length_; }
  double wave_number() const override { return 2 * pi / length_; }
  RodSection section(double x) const override {
    const Matrix3 one = Matrix3::Identity();
    return {one, x * one, -0.5 * x * x * skew<double>(Vector3::UnitX()), 1.0, Matrix3::Zero()};
  }

 private:
  double length_;
};

/// Bending in two planes and twist, seven modes, 1.3 m long.
std::unique_ptr<Body> rod_like_beam() {
  Registry registry;
  enroll_static_plugins(registry);
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(1.3)},
                            {"mass_per_length", Value(0.7)},
                            {"bending_y", strain(40, 3)},
                            {"bending_z", strain(25, 2)},
                            {"torsion", strain(30, 2, 0.002)}});
}

/// In functions that turn the root about all three axes, and move it: so many in the first plane, and in the other and
/// of twist.
std::unique_ptr<Body> beam_with_a_turning_root(double first = 3, double others = 2) {
  Registry registry;
  enroll_static_plugins(registry);
  Value pinned = strain(40, first), free = strain(25, others), twisting = strain(30, others, 0.002);
  pinned.set("family", Value(std::string("pinned-pinned")));
  for (Value* of : {&free, &twisting}) of->set("family", Value(std::string("free-free")));
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(1.3)},
                            {"mass_per_length", Value(0.7)},
                            {"bending_y", pinned},
                            {"bending_z", free},
                            {"torsion", twisting}});
}

/// The same with extension and shear, 13 modes, and rotary inertia in bending.
std::unique_ptr<Body> stretching_beam() {
  Registry registry;
  enroll_static_plugins(registry);
  const auto polynomials = [](double stiffness) {
    return Value::map({{"stiffness", Value(stiffness)},
                       {"modes", Value(2.0)},
                       {"family", Value(std::string("orthogonal-polynomials"))}});
  };
  Value bending = strain(40, 3);
  bending.set("rotary_inertia", Value(0.01));
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(1.3)},
                            {"mass_per_length", Value(0.7)},
                            {"bending_y", bending},
                            {"bending_z", strain(25, 2)},
                            {"torsion", strain(30, 2, 0.002)},
                            {"extension", polynomials(3000)},
                            {"shear_y", polynomials(900)},
                            {"shear_z", polynomials(800)}});
}

/// The rod of the same strains that is clamped at its root.
class ClampedRod final : public Rod {
 public:
  explicit ClampedRod(const Rod& rod) : rod_(rod), root_(rod.section(0)) {}
  Eigen::Index modes() const override { return rod_.modes(); }
  double length() const override { return rod_.length(); }
  double wave_number() const override { return rod_.wave_number(); }
  RodSection section(double x) const override {
    RodSection s = rod_.section(x);
    s.rotation -= root_.rotation;
    s.deflection -= root_.deflection + x * skew<double>(Vector3::UnitX()).transpose() * root_.rotation;
    return s;
  }

 private:
  const Rod& rod_;
  RodSection root_;
};

/// Exact kinematics as PointKinematics, at some places along the rod.
class ExactKinematics final : public PointKinematics {
 public:
  explicit ExactKinematics(const Rod& rod) : table_(rod) {}
  Eigen::Index modes() const override { return table_.rod->modes(); }
  std::size_t points() const override { return 4; }
  void evaluate(std::span<const double> q, std::span<const double> q_dot,
                std::span<PointMotion> motions) const override {
    const RodMotion rod(table_, Eigen::Map<const Eigen::VectorXd>(q.data(), modes()),
                        Eigen::Map<const Eigen::VectorXd>(q_dot.data(), modes()));
    for (std::size_t i = 0; i < points(); ++i) {
      const PointMotionOf<double> m = rod.at(table_.rod->length() * static_cast<double>(i) / 3);
      motions[i] = {m.r, m.R, m.P, m.W, m.r_bias, m.w_bias};
    }
  }

 private:
  RodTable table_;
};

TEST(Rod, partial_velocities_and_biases_are_derivatives) {
  // As few functions as have waves no shorter than the clamped ones': of the same strains a clamped rod is as far off.
  for (const auto& body : {rod_like_beam(), stretching_beam(), beam_with_a_turning_root(2, 1)}) {
    ASSERT_NE(body->rod(), nullptr);
    expect_kinematics_conforms(ExactKinematics(*body->rod()));
  }
}

/// A constant strain k = (τ, 0, κ) gives a helix: R = exp(x k̂), and with c = k/|k|, φ = |k| x,
/// r = x c (c·e) + sin φ/|k| (e − c (c·e)) + (1 − cos φ)/|k| c × e. A full turn, 1e-10 of the length: what the
/// quadrature of 32 nodes leaves of it.
TEST(Rod, constant_strain_is_a_circle_or_a_helix) {
  const double length = 2.0;
  const UniformRod rod(length);
  const RodTable table(rod);
  for (const double twist : {0.0, 1.3}) {
    const Vector3 k(twist, 0, std::sqrt(pi * pi - twist * twist));  // |k| L = 2π
    const RodMotion motion(table, k, Vector3::Zero());
    for (const double x : {0.3, 1.1, 1.7, 2.0}) {
      const Vector3 e = Vector3::UnitX(), c = k.normalized();
      const double angle = k.norm() * x;
      const Vector3 r = x * c * c.dot(e) + std::sin(angle) / k.norm() * (e - c * c.dot(e)) +
                        (1 - std::cos(angle)) / k.norm() * c.cross(e);
      const PointMotionOf<double> m = motion.at(x);
      EXPECT_LT((m.r - r).norm(), 1e-10 * length) << "x = " << x << ", twist " << twist;
      EXPECT_LT((m.R - Eigen::AngleAxisd(angle, c).toRotationMatrix()).norm(), 1e-13);
      EXPECT_LT((RodMotion::position(table, k, x) - m.r).norm(), 1e-14);
    }
    if (twist == 0) {
      EXPECT_LT(motion.at(length).r.norm(), 1e-10 * length) << "the circle closes";
    }
  }
}

/// ∂P_i/∂q_j at q = 0 is Γ_ij, and ∂w_i/∂q_j is Θ_ij + ½ ψ_j × ψ_i, since w_i = (1 + ½ θ̂ + …) ∂θ/∂q_i. Central
/// differences of steps 2e-3 and 1e-3, extrapolated, leave 1e-11 of the fourth derivatives and rounding 1e-13/1e-3; the
/// rod's quadrature leaves 1e-8 of the second order.
void expect_second_order_of_the_beam(const Body& beam) {
  const Body* body = &beam;
  const RodTable table(*body->rod());
  const Eigen::Index n = body->shape().modes();
  for (const double x : {0.0, 0.31, 0.9, 1.3}) {
    const PointExpansion e = *body->station(x);
    const auto motion = [&](Eigen::Index j, double h) {
      return RodMotion(table, h * Eigen::VectorXd::Unit(n, j), Eigen::VectorXd::Zero(n)).at(x);
    };
    const PointMotionOf<double> rest = motion(0, 0);
    EXPECT_LT((rest.P - e.phi).norm(), 1e-13);
    EXPECT_LE((rest.W - e.psi).norm(), 1e-13 * e.psi.norm());
    double gamma_size = 0, theta_size = 0, gamma_error = 0, theta_error = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto derivative = [&](auto field) {
        const auto difference = [&](double h) {
          return Matrix3X((motion(j, h).*field - motion(j, -h).*field) / (2 * h));
        };
        return Matrix3X((4 * difference(1e-3) - difference(2e-3)) / 3);
      };
      const Matrix3X P = derivative(&PointMotionOf<double>::P), W = derivative(&PointMotionOf<double>::W);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Vector3 gamma(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j));
        const Vector3 theta(e.theta[0](i, j), e.theta[1](i, j), e.theta[2](i, j));
        const Vector3 w = theta + 0.5 * Vector3(e.psi.col(j)).cross(Vector3(e.psi.col(i)));
        gamma_size = std::max(gamma_size, gamma.norm());
        theta_size = std::max(theta_size, w.norm());
        gamma_error = std::max(gamma_error, (P.col(i) - gamma).norm());
        theta_error = std::max(theta_error, (W.col(i) - w).norm());
      }
    }
    EXPECT_LE(gamma_error, 1e-7 * gamma_size) << "x = " << x;
    EXPECT_LE(theta_error, 1e-7 * theta_size) << "x = " << x;
  }
}

TEST(Rod, second_order_expansion_is_that_of_the_beam_in_two_planes_with_twist) {
  expect_second_order_of_the_beam(*rod_like_beam());
}
TEST(Rod, second_order_expansion_is_that_of_the_beam_with_extension_and_shear) {
  expect_second_order_of_the_beam(*stretching_beam());
}
TEST(Rod, second_order_expansion_is_that_of_the_beam_whose_root_turns_about_all_axes) {
  expect_second_order_of_the_beam(*beam_with_a_turning_root());
}

/// Turned at its root by θ, the rod is the clamped one of the same strains, turned and moved as a whole: to 1e-9 of the
/// length, as the quadrature leaves it.
TEST(Rod, with_a_turning_root_is_the_clamped_one_as_a_whole_turned_and_moved) {
  const auto body = beam_with_a_turning_root();
  const ClampedRod clamped(*body->rod());
  const RodTable turning(*body->rod()), still(clamped);
  ASSERT_TRUE(turning.root.has_value());
  ASSERT_FALSE(still.root.has_value());
  Eigen::VectorXd q(7);
  q << 0.2, -0.03, 0.02, 0.1, 0.04, 0.3, -0.2;
  const RodMotion a(turning, q, Eigen::VectorXd::Zero(7)), b(still, q, Eigen::VectorXd::Zero(7));
  const Vector3 theta = turning.root->psi * q;
  EXPECT_GT(theta.norm(), 0.5);
  const Matrix3 R = Eigen::AngleAxisd(theta.norm(), theta.normalized()).toRotationMatrix();
  const Vector3 moved = body->rod()->section(0).deflection * q;
  for (const double x : {0.0, 0.4, 1.3}) {
    EXPECT_LT((a.at(x).r - moved - R * b.at(x).r).norm(), 1.3e-9) << x;
    EXPECT_LT((a.at(x).R - R * b.at(x).R).norm(), 1e-12) << x;
  }
}

/// Cantilever of unit length and EI with n clamped-free modes.
struct Cantilever {
  std::unique_ptr<Body> body;
  RodTable table;
  Eigen::VectorXd stiffness;

  explicit Cantilever(double modes)
      : body(make(modes)), table(*body->rod()), stiffness(body->shape().stiffness.diagonal()) {}
  static std::unique_ptr<Body> make(double modes) {
    Registry registry;
    enroll_static_plugins(registry);
    return make_plugin<Body>(
        registry, "beam", {{"length", Value(1.0)}, {"mass_per_length", Value(1.0)}, {"bending_y", strain(1.0, modes)}});
  }
  [[nodiscard]] PointMotionOf<double> tip(const Eigen::VectorXd& q) const {
    return RodMotion(table, q, Eigen::VectorXd::Zero(q.size())).at(1.0);
  }
};

/// An end moment M = 2π EI/L bends the cantilever into a circle. In a plane the moment does work through the tip's
/// angle alone, so K q = M ψ(L). Clamped-free modes have no curvature at the tip, and converge to a constant one only
/// in the mean: the tip's distance from the root falls with the number of modes, and below 1e-3 of the length.
TEST(Statics, end_moment_bends_a_cantilever_into_a_circle) {
  double before = 1;
  for (const double modes : {5, 10, 20, 40}) {
    const Cantilever c(modes);
    const auto n = static_cast<Eigen::Index>(modes);
    const Eigen::VectorXd psi = c.tip(Eigen::VectorXd::Zero(n)).W.row(2).transpose();
    const double gap = c.tip(2 * pi * psi.cwiseQuotient(c.stiffness)).r.norm();
    std::printf("%3.0f modes: the circle is open by %.2e L\n", modes, gap);
    EXPECT_LT(gap, 0.6 * before);
    before = gap;
  }
  EXPECT_LT(before, 1e-3);
}

/// A dead end force P L²/EI = 10 across the undeformed axis. Tip from θ″ = −10 cos θ, θ(0) = 0, θ′(1) = 0, integrated
/// by a Runge–Kutta method of fourth order with 20,000 steps (the elliptic integrals of Bisshopp & Drucker 1945):
/// x = 0.4450044, y = 0.8106090. Equilibrium K q = Pᵀ F by Newton's iteration.
TEST(Statics, end_force_bends_a_cantilever_as_the_elastica) {
  const Cantilever c(12);
  const Eigen::Index n = 12;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (const double force : {2.0, 5.0, 10.0, 10.0}) {
    const auto residual = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd(c.stiffness.cwiseProduct(at) - force * c.tip(at).P.row(1).transpose());
    };
    for (int iteration = 0; iteration < 8; ++iteration) {
      Eigen::MatrixXd tangent(n, n);
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(n, j);
        tangent.col(j) = (residual(q + step) - residual(q - step)) / 2e-6;
      }
      q -= tangent.partialPivLu().solve(residual(q));
    }
  }
  const Vector3 r = c.tip(q).r;
  EXPECT_NEAR(r.x(), 0.4450044, 1e-4);
  EXPECT_NEAR(r.y(), 0.8106090, 1e-4);
}

/// Two planes and twist, 61.5 m long, masses and inertias in many rows.
std::unique_ptr<Body> blade_with(const std::vector<std::pair<double, double>>& mass) {
  Registry registry;
  enroll_static_plugins(registry);
  std::vector<Value> masses, inertias;
  for (const auto& [x, m] : mass) {
    masses.push_back(Value::list({Value(x), Value(m)}));
    inertias.push_back(Value::list({Value(x), Value(0.02 * m * (2 + std::cos(x)))}));
  }
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(61.5)},
                            {"mass_per_length", Value::list(std::move(masses))},
                            {"bending_y", strain(4e9, 3)},
                            {"bending_z", strain(1e9, 3)},
                            {"torsion", Value::map({{"stiffness", Value(1e9)},
                                                    {"modes", Value(2.0)},
                                                    {"family", Value(std::string("orthogonal-polynomials"))},
                                                    {"inertia", Value::list(std::move(inertias))}})}});
}

/// ∫ 1, x, Φᵀ Φ, Ψᵀ Ψ of what is beyond x, over mass and over inertia, one after the other.
Eigen::VectorXd integrals(const std::vector<Particle>& particles, const std::vector<withy::Section>& sections) {
  const Eigen::Index n = particles.front().at.phi.cols();
  double mass = 0, moment = 0, inertia = 0;
  Eigen::MatrixXd translation = Eigen::MatrixXd::Zero(n, n), rotation = translation;
  for (const Particle& p : particles) {
    mass += p.mass, moment += p.mass * p.at.X.x();
    translation += p.mass * p.at.phi.transpose() * p.at.phi;
  }
  for (const withy::Section& s : sections) {
    inertia += s.inertia(0, 0);
    rotation += s.inertia(0, 0) * s.at.psi.row(0).transpose() * s.at.psi.row(0);
  }
  Eigen::VectorXd all(3 + 2 * n * n);
  all << mass, moment, inertia, translation.reshaped(), rotation.reshaped();
  return all;
}

/// The same of what belongs to a part of a rod's nodes.
Eigen::VectorXd integrals(const Body& body, const RodTable& table, const RodTable::Part& part) {
  std::vector<Particle> particles;
  std::vector<withy::Section> sections;
  for (std::size_t k = 0; k < table.masses.size(); ++k) {
    const PointExpansion at = *body.station(table.quadrature.nodes()[k]);
    particles.push_back({table.masses[k] * part.shares[k], at});
    sections.push_back({part.inertias[k], at});
  }
  return integrals(particles, sections);
}

/// Masses of a table that changes gently are integrated into the nodes of fewer panels than it has rows; where they
/// change abruptly, and a node's mass would be negative, panels end at the rows. Either way the integrals are those of
/// the table, of the whole beam and of what is beyond a section: to 1e-10 of the greatest, as the nodes interpolate.
TEST(RodMass, of_a_table_with_many_rows_is_that_of_the_table_however_few_the_panels) {
  std::vector<std::pair<double, double>> gentle, abrupt;
  for (int i = 0; i <= 24; ++i) {
    const double x = 61.5 * i / 24;
    gentle.emplace_back(x, 700 * std::exp(-x / 20) * (1 + 0.1 * std::sin(5.0 * i)));
    abrupt.emplace_back(x, 1);
    // A lump of 500 kg within 0.2 m.
    if (i == 11) abrupt.insert(abrupt.end(), {{28.9, 1.0}, {29.0, 5000.0}, {29.1, 1.0}});
  }
  for (const auto& [rows, over] : {std::pair{&gentle, true}, std::pair{&abrupt, false}}) {
    const auto body = blade_with(*rows);
    const RodTable table(*body->rod());
    if (over) {
      EXPECT_LT(table.quadrature.panels(), 10);
    } else {
      EXPECT_EQ(table.quadrature.panels(), 27);
    }
    for (const double m : table.masses) EXPECT_GT(m, 0);
    for (const double x : {0.0, 0.7, 23.1, 28.97, 30.75, 60.9}) {
      const BodyCut cut = *body->cut(x);
      const Eigen::VectorXd expected = integrals(cut.particles, cut.sections);
      const Eigen::VectorXd found = integrals(*body, table, table.beyond(x));
      const Eigen::Index n = body->shape().modes(), square = n * n;
      for (const auto& [first, count] :
           {std::pair<Eigen::Index, Eigen::Index>{0, 1}, {1, 1}, {2, 1}, {3, square}, {3 + square, square}}) {
        const double size = expected.segment(first, count).cwiseAbs().maxCoeff();
        EXPECT_LT((found - expected).segment(first, count).cwiseAbs().maxCoeff(), 1e-10 * size)
            << "beyond " << x << " m, integrals from " << first;
      }
    }
  }
}

/// The same rod as if its strains were finer, for more panels.
class FinelyCutRod final : public Rod {
 public:
  explicit FinelyCutRod(const Rod& rod) : rod_(rod) {}
  Eigen::Index modes() const override { return rod_.modes(); }
  double length() const override { return rod_.length(); }
  double wave_number() const override { return 6 * rod_.wave_number(); }
  std::vector<double> kinks() const override { return rod_.kinks(); }
  std::vector<double> mass_kinks() const override { return rod_.mass_kinks(); }
  RodSection section(double x) const override { return rod_.section(x); }

 private:
  const Rod& rod_;
};

/// Between the rows of a stiffness table panels are short, and eight nodes do for each: bent by a third of its length,
/// a blade in its own modes goes where it does on many more panels of sixteen, to 1e-8 of its length.
TEST(Rod, eight_nodes_between_the_rows_of_a_stiffness_table_are_enough) {
  const double L = 40;
  const auto table = [](double root, double steepness) {
    std::vector<Value> rows;
    for (int i = 0; i <= 16; ++i) {
      const double x = 40.0 * i / 16, value = root * std::exp(-steepness * x / 40) * (1 + 0.1 * std::sin(5.0 * i));
      rows.push_back(Value::list({Value(x), Value(value)}));
    }
    return Value::list(std::move(rows));
  };
  const auto bending = [&](double root) {
    return Value::map(
        {{"stiffness", table(root, 6)}, {"modes", Value(3.0)}, {"family", Value(std::string("vibration-modes"))}});
  };
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = make_plugin<Body>(registry, "beam",
                                      {{"length", Value(L)},
                                       {"mass_per_length", table(600, 3)},
                                       {"bending_y", bending(9e9)},
                                       {"bending_z", bending(4e9)}});
  const FinelyCutRod fine(*body->rod());
  const RodTable few(*body->rod()), many(fine);
  ASSERT_EQ(few.quadrature.order(), RodTable::short_order);
  ASSERT_EQ(many.quadrature.order(), RodTable::order);
  Eigen::VectorXd q(6), q_dot(6);
  q << 5, 0.6, -0.2, 3, -0.8, 0.1;
  q_dot << 1, -2, 0.7, 2, 1, -0.5;
  const RodMotion coarse(few, q, q_dot), truth(many, q, q_dot);
  EXPECT_GT((truth.at(L).r - Vector3(L, 0, 0)).norm(), L / 3);
  for (const double x : {7.0, 21.3, 36.0, L}) {
    const PointMotionOf<double> a = coarse.at(x), b = truth.at(x);
    EXPECT_LT((a.r - b.r).norm(), 1e-8 * L) << x;
    EXPECT_LT((a.R - b.R).norm(), 1e-8) << x;
    EXPECT_LT((a.P - b.P).norm(), 1e-8 * b.P.norm()) << x;
    EXPECT_LT((a.r_bias - b.r_bias).norm(), 1e-8 * truth.at(L).r_bias.norm()) << x;
  }
}

}  // namespace
}  // namespace withy::test
