/// \file
/// Loads on distributed mass: against gravity, explicit Jacobians, moving axes and potentials, on random trees.
#include <Eigen/Geometry>
#include <cmath>

#include "sensed_case.hpp"
#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy::test {
namespace {

class FieldLoads : public testing::TestWithParam<std::string> {};

const std::string every_field =
    "loads:\n  star: {type: point-gravity, parameter: 30, center: [0.5, -2, 6]}\n"
    "  tide: {type: gravity-gradient, rate: 0.7, vertical: [0.6, 0.8, 0], center: [0.1, 0.2, -0.3]}\n"
    "  orbit: {type: gravity-gradient, rate: 0.4, vertical: [1, 0, 0], normal: [0, 0.6, 0.8], axes: orbit}\n"
    "  turntable: {type: rotating-frame, axis: [1, 2, -2], rate: 1.3, acceleration: 0.6, center: [0.2, 0, 0.1]}\n"
    "  shaker: {type: base-excitation, formula: [\"3*sin(7*t)\", \"2\", \"-t\"]}\n";

/// A random tree in a random state, with lines added to its scene.
Case random_tree(unsigned seed, SceneWish wish, const std::string& more, const std::string& formulation,
                 const std::string& gravity = "") {
  RandomScene random(seed, wish);
  std::string text = random.text();
  if (!gravity.empty()) {
    const std::size_t line = text.find("gravity: ");
    text.replace(line, text.find('\n', line) - line, "gravity: " + gravity);
  }
  Case c(text + more, formulation);
  c.state = random.state(*c.scene.model, c.scene.initial);
  c.state.time = 0.3;
  return c;
}

double greatest(const std::vector<double>& v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

/// A base that is accelerated by −g, or weight: two ways through the engine, by mass points and formulations' partial
/// velocities or by the sweeps' accelerated world. Accelerations, reactions and inner forces are the same.
TEST_P(FieldLoads, of_an_accelerated_base_act_as_weight) {
  // Sections of a rod are turned by another method in the sweeps, to 1e-8 here; stiffness magnifies it.
  const double tolerance = GetParam() == "exact" ? 1e-6 : 1e-10;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const SceneWish wish{.bodies = 3 + static_cast<int>(seed % 4),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 2 == 0 && GetParam() != "exact",
                         .any_family = seed % 4 < 2};
    const bool planar = wish.planar;
    const std::string g = planar ? "[4, -7, 0]" : "[4, -7, 2]", base = planar ? "[-4, 7, 0]" : "[-4, 7, -2]";
    Case heavy = random_tree(seed, wish, "", GetParam(), g);
    Case shaken =
        random_tree(seed, wish, "loads: {base: {type: base-excitation, law: constant, value: " + base + "}}\n",
                    GetParam(), "[0, 0, 0]");
    const std::vector<double> a = heavy.derivatives(heavy.state), b = shaken.derivatives(shaken.state);
    const std::size_t accelerated = heavy.scene.model->layout().positions + heavy.scene.model->layout().speeds;
    for (std::size_t i = 0; i < accelerated; ++i)
      EXPECT_NEAR(a[i], b[i], tolerance * (1 + greatest(a))) << "seed " << seed << ", " << i;
    std::vector<SectionPlace> places;
    for (std::size_t body = 0; body < heavy.scene.model->bodies().size(); ++body) {
      if (!heavy.scene.model->bodies()[body].body->cut(0)) continue;
      places.push_back({static_cast<int>(body), 0});
      places.push_back({static_cast<int>(body), 0.37});
    }
    const auto one = heavy.equations->make_sensed_state(places), other = shaken.equations->make_sensed_state(places);
    ASSERT_TRUE(one->observe(heavy.state) && other->observe(shaken.state));
    const auto expect_same = [&](const Wrench& x, const Wrench& y) {
      const double close = 10 * tolerance * (1 + x.force.norm() + x.moment.norm() + greatest(a));
      EXPECT_LT((x.force - y.force).norm(), close) << "seed " << seed;
      EXPECT_LT((x.moment - y.moment).norm(), close) << "seed " << seed;
    };
    for (std::size_t h = 0; h < heavy.scene.model->hinges().size(); ++h)
      expect_same(one->reaction(static_cast<int>(h)), other->reaction(static_cast<int>(h)));
    for (std::size_t i = 0; i < places.size(); ++i) expect_same(one->section(i).inner, other->section(i).inner);
  }
}

TEST_P(FieldLoads, have_the_efforts_of_explicit_jacobians) {
  const double tolerance = GetParam() == "exact" ? 1e-8 : 1e-12;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Case c = random_tree(
        seed, {.bodies = 2 + static_cast<int>(seed % 5), .any_root = seed % 2 == 0 && GetParam() != "exact"},
        every_field, GetParam());
    std::vector<double> efforts(c.equations->layout().speeds);
    Work work = c.equations->make_work();
    work.poison();
    c.equations->load_efforts(c.state.time, c.state.y, EquationsOfMotion::all_loads, efforts, work);
    const std::vector<double> asked = c.equations->system(c.state.time, c.state.y).applied;
    for (std::size_t i = 0; i < efforts.size(); ++i)
      EXPECT_NEAR(efforts[i], asked[i], tolerance * (1 + greatest(asked))) << "seed " << seed << ", " << i;
  }
}

/// Of eighth order, as the differences of the dense reference's residual are; nothing is said to be differenced.
TEST_P(FieldLoads, have_exact_derivatives) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Case c = random_tree(seed, {.bodies = 2}, every_field, GetParam());
    if (GetParam().starts_with("symmetric") && seed != 2) continue;  // differences of the dense reference take long
    const TangentDynamics dynamics(c.scene.model, c.scene.formulation->terms());
    const auto n = static_cast<Eigen::Index>(c.scene.model->layout().speeds);
    const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(n, -1, 1);
    const Tangents tangents = dynamics.tangents(c.state.time, c.state.y, a);
    EXPECT_TRUE(tangents.differenced.empty());
    const double close = 1e-8 * (1 + tangents.by_position.cwiseAbs().maxCoeff());
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::VectorXd by_position = central_difference(
          [&](double h) -> Eigen::VectorXd {
            std::vector<double> y = c.state.y;
            dynamics.displace(y, h * Eigen::VectorXd::Unit(n, j));
            return dynamics.residual(c.state.time, y, a);
          },
          1e-2);
      const Eigen::VectorXd by_speed = central_difference(
          [&](double h) -> Eigen::VectorXd {
            std::vector<double> y = c.state.y;
            y[c.scene.model->layout().positions + static_cast<std::size_t>(j)] += h;
            return dynamics.residual(c.state.time, y, a);
          },
          1e-2);
      EXPECT_LT((by_position - tangents.by_position.col(j)).cwiseAbs().maxCoeff(), close) << "seed " << seed;
      EXPECT_LT((by_speed - tangents.by_speed.col(j)).cwiseAbs().maxCoeff(), close) << "seed " << seed;
    }
  }
}

/// A section at the root carries what the hinge does, in every field and of every kind of beam: rods, with extension,
/// shear and rotary inertia, free at their root, stiff.
TEST_P(FieldLoads, reach_the_root_of_every_beam_through_its_sections) {
  const bool exact = GetParam() == "exact";
  const std::vector<std::string> beams = {
      "bending_y: {stiffness: 40, modes: 3}, torsion: {stiffness: 30, inertia: 0.003, modes: 1}",
      exact ? "bending_y: {stiffness: 40, modes: 1}"
            : "bending_y: {stiffness: 40, modes: 2, rotary_inertia: 0.004}, bending_z: {stiffness: 50, modes: 1}, "
              "extension: {stiffness: 900, modes: 2}, shear_y: {stiffness: 700, modes: 1}",
      exact ? "bending_z: {stiffness: 40, modes: 2}"
            : "bending_y: {stiffness: 40, modes: 3, family: free-free}, bending_z: {stiffness: 50, modes: 2, family: "
              "pinned-free}",
      "torsion: {stiffness: 30, inertia: 0.003, modes: 0}"};
  std::string text =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  bus: {type: rigid, mass: 3, inertia: [2, 3, 4, 0, 0, 0]}\n";
  std::string hinges = "hinges:\n  base: {type: free, parent: world, child: bus}\n", modes;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const std::string name = "beam" + std::to_string(k);
    text += "  " + name + ": {type: beam, length: 1.4, mass_per_length: [[0, 1.2], [0.9, 0.7], [1.4, 0.5]], " +
            beams[k] + "}\n";
    hinges += "  h" + std::to_string(k) + ": {type: revolute, axis: [0.6, 0, 0.8], parent: " +
              (k == 0 ? "bus" : "beam" + std::to_string(k - 1) + ".tip") + ", child: " + name + "}\n";
  }
  Case c(text + hinges + every_field, GetParam());
  for (std::size_t i = 7; i < c.state.y.size() - 1; ++i) c.state.y[i] = 0.02 * std::sin(2.0 * static_cast<double>(i));
  c.state.time = 0.3;
  std::vector<SectionPlace> roots;
  for (int b = 1; b <= static_cast<int>(beams.size()); ++b) roots.push_back({b, 0});
  const auto sensed = c.equations->make_sensed_state(roots);
  ASSERT_TRUE(sensed->observe(c.state));
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const Wrench a = sensed->reaction(roots[i].body), b = sensed->section(i).inner;
    const double close = 1e-9 * (1 + a.force.norm() + a.moment.norm());
    EXPECT_LT(std::abs(a.force.norm() - b.force.norm()), close) << i;
    EXPECT_LT(std::abs(a.moment.norm() - b.moment.norm()), close) << i;
    EXPECT_GT(a.force.norm(), 0.1) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, FieldLoads, testing::ValuesIn(formulations), formulation_name);

/// ∫ f g dm, or of the second moments about places, of fields that are columns of a matrix, with rows √weight · f.
Eigen::MatrixXd integrals(const Eigen::MatrixXd& fields) { return fields.transpose() * fields; }

/// The fields 1, X, Φ, Γ of mass, and Ψ, Θ beside 1 of what turns, at the points of a body.
Eigen::MatrixXd fields_at(const PointExpansion& at, double weight, bool turning) {
  std::vector<double> row{1};
  const auto take = [&](const auto& m) { row.insert(row.end(), m.data(), m.data() + m.size()); };
  if (!turning) take(at.X);
  take(turning ? at.psi : at.phi);
  for (const Eigen::MatrixXd& m : turning ? at.theta : at.gamma) take(m);
  return std::sqrt(weight) * Eigen::Map<const Eigen::RowVectorXd>(row.data(), static_cast<Eigen::Index>(row.size()));
}

/// The mass matrix, weight and every force of a field that is linear in place and velocity are made of the integrals
/// ∫ f g dm of the fields f, g = 1, X, Φ_i, Γ_ij, whatever a formulation keeps of them: where mass points have these as
/// the body has, a field acts as through them. The points of a rod are not the particles that its mass matrix is of.
TEST(MassPoints, have_all_integrals_of_the_body) {
  const std::string beam = "type: beam, length: 1.4, ";
  const std::string tapered = "mass_per_length: [[0, 1.2], [0.9, 0.7], [1.4, 0.5]], ";
  const std::vector<std::string> bodies = {
      beam + "mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 4}, bending_z: {stiffness: 30, modes: 3}",
      beam + "mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 4, family: orthogonal-polynomials}",
      beam + "mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 6, family: free-free}",
      beam + tapered + "bending_y: {stiffness: [[0, 40], [1.4, 9]], modes: 3}, bending_z: {stiffness: 50, modes: 2}",
      beam + tapered + "bending_y: {stiffness: 40, modes: 2}, torsion: {stiffness: 30, inertia: 0.003, modes: 2}"};
  for (const std::string& text : bodies) {
    const Case c("format: withy/1\ntime: {end: 1}\nbodies: {b: {" + text +
                     "}}\nhinges: {root: {type: weld, parent: world, child: b}}\n",
                 "quadratic");
    const Body& body = *c.scene.model->bodies()[0].body;
    for (const bool turning : {false, true}) {
      Eigen::MatrixXd of_points, of_body;
      const auto add = [&](Eigen::MatrixXd& sum, const PointExpansion& at, double weight) {
        const Eigen::MatrixXd one = integrals(fields_at(at, weight, turning));
        if (sum.size() == 0) sum = Eigen::MatrixXd::Zero(one.rows(), one.cols());
        sum += one;
      };
      for (const MassPoint& p : mass_points(body)) add(of_points, p.at, turning ? p.second.trace() : p.mass);
      if (turning) {
        for (const Section& s : body.shape().sections) add(of_body, s.at, 0.5 * s.inertia.trace());
      } else {
        for (const Particle& p : body.shape().particles) add(of_body, p.at, p.mass);
      }
      if (of_body.size() == 0) of_body = Eigen::MatrixXd::Zero(of_points.rows(), of_points.cols());
      const Eigen::VectorXd size = of_points.diagonal().cwiseMax(of_body.diagonal()).cwiseSqrt();
      for (Eigen::Index i = 0; i < of_body.rows(); ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
          EXPECT_NEAR(of_points(i, j), of_body(i, j), 1e-12 * size[i] * size[j]) << text << ": " << i << ", " << j;
      EXPECT_EQ(of_body(0, 0) > 0, !turning || text.find("torsion") != std::string::npos) << text;
    }
  }
}

/// N = ½ ρA ω² (L² − x²) in a rod at rest along the radius of turning axes, stiff or with modes of any strain that does
/// not stretch it.
TEST(FieldLoadsUntruncated, of_turning_axes_pull_a_rod_as_the_closed_form_says) {
  constexpr double w = 3, L = 2, rho = 1.5;
  const std::vector<std::string> rods = {"", ", bending_y: {stiffness: 40, modes: 3}",
                                         ", bending_y: {stiffness: 40, modes: 2, rotary_inertia: 0.01}",
                                         ", bending_y: {stiffness: 40, modes: 3, family: free-free}"};
  for (const std::string& rod : rods) {
    Case c("format: withy/1\ntime: {end: 1}\nbodies: {rod: {type: beam, length: 2, mass_per_length: 1.5" + rod +
               "}}\nhinges: {root: {type: weld, parent: world, child: rod}}\nloads: {axes: {type: rotating-frame, "
               "rate: 3}}\n",
           "quadratic");
    const std::vector<double> x = {0, 0.3, 1.1, 1.9};
    std::vector<SectionPlace> places;
    for (const double at : x) places.push_back({0, at});
    const auto sensed = c.equations->make_sensed_state(places);
    ASSERT_TRUE(sensed->observe(c.state));
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Wrench in = sensed->section(i).inner;
      EXPECT_NEAR(in.force.x(), -0.5 * rho * w * w * (L * L - x[i] * x[i]), 1e-10) << rod << ", x = " << x[i];
      EXPECT_NEAR(in.moment.norm(), 0, 1e-10) << rod << ", x = " << x[i];
    }
  }
}

const std::vector<std::string> untruncated = {"quadratic", "linear", "exact"};

/// Axes that turn, or a tree on a shaft that is driven: the other accelerations and the reactions are the same.
TEST(FieldLoadsUntruncated, of_turning_axes_act_as_a_driven_shaft) {
  const std::string tree =
      "  arm: {type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 2}, bending_z: "
      "{stiffness: 60, modes: 1}, torsion: {stiffness: 30, inertia: 0.02, modes: 1}}\n"
      "  bob: {type: rigid, mass: 0.5, center_of_mass: [0.1, 0.2, 0], inertia: [0.02, 0.03, 0.04, 0.001, 0, 0]}\n";
  const std::string hinges =
      "type: spherical, child: arm}\n  end: {type: universal, first_axis: [0, 1, 0], "
      "second_axis: [0, 0, 1], parent: arm.tip, child: bob}\n";
  const std::string head = "format: withy/1\ntime: {end: 1}\nbodies:\n";
  for (const std::string& formulation : untruncated) {
    Case turning(head + tree + "hinges:\n  root: {parent: world, " + hinges +
                     "loads: {axes: {type: rotating-frame, axis: [0, 0, 2], rate: 1.5, acceleration: -0.7}}\n",
                 formulation);
    Case driven(head + "  shaft: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n" + tree +
                    "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: shaft}\n"
                    "  root: {parent: shaft, " +
                    hinges + "motions: {drive: {hinge: axle, type: table, table: [[0, 0], [1, 0]]}}\n",
                formulation);
    const Layout &a = turning.scene.model->layout(), &b = driven.scene.model->layout();
    double next = 0.1;
    const auto set = [&](const Slot& x, const Slot& y, bool unit) {
      for (std::size_t i = 0; i < x.positions; ++i)
        turning.state.y[x.position + i] = driven.state.y[y.position + i] = unit ? (i == 0   ? 0.8
                                                                                   : i == 1 ? 0.6
                                                                                            : 0)
                                                                                : 0.2 * (next = std::sin(9 * next));
      for (std::size_t i = 0; i < x.speeds; ++i)
        turning.state.y[a.positions + x.speed + i] = driven.state.y[b.positions + y.speed + i] = next =
            std::sin(7 * next + 1);
    };
    set(*a.hinge("root"), *b.hinge("root"), true);
    set(*a.hinge("end"), *b.hinge("end"), false);
    set(*a.body("arm"), *b.body("arm"), false);
    // The dense equations take any acceleration of the shaft.
    driven.state.y[b.positions + b.hinge("axle")->speed] = 1.5;
    const DenseSystem one = turning.equations->system(0, turning.state.y);
    const DenseSystem two = driven.equations->system(0, driven.state.y);
    const std::size_t shaft = b.hinge("axle")->speed;
    double size = 1;
    for (const double f : two.force) size = std::max(size, std::abs(f));
    for (const auto& [x, y] : {std::pair(a.hinge("root"), b.hinge("root")), std::pair(a.hinge("end"), b.hinge("end")),
                               std::pair(a.body("arm"), b.body("arm"))}) {
      for (std::size_t i = 0; i < x->speeds; ++i) {
        const double mine = one.force[x->speed + i] + one.applied[x->speed + i];
        const double theirs = two.force[y->speed + i] - two.mass[(y->speed + i) * two.size + shaft] * -0.7;
        EXPECT_NEAR(mine, theirs, 1e-10 * size) << formulation;
      }
    }
  }
}

/// Σ −μ m/|p| − ½ S:∂²(μ/|p|) of the mass points of a tree, from the motion of frames as sensors see it.
double potential_of(const Case& c, const State& state, double parameter, const Vector3& center) {
  const Model& model = *c.scene.model;
  const FieldLoad& field = *field_of(model);
  Work work = c.equations->make_work();
  const auto sensed = c.equations->make_sensed_state({});
  EXPECT_TRUE(sensed->observe(state));
  double potential = 0;
  for (const FrameIndex& at : field.frames()) {
    const FrameMotion m = sensed->motion(at);
    const MassPoint& point = field.point(at);
    const Vector3 p = m.position - center;
    const double d = p.norm();
    const Matrix3 S = m.R * point.second * m.R.transpose();
    potential -= parameter * (point.mass / d + 0.5 * (3 * p.dot(S * p) / std::pow(d, 5) - S.trace() / std::pow(d, 3)));
  }
  return potential;
}

TEST(FieldLoadsUntruncated, of_a_point_mass_do_the_work_of_its_potential) {
  for (const std::string& formulation : untruncated) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      Case c = random_tree(seed, {.bodies = 4, .any_root = seed % 2 == 0 && formulation != "exact"},
                           "loads: {star: {type: point-gravity, parameter: 30, center: [0.5, -2, 6]}}\n", formulation);
      std::vector<double> efforts(c.equations->layout().speeds);
      Work work = c.equations->make_work();
      c.equations->load_efforts(c.state.time, c.state.y, EquationsOfMotion::all_loads, efforts, work);
      double power = 0;
      for (std::size_t i = 0; i < efforts.size(); ++i)
        power += efforts[i] * c.state.y[c.equations->layout().positions + i];
      const double slope =
          central_difference([&](double h) { return potential_of(c, moved(c, h), 30, Vector3(0.5, -2, 6)); }, 1e-3);
      EXPECT_NEAR(power, -slope, 1e-9 * (1 + std::abs(power))) << formulation << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace withy::test
