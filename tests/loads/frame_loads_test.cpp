// Forces, moments, springs and thrusters at frames: what they are, and what beams and free bodies do under them.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A rigid body of 2 kg, inertia 0.1, 0.2, 0.3 kg m², free to move, with a frame turned by 90° about z.
std::string free_body(const std::string& loads, const std::string& more = "") {
  return "format: withy/1\ntime: {end: 2, output: 0.5}\nintegrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}\n"
         "bodies:\n  bus: {type: rigid, mass: 2, inertia: [.1, .2, .3, 0, 0, 0], frames: {jet: {position: [0.5, 0, 0], "
         "orientation: [0.7071067811865476, 0, 0, 0.7071067811865476]}}}\n"
         "hinges: {float: {type: free, parent: world, child: bus}}\nloads:\n" +
         loads + more;
}

Vector3 position(const LoadedScene& s, const State& state) {
  return Vector3(state.y.data() + s.hinge("float").position + 4);
}
Vector3 velocity(const LoadedScene& s, const State& state) {
  return Vector3(state.y.data() + s.scene.model->layout().positions + s.hinge("float").speed + 3);
}
Vector3 spin(const LoadedScene& s, const State& state) {
  return Vector3(state.y.data() + s.scene.model->layout().positions + s.hinge("float").speed);
}

TEST(Force, accelerates_a_free_body_along_world_axes) {
  LoadedScene s(free_body("  push: {type: force, frame: bus, law: constant, value: [1, -2, 4]}\n"));
  const State end = s.run().back();
  EXPECT_LT((velocity(s, end) - Vector3(1, -2, 4)).norm(), 1e-12);  // F t / m = F · 2 / 2
  EXPECT_LT((position(s, end) - Vector3(1, -2, 4)).norm(), 1e-12);  // F t² / 2 m
  EXPECT_NEAR(end.y.back(), 21, 1e-10);                             // F · x
  EXPECT_LT(s.summary.energy_drift, 1e-12);
}

/// The frame's own axes: its y is −x of the body.
TEST(Force, follows_its_frame_and_turns_the_body_about_its_centre_of_mass) {
  LoadedScene s(free_body("  push: {type: force, frame: bus.jet, following: true, law: constant, value: [3, 0, 0]}\n"));
  const auto runs = s.run();
  // Force along the body's y at 0.5 m on its x: moment 1.5 N m about z, 0.3 kg m²; 5 rad/s², 10 rad after 2 s.
  const State& end = runs.back();
  EXPECT_NEAR(spin(s, end).z(), 10, 1e-9);
  // v = ∫ F/m (−sin, cos)(5 t²/2) dt by Simpson's rule.
  Vector3 v = Vector3::Zero();
  constexpr int n = 20000;
  for (int i = 0; i <= n; ++i) {
    const double t = 2.0 * i / n, angle = 2.5 * t * t;
    const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * 2.0 / n / 3;
    v += weight * 1.5 * Vector3(-std::sin(angle), std::cos(angle), 0);
  }
  EXPECT_LT((velocity(s, end) - v).norm(), 1e-8);
  EXPECT_LT(s.summary.energy_drift, 1e-9);
}

TEST(Torque, is_a_moment_in_world_axes_or_the_frames) {
  LoadedScene world(free_body("  turn: {type: torque, frame: bus.jet, law: constant, value: [0, 0, 0.6]}\n"));
  EXPECT_LT((spin(world, world.run().back()) - Vector3(0, 0, 4)).norm(), 1e-10);
  // The frame's −y is the body's x.
  LoadedScene body(
      free_body("  turn: {type: torque, frame: bus.jet, following: true, law: constant, value: [0, -0.1, 0]}\n"));
  const State end = body.run().back();
  EXPECT_LT((spin(body, end) - Vector3(2, 0, 0)).norm(), 1e-10);
  EXPECT_LT(velocity(body, end).norm(), 1e-12);
}

TEST(Thruster, gives_its_impulse_between_its_switches_which_it_declares) {
  LoadedScene s(
      free_body("  jet: {type: thruster, frame: bus, thrust: 3, direction: [0, 0, 2], firings: [[0.1, 0.4], [0.4, "
                "0.7], [1, 1.25]]}\n"));
  const BoundLoad& jet = *s.scene.model->loads()[0].load;
  EXPECT_THAT(jet.discontinuities(), ElementsAre(0.1, 0.4, 0.7, 1, 1.25));
  EXPECT_EQ(jet.end(), 1.25);
  const State end = s.run().back();
  // Steps land on the switches, so that the piecewise constant force is integrated to rounding.
  EXPECT_LT((velocity(s, end) - Vector3(0, 0, 3 * 0.85 / 2)).norm(), 1e-13);
  EXPECT_EQ(s.summary.steps.rejected, 0U);
}

TEST(Thruster, pushes_as_hard_whatever_the_length_of_its_direction) {
  std::vector<Vector3> reached;
  for (const char* direction :
       {"[1, 2, 0]", "[1.0e200, 2.0e200, 0]", "[1.0e-200, 2.0e-200, 0]", "[5e-324, 1e-323, 0]"}) {
    LoadedScene s(
        free_body(std::string("  jet: {type: thruster, frame: bus, thrust: 3, firings: [[0, 1]], direction: ") +
                  direction + "}\n"));
    reached.push_back(velocity(s, s.run().back()));
    EXPECT_GT(reached.back().norm(), 1) << direction;
    EXPECT_LT((reached.back() - reached.front()).norm(), 1e-12) << direction;
  }
}

/// It is fixed in its frame: burning all the time it does what a following force does.
TEST(Thruster, turns_with_its_frame) {
  LoadedScene jet(
      free_body("  jet: {type: thruster, frame: bus.jet, thrust: 3, direction: [2, 0, 0], firings: [[0, 9]]}\n"));
  LoadedScene push(
      free_body("  push: {type: force, frame: bus.jet, following: true, law: constant, value: [3, 0, 0]}\n"));
  const State a = jet.run().back(), b = push.run().back();
  EXPECT_GT(spin(jet, a).z(), 9);
  EXPECT_LT((velocity(jet, a) - velocity(push, b)).norm(), 1e-12);
  EXPECT_LT((position(jet, a) - position(push, b)).norm(), 1e-12);
}

std::unique_ptr<Load> spring(std::vector<Value::Member> given) {
  Registry registry = load_registry();
  given.emplace_back("frame", Value(std::string("payload")));
  return make_plugin<Load>(registry, "spring-damper", std::move(given));
}

TEST(SpringDamper, pulls_along_the_line_and_is_defined_where_there_is_none) {
  const Model model = two_link_arm(2);
  const auto bound = spring({{"anchor", list_of({1, 0, 0})},
                             {"stiffness", Value(10.0)},
                             {"damping", Value(3.0)},
                             {"free_length", Value(0.4)}})
                         ->bind(model);
  std::vector<FrameMotion> motion(1);
  std::vector<Wrench> wrench(1);
  const auto force = [&](const Vector3& p, const Vector3& v) {
    motion[0].position = p;
    motion[0].velocity = v;
    bound->wrenches(0, motion, wrench);
    EXPECT_EQ(wrench[0].moment, Vector3(0, 0, 0));
    return wrench[0].force;
  };
  EXPECT_LT((force({0, 0, 0}, {2, 5, 0}) - Vector3(10 * 0.6 - 3 * 2, 0, 0)).norm(), 1e-14);
  EXPECT_LT((force({1, 0.1, 0}, {0, 0, 1}) - Vector3(0, 10 * 0.3, 0)).norm(), 1e-14);
  EXPECT_LT((force({1, 0, 0}, {0, 2, 0}) - Vector3(0, -6, 0)).norm(), 1e-14);  // coincident: against the motion
  EXPECT_EQ(force({1, 0, 0}, {0, 0, 0}), Vector3(0, 0, 0));
  EXPECT_TRUE(force({1 + 1e-300, 0, 0}, {1e-300, 0, 0}).allFinite());
}

/// Two masses joined by a spring, thrown while they spin: kinetic and spring energy, linear and angular momentum stay.
TEST(SpringDamper, between_two_bodies_conserves_energy_and_momentum) {
  const auto run = [](double damping) {
    LoadedScene s(
        "format: withy/1\ntime: {end: 3, output: 0.1}\nintegrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}\nbodies:\n"
        "  a: {type: rigid, mass: 2, inertia: [.1, .2, .3, 0, 0, 0], frames: {eye: {position: [0.1, 0.2, 0]}}}\n"
        "  b: {type: rigid, mass: 1, inertia: [.1, .1, .2, 0, 0, 0], frames: {eye: {position: [-0.1, 0, 0.1]}}}\n"
        "hinges:\n  fa: {type: free, parent: world, child: a}\n  fb: {type: free, parent: world, child: b}\n"
        "loads: {rope: {type: spring-damper, frame: a.eye, to: b.eye, stiffness: 40, free_length: 0.7, damping: " +
        std::to_string(damping) +
        "}}\ninitial: {hinges: {fa: {rate: [0.5, 1, 0, 0, 1, 0]}, fb: {position: [1, 0, 0, 0, 1, 0, 0.2], rate: [0, 0, "
        "2, 0, -2, 0.3]}}}\n");
    const auto states = s.run();
    const auto total = [&](const State& state) {
      const Energies e = s.equations->energies(state.y);
      const Vector3 p(s.equations->frame_pose(state.y, 0, 1).position.data());
      const Vector3 q(s.equations->frame_pose(state.y, 1, 1).position.data());
      const double stretch = (p - q).norm() - 0.7;
      return std::pair(e.kinetic + 20 * stretch * stretch, e);
    };
    const auto [start, first] = total(states.front());
    double before = start;
    for (const State& state : states) {
      const auto [energy, e] = total(state);
      if (damping == 0) {
        EXPECT_NEAR(energy, start, 1e-8 * start);
      } else {
        EXPECT_LE(energy, before + 1e-9);
      }
      before = energy;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(e.linear_momentum[k], first.linear_momentum[k], 1e-9);
        EXPECT_NEAR(e.angular_momentum[k], first.angular_momentum[k], 1e-8);
      }
    }
    EXPECT_LT(s.summary.energy_drift, 1e-9);
    return before;
  };
  EXPECT_LT(run(3.0), 0.9 * run(0));
}

/// A clamped beam of 2 m, EI_z = 50 and EI_y = 70 N m², GJ = 30 N m², with a force or moment at its tip.
std::string cantilever(const std::string& load, int modes, const std::string& family, const std::string& formulation,
                       bool spatial = true) {
  const std::string count = std::to_string(modes);
  return "format: withy/1\nformulation: " + formulation +
         "\nbodies:\n  beam:\n    type: beam\n    length: 2\n    mass_per_length: 1\n    bending_y: {stiffness: 50, "
         "modes: " +
         count + ", family: " + family + "}\n" +
         (spatial ? "    bending_z: {stiffness: 70, modes: " + count + ", family: " + family + "}\n" : "") +
         "    torsion: {stiffness: 30, inertia: 0.01, modes: " + count + ", family: " + family +
         "}\nhinges: {root: {type: weld, parent: world, child: beam}}\nloads: {tip: {type: " + load + "}}\n";
}

/// Efforts of the scene's load at modal coordinates q.
Eigen::VectorXd efforts_at(const LoadedScene& s, const Eigen::VectorXd& q) {
  State state = s.scene.initial;
  Eigen::Map<Eigen::VectorXd>(state.y.data(), q.size()) = q;
  std::vector<double> e(static_cast<std::size_t>(q.size()));
  Work work = s.equations->make_work();
  s.equations->load_efforts(0, state.y, EquationsOfMotion::all_loads, e, work);
  return Eigen::Map<Eigen::VectorXd>(e.data(), q.size());
}
const Eigen::MatrixXd& stiffness(const LoadedScene& s) { return s.scene.model->bodies()[0].body->shape().stiffness; }

/// Polynomials hold the cubic and the quadratic that statics gives exactly.
TEST(TipLoad, deflects_a_cantilever_as_beam_theory_says) {
  for (const char* formulation : {"ruthless", "inconsistent", "consistent", "quadratic", "linear", "exact"}) {
    const auto deflection = [&](const std::string& load) {
      const LoadedScene s(cantilever(load, 3, "orthogonal-polynomials", formulation));
      const Eigen::VectorXd f = efforts_at(s, Eigen::VectorXd::Zero(9));
      const Eigen::VectorXd q = stiffness(s).ldlt().solve(f);
      State bent = s.scene.initial;
      Eigen::Map<Eigen::VectorXd>(bent.y.data(), 9) = 1e-4 * q;  // small: beyond the linear theory nothing is left
      const auto d = s.equations->deflection(bent.y, 0, s.scene.model->bodies()[0].frame("tip"));
      return Vector3(1e4 * Vector3(d.data()));
    };
    const double L3 = 8.0 / 3, L2 = 4.0 / 2;
    // 1e-7: what second order adds at 1e-4 of the deflection, and only along x.
    EXPECT_NEAR(deflection("force, frame: beam.tip, law: constant, value: [0, 1.5, 0]").y(), 1.5 * L3 / 50, 1e-7);
    EXPECT_NEAR(deflection("force, frame: beam.tip, law: constant, value: [0, 0, 1.5]").z(), 1.5 * L3 / 70, 1e-7);
    EXPECT_NEAR(deflection("torque, frame: beam.tip, law: constant, value: [0, 0, 2]").y(), 2 * L2 / 50, 1e-7);
    EXPECT_NEAR(deflection("torque, frame: beam.tip, law: constant, value: [0, 2, 0]").z(), -2 * L2 / 70, 1e-7);
  }
}

/// Change of the efforts of a load with q at q = 0, by central differences: minus the geometric stiffness.
Eigen::MatrixXd tangent(const LoadedScene& s) {
  const Eigen::Index n = stiffness(s).rows();
  Eigen::MatrixXd G(n, n);
  constexpr double h = 1e-5;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd q = h * Eigen::VectorXd::Unit(n, i);
    G.col(i) = (efforts_at(s, q) - efforts_at(s, -q)) / (2 * h);
  }
  return G;
}

/// The least factor of the load at which K q = factor · G q has a solution; infinite where there is none.
double critical_factor(const LoadedScene& s) {
  const Eigen::MatrixXd G = tangent(s);
  // A dead load has a potential. 1e-6 covers the exact kinematics' interpolation, 1e-7 of itself, and the differences.
  EXPECT_LT((G - G.transpose()).cwiseAbs().maxCoeff(), 1e-6 * G.cwiseAbs().maxCoeff() + 1e-9);
  const Eigen::MatrixXd symmetric = 0.5 * (G + G.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric, stiffness(s),
                                                                        Eigen::EigenvaluesOnly);
  const double most = eigen.eigenvalues().cwiseAbs().maxCoeff();
  return most > 1e-7 ? 1 / most : std::numeric_limits<double>::infinity();
}

/// Euler: P L²/EI = π²/4, in the weaker plane.
TEST(TipLoad, buckles_a_cantilever_at_eulers_load) {
  for (const char* formulation : {"consistent", "quadratic", "exact"}) {
    const LoadedScene s(cantilever("force, frame: beam.tip, law: constant, value: [-1, 0, 0]", 5,
                                   "orthogonal-polynomials", formulation));
    const double euler = std::numbers::pi * std::numbers::pi / 4 * 50 / 4;
    EXPECT_NEAR(critical_factor(s), euler, 1e-6 * euler) << formulation;
  }
}

/// Lateral buckling of a beam that is rigid in the load's plane (Prandtl, Michell 1899): P L²/√(EI GJ) = 4.0126; with n
/// clamped-free modes of bending and of twist 4.0395, 4.0154, 4.0135 for n = 2, 4, 6 (docs/theory, computed there by an
/// independent brute-force program).
TEST(TipLoad, buckles_a_deep_cantilever_sideways) {
  const double scale = std::sqrt(50.0 * 30.0) / 4;
  for (const char* formulation : {"consistent", "quadratic", "exact"}) {
    const auto load = [&](int modes, const char* family) {
      const LoadedScene s(
          cantilever("force, frame: beam.tip, law: constant, value: [0, 0, -1]", modes, family, formulation, false));
      return critical_factor(s) / scale;
    };
    EXPECT_NEAR(load(2, "clamped-free"), 4.0395, 1e-4) << formulation;
    EXPECT_NEAR(load(4, "clamped-free"), 4.0154, 1e-4) << formulation;
    EXPECT_NEAR(load(6, "clamped-free"), 4.0135, 1e-4) << formulation;
    EXPECT_NEAR(load(8, "orthogonal-polynomials"), 4.0126, 1e-4) << formulation;
  }
}

TEST(TipLoad, does_not_buckle_what_has_no_second_order) {
  for (const char* formulation : {"ruthless", "inconsistent", "linear"}) {
    const LoadedScene s(
        cantilever("force, frame: beam.tip, law: constant, value: [-1, 0, 0]", 4, "clamped-free", formulation));
    EXPECT_EQ(critical_factor(s), std::numeric_limits<double>::infinity()) << formulation;
  }
}

/// A follower force has no potential: its tangent is not symmetric.
TEST(TipLoad, that_follows_has_no_potential) {
  const LoadedScene s(cantilever("force, frame: beam.tip, following: true, law: constant, value: [-1, 0, 0]", 3,
                                 "clamped-free", "quadratic"));
  const Eigen::MatrixXd G = tangent(s);
  EXPECT_GT((G - G.transpose()).cwiseAbs().maxCoeff(), 0.1);
}

TEST(FrameLoads, conform) {
  const Model model = two_link_arm(2);
  Registry registry = load_registry();
  const Value frame(std::string("link2.tip"));
  const Value rows = Value::list({list_of({0, 1, 2, 3}), list_of({0.5, 4, 5, 6}), list_of({0.8, 0, 0, 0})});
  for (const char* id : {"force", "torque"}) {
    for (const char* law : {"table", "steps"}) {
      for (const bool following : {false, true}) {
        const auto load = make_plugin<Load>(
            registry, id,
            {{"frame", frame}, {"law", Value(std::string(law))}, {"table", rows}, {"following", Value(following)}});
        expect_load_conforms(*load, model);
        EXPECT_EQ(load->bind(model)->end(), 0.8);
        EXPECT_THAT(load->bind(model)->discontinuities(), ElementsAre(0, 0.5, 0.8));
      }
    }
  }
  expect_load_conforms(*make_plugin<Load>(registry, "thruster",
                                          {{"frame", frame},
                                           {"thrust", Value(2.0)},
                                           {"direction", list_of({1, 1, 0})},
                                           {"firings", Value::list({list_of({0, 1}), list_of({2, 3})})}}),
                       model);
  expect_load_conforms(*spring({{"to", Value(std::string("hub.out"))}, {"stiffness", Value(5.0)}}), model);
}

TEST(FrameLoads, say_what_is_wrong_with_them) {
  const auto problem = [](const std::string& load) { return problem_of(free_body("  x: {type: " + load + "}\n")); };
  EXPECT_EQ(problem("force, frame: bus.jet, law: constant, value: [1, 0, 0]"), "");
  EXPECT_THAT(problem("force, frame: bus.yet, law: constant, value: [1, 0, 0]"), HasSubstr("did you mean 'bus.jet'?"));
  EXPECT_THAT(problem("force, frame: bus, law: constant"), HasSubstr("the law 'constant' needs 'value'"));
  EXPECT_THAT(problem("force, frame: bus, law: constant, value: 3"), HasSubstr("/loads/x/value"));
  EXPECT_THAT(problem("torque, frame: bus, law: sine, amplitude: [0, 0, 1]"), HasSubstr("'period' and 'frequency'"));
  EXPECT_THAT(problem("spring-damper, frame: bus, stiffness: 1"), HasSubstr("needs one of 'to'"));
  EXPECT_THAT(problem("spring-damper, frame: bus, to: bus, stiffness: 1"), HasSubstr("is the frame itself"));
  EXPECT_THAT(problem("spring-damper, frame: bus, anchor: [0, 0, 0]"), HasSubstr("does nothing"));
  EXPECT_THAT(problem("thruster, frame: bus, thrust: 1, direction: [0, 0, 0], firings: [[0, 1]]"),
              HasSubstr("has no length"));
  EXPECT_THAT(problem("thruster, frame: bus, thrust: 1, direction: [0, 0, 1], firings: [[0, 1], [0.5, 2]]"),
              HasSubstr("begins before the row above it ends"));
  EXPECT_THAT(problem("thruster, frame: bus, thrust: 1, direction: [0, 0, 1], firings: [[1, 1]]"),
              HasSubstr("switched off before it is on"));
}

}  // namespace
}  // namespace withy::test
