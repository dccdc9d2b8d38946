/// \file
/// Beams cut into segments: the same beam, without a limit on its deflection.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

struct Compiled {
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  [[nodiscard]] const Model& model() const { return *scene.model; }
};

class Segments : public testing::Test {
 protected:
  Segments() { enroll_static_plugins(registry_); }

  Compiled compiled(const std::string& text, std::vector<std::string> overrides = {}) {
    Compiled c{parse_scene(text, "s.yaml", registry_, {"", "", std::move(overrides)}), nullptr};
    c.equations = c.scene.formulation->compile(c.scene.model);
    return c;
  }
  std::string problems(const std::string& text) {
    try {
      parse_scene(text, "s.yaml", registry_, {});
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  }

  Registry registry_;
};

/// A cantilever along x with EI = 1 and L = 1, next to no mass of its own, and 1 kg at its tip.
std::string cantilever(int segments, int modes, double gravity, const std::string& formulation = "quadratic") {
  return "format: withy/1\ntime: {end: 1}\nformulation: " + formulation + "\ngravity: [0, " + std::to_string(gravity) +
         ", 0]\nbodies:\n  boom: {type: beam, length: 1, mass_per_length: 1e-9, segments: " + std::to_string(segments) +
         ", bending_y: {stiffness: 1, modes: " + std::to_string(modes) +
         ", family: orthogonal-polynomials}}\n  end: {type: rigid, mass: 1}\n"
         "hinges:\n  root: {type: weld, parent: world, child: boom}\n  tip: {type: weld, parent: boom.tip, child: "
         "end}\n";
}

Vector3 tip_of(const Compiled& c, const State& state, const char* frame = "boom.tip") {
  const auto at = c.model().find_frame(frame);
  return Eigen::Map<const Vector3>(c.equations->frame_pose(state.y, at->body, at->frame).position.data());
}

/// Modal coordinates at rest: f(q) = 0 by Newton's iteration. f is minus what holds the accelerations at zero.
State at_rest(const Compiled& c, const State& start) {
  State state = start;
  const auto n = static_cast<Eigen::Index>(c.equations->layout().speeds);
  const std::vector<double> none(static_cast<std::size_t>(n), 0.0);
  Work work = c.equations->make_work();
  const auto residual = [&](const State& s) {
    Eigen::VectorXd efforts(n);
    c.equations->inverse_dynamics(s.y, none, {efforts.data(), none.size()}, work);
    return efforts;
  };
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::MatrixXd tangent(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      State plus = state, minus = state;
      plus.y[static_cast<std::size_t>(j)] += 1e-6;
      minus.y[static_cast<std::size_t>(j)] -= 1e-6;
      tangent.col(j) = (residual(plus) - residual(minus)) / 2e-6;
    }
    Eigen::Map<Eigen::VectorXd> q(state.y.data(), n);
    const Eigen::VectorXd step = tangent.partialPivLu().solve(residual(state));
    q -= step;
    if (step.norm() < 1e-12) break;
  }
  return state;
}
State at_rest(const Compiled& c) { return at_rest(c, c.scene.initial); }

/// A dead end force P L²/EI = 10: the tip of the elastica is at x = 0.4450044, y = 0.8106090 (rod_test.cpp has the
/// source), demanded to 1e-4. The force is the weight of the tip's mass, which the beam's own adds 5e-9 to.
TEST_F(Segments, end_force_bends_a_cantilever_as_the_elastica) {
  State state = compiled(cantilever(32, 2, 0)).scene.initial;
  Vector3 tip;
  for (int force = 1; force <= 10; ++force) {
    const Compiled c = compiled(cantilever(32, 2, force));
    state = at_rest(c, state);
    tip = tip_of(c, state);
  }
  EXPECT_NEAR(tip.x(), 0.4450044, 1e-4);
  EXPECT_NEAR(tip.y(), 0.8106090, 1e-4);
}

/// An end moment M = 2π EI/L bends it into a circle. In a plane the moment works through the angle of the tip alone,
/// the sum of the segments' own: K q = M ψ(tip) in each. Demanded: 1e-3 L.
TEST_F(Segments, end_moment_bends_a_cantilever_into_a_circle) {
  const Compiled c = compiled(cantilever(32, 1, 0));
  State state = c.scene.initial;
  for (const int b : c.model().segments("boom")) {
    const BodyNode& node = c.model().bodies()[static_cast<std::size_t>(b)];
    const Slot& slot = *c.model().layout().body(node.name);
    const PointExpansion tip = *node.body->station(std::string("tip"));
    state.y[slot.position] = 2 * std::numbers::pi * tip.psi(2, 0) / node.body->shape().stiffness(0, 0);
  }
  EXPECT_LT(tip_of(c, state).norm(), 1e-3);
  // The frame that the tip is measured in is the root's.
  for (const Tip& tip : tips(c.model())) {
    if (tip.body != "boom") continue;
    EXPECT_NEAR(deflection(*c.equations, state.y, tip)[0], -1, 1e-3);
  }
}

/// Beam theory for a tip force F: F L³/3EI, with variable EI = 1 + x: F ∫ (1−x)²/(1+x) dx = F (4 ln 2 − 5/2). Segments
/// with two polynomials bend as a cubic: exact where EI is constant, 3e-5 off with five of them where it varies so.
TEST_F(Segments, static_deflection_is_that_of_the_whole_beam) {
  const double F = 1e-4;
  const auto sag = [&](int n, const std::string& stiffness) {
    const Compiled c = compiled(cantilever(n, 2, F), {"bodies.boom.bending_y.stiffness=" + stiffness});
    return tip_of(c, at_rest(c)).y();
  };
  EXPECT_NEAR(sag(5, "1"), F / 3, 1e-7 * F);
  EXPECT_NEAR(sag(5, "[[0, 1], [1, 2]]"), F * (4 * std::log(2.0) - 2.5), 1e-5 * F);
}

/// A beam of tables over x with a camera on it, on a free hinge.
const std::string tapered =
    "format: withy/1\ntime: {end: 1}\nbodies:\n  boom:\n    type: beam\n    length: 2\n    mass_per_length: [[0, 3], "
    "[0.5, 2], "
    "[2, 1]]\n    segments: 5\n    bending_y: {stiffness: [[0, 40], [2, 20]], modes: 1, family: "
    "orthogonal-polynomials}\n"
    "    torsion: {stiffness: 9, inertia: [[0, 0.02], [2, 0.01]], modes: 1, family: orthogonal-polynomials}\n"
    "    frames: {camera: {at: 1.3, position: [0, 0.1, 0]}}\n"
    "hinges: {base: {type: free, parent: world, child: boom}}\n";

/// The momentum and energy of a rigid motion know mass, centre and inertia.
TEST_F(Segments, mass_centre_and_inertia_are_those_of_the_whole_beam) {
  const auto energies = [&](const std::string& segments) {
    Compiled c = compiled(tapered, {"bodies.boom.segments=" + segments});
    const std::size_t u = c.equations->layout().positions;
    std::vector<double>& y = c.scene.initial.y;
    const Slot& base = *c.model().layout().hinge("base");
    const double rates[] = {0.3, -0.7, 0.5, 1.1, 0.4, -0.2};
    for (std::size_t i = 0; i < 6; ++i) y[u + base.speed + i] = rates[i];
    return c.equations->energies(y);
  };
  const Energies whole = energies("1"), cut = energies("5");
  EXPECT_NEAR(cut.kinetic, whole.kinetic, 1e-12 * whole.kinetic);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(cut.linear_momentum[i], whole.linear_momentum[i], 1e-12);
    EXPECT_NEAR(cut.angular_momentum[i], whole.angular_momentum[i], 1e-12);
  }
}

TEST_F(Segments, frames_are_on_the_segment_where_their_station_lies) {
  const Compiled c = compiled(tapered);
  const auto camera = c.model().find_frame("boom.camera");
  ASSERT_TRUE(camera);
  EXPECT_EQ(c.model().bodies()[static_cast<std::size_t>(camera->body)].name, "boom.4");
  EXPECT_LT((tip_of(c, c.scene.initial, "boom.camera") - Vector3(1.3, 0.1, 0)).norm(), 1e-14);
  EXPECT_LT((tip_of(c, c.scene.initial, "boom.tip") - Vector3(2, 0, 0)).norm(), 1e-14);
  EXPECT_LT(tip_of(c, c.scene.initial, "boom").norm(), 1e-14);
  EXPECT_FALSE(c.model().find_frame("boom.lamp"));
}

/// A hinge may hold the tip: the segments then hang on each other the other way round.
TEST_F(Segments, beam_held_at_its_tip_is_the_same_beam) {
  const std::string text = cantilever(4, 2, 1e-3);
  const std::string held_at_tip =
      "format: withy/1\ntime: {end: 1}\ngravity: [0, 0.001, 0]\nbodies:\n  boom: {type: beam, length: 1, "
      "mass_per_length: "
      "1e-9, segments: 4, bending_y: {stiffness: 1, modes: 2, family: orthogonal-polynomials}}\n  end: {type: rigid, "
      "mass: 1}\nhinges:\n  tip: {type: weld, parent: boom, child: end}\n  root: {type: weld, parent: world, child: "
      "boom.tip, offset: {position: [1, 0, 0]}}\n";
  const Compiled a = compiled(text), b = compiled(held_at_tip);
  EXPECT_NEAR(tip_of(b, at_rest(b), "boom.root").y(), tip_of(a, at_rest(a)).y(), 1e-10);
}

struct DampedMode {
  double omega;  ///< [rad/s]
  double ratio;  ///< vᵀDv/(2ω) with vᵀMv = 1
};

/// Modes of a tree at rest, by differences of its forces.
std::vector<DampedMode> modes_of(const Compiled& c) {
  const DenseSystem rest = c.equations->system(0, c.scene.initial.y);
  const auto n = static_cast<Eigen::Index>(rest.size);
  const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(rest.mass.data(), n, n);
  const auto derivative = [&](std::size_t first) {
    Eigen::MatrixXd J(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      State s = c.scene.initial;
      s.y[first + static_cast<std::size_t>(k)] = 1e-6;
      const DenseSystem at = c.equations->system(0, s.y);
      for (Eigen::Index i = 0; i < n; ++i)
        J(i, k) = (rest.force[static_cast<std::size_t>(i)] - at.force[static_cast<std::size_t>(i)]) / 1e-6;
    }
    return J;
  };
  const Eigen::MatrixXd K = derivative(0), D = derivative(c.equations->layout().positions);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (K + K.transpose()), M);
  std::vector<DampedMode> modes;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double omega = std::sqrt(eigen.eigenvalues()[k]);
    const Eigen::VectorXd v = eigen.eigenvectors().col(k);
    modes.push_back({omega, v.dot(D * v) / (2 * omega)});
  }
  return modes;
}

/// A cantilever of polynomials with a damping ratio of 2 % and what else `more` gives it.
std::string damped_cantilever(int segments, const std::string& more) {
  return "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: 1, mass_per_length: 1, damping_ratio: "
         "0.02, segments: " +
         std::to_string(segments) + ", " + more + "}}\nhinges: {root: {type: weld, parent: world, child: boom}}\n";
}
std::string planes(int modes) {
  const std::string rest = ", modes: " + std::to_string(modes) + ", family: orthogonal-polynomials}";
  return "bending_y: {stiffness: 1" + rest + ", bending_z: {stiffness: 25" + rest;
}

/// Damping ratio 2 % of a cantilever in 8 segments: τ = 2ζ/ω₁ with ω₁ = 1.8751² (Blevins), which two polynomials on the
/// whole beam miss by 0.5 %, and one by 27 %.
TEST_F(Segments, first_mode_has_the_damping_of_the_whole_beams_first_mode) {
  const std::vector<DampedMode> modes =
      modes_of(compiled(damped_cantilever(8, "bending_y: {stiffness: 1, modes: 2, family: orthogonal-polynomials}")));
  EXPECT_NEAR(modes[0].omega, 3.5160153, 1e-4);
  EXPECT_NEAR(modes[0].ratio, 0.02 * modes[0].omega / 3.5160153, 1e-6);
  const std::vector<DampedMode> of_one =
      modes_of(compiled(damped_cantilever(16, "bending_y: {stiffness: 1, modes: 1, family: orthogonal-polynomials}")));
  EXPECT_NEAR(of_one[0].ratio, 0.02 * of_one[0].omega / 3.5160153, 1e-6);
}

/// A root fifty times as stiff as the rest: the ratio of the lowest mode is the one asked, whatever few functions of a
/// segment would make of the whole.
TEST_F(Segments, first_mode_of_a_stepped_beam_has_the_damping_asked) {
  const std::string stepped =
      "bending_y: {stiffness: [[0, 50], [0.25, 50], [0.25001, 1], [1, 1]], modes: 2, family: orthogonal-polynomials}";
  const std::vector<DampedMode> modes = modes_of(compiled(damped_cantilever(8, stepped)));
  EXPECT_NEAR(modes[0].ratio, 0.02, 1e-3 * 0.02);
  for (std::size_t k = 1; k < 4; ++k)
    EXPECT_NEAR(modes[k].ratio / modes[k].omega, modes[0].ratio / modes[0].omega, 1e-9) << "in proportion to stiffness";
}

/// Twist of one angle is the turned beam: each mode has the ratio that it has without twist, and the first of either
/// plane that of the whole.
TEST_F(Segments, twist_of_one_angle_leaves_the_damping_of_each_mode) {
  const std::vector<DampedMode> turned = modes_of(compiled(damped_cantilever(4, planes(2) + ", twist: 45 deg")));
  const std::vector<DampedMode> straight = modes_of(compiled(damped_cantilever(4, planes(2))));
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(turned[k].omega, straight[k].omega, 1e-5 * straight[k].omega);
    EXPECT_NEAR(turned[k].ratio, straight[k].ratio, 1e-5) << "mode " << k + 1;
  }
  EXPECT_NEAR(straight[0].ratio, 0.02, 2e-4);
  EXPECT_NEAR(straight[1].ratio, 0.02, 2e-4) << "of the stiff plane";
}

/// The lowest mode has ζ ω/ω_w, by the whole's frequency ω_w, whatever couples its strains, as far as the whole's modes
/// are those of the segments; those above it have no less than ζ.
TEST_F(Segments, lowest_mode_of_coupled_strains_has_the_damping_of_the_wholes) {
  const std::string shear =
      "bending_y: {stiffness: 1, modes: 3, family: orthogonal-polynomials, rotary_inertia: 1e-3}, shear_y: {stiffness: "
      "8, modes: 3, family: orthogonal-polynomials}";
  for (const std::string& more : {planes(6) + ", twist: [[0, 0], [1, 90 deg]]", shear}) {
    const double whole = modes_of(compiled(damped_cantilever(1, more)))[0].omega;
    const std::vector<DampedMode> modes = modes_of(compiled(damped_cantilever(4, more)));
    EXPECT_NEAR(modes[0].ratio, 0.02 * modes[0].omega / whole, 0.02 * 0.02) << more;
    for (std::size_t k = 1; k < 4; ++k) EXPECT_GT(modes[k].ratio, 0.0199) << more << ", mode " << k + 1;
  }
}

/// A twist that hardly turns couples the planes, and changes next to nothing.
TEST_F(Segments, slight_twist_changes_the_damping_slightly) {
  const std::vector<DampedMode> straight = modes_of(compiled(damped_cantilever(4, planes(2))));
  const std::vector<DampedMode> twisted =
      modes_of(compiled(damped_cantilever(4, planes(2) + ", twist: [[0, 0], [1, 0.02 deg]]")));
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(twisted[k].ratio, straight[k].ratio, 1e-5) << "mode " << k + 1;
}

/// Nor does a twist that turns next to nothing where shear shares in every mode: the first of either plane has the
/// ratio that is asked.
TEST_F(Segments, first_modes_of_both_planes_with_shear_have_the_damping_asked_however_little_couples_them) {
  const std::string shear =
      "bending_y: {stiffness: 1, modes: 3, family: orthogonal-polynomials, rotary_inertia: 1e-3}, shear_y: {stiffness: "
      "30, modes: 3, family: orthogonal-polynomials}, bending_z: {stiffness: 1.6, modes: 3, family: "
      "orthogonal-polynomials, rotary_inertia: 1.5e-3}, shear_z: {stiffness: 50, modes: 3, family: "
      "orthogonal-polynomials}";
  const std::vector<DampedMode> straight = modes_of(compiled(damped_cantilever(4, shear)));
  for (const char* angle : {"0", "1e-9", "1e-4", "0.02"}) {
    const std::vector<DampedMode> twisted =
        modes_of(compiled(damped_cantilever(4, shear + ", twist: [[0, 0], [1, " + angle + "]]")));
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(twisted[k].ratio, 0.02, 2e-4) << angle << ", mode " << k + 1;
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_NEAR(twisted[k].ratio, straight[k].ratio, 0.01 * straight[k].ratio) << angle << ", mode " << k + 1;
  }
}

/// In another strain kinematics the segments have their masses, stiffness and damping still: frequencies and ratios at
/// rest are those of the complete second order.
TEST_F(Segments, vibrate_in_any_strain_kinematics) {
  const std::string space = planes(2) +
                            ", torsion: {stiffness: 0.5, inertia: 0.01, modes: 2, family: "
                            "orthogonal-polynomials}";
  const std::vector<DampedMode> complete = modes_of(compiled(damped_cantilever(2, space)));
  const std::vector<DampedMode> other =
      modes_of(compiled(damped_cantilever(2, space) + "formulation: {kinematics: foreshortening, truncation: none}\n"));
  ASSERT_EQ(other.size(), complete.size());
  for (std::size_t k = 0; k < other.size(); ++k) {
    EXPECT_NEAR(other[k].omega, complete[k].omega, 1e-6 * complete[k].omega) << "mode " << k + 1;
    EXPECT_NEAR(other[k].ratio, complete[k].ratio, 1e-6) << "mode " << k + 1;
  }
}

/// The driven arm with 4 segments of two polynomials a link, `quadratic`: the end of the arm at 10 s against the
/// `exact` rod with six polynomials, (0.72299320, −1.70744217) m at rtol 1e-9 (docs/bodies.md). Demanded: 0.1 mm.
TEST_F(Segments, agree_with_the_exact_rod_on_the_driven_arm) {
  std::vector<std::string> overrides = {"integrator.rtol=1e-7", "integrator.atol=1e-9"};
  for (const char* link : {"bodies.link1.", "bodies.link2."}) {
    overrides.push_back(link + std::string("segments=4"));
    overrides.push_back(link + std::string("bending_y.family=orthogonal-polynomials"));
  }
  Scene scene = read_scene(SCENES "/driven-arm.yaml", registry_, {"", "", overrides});
  const auto equations = scene.formulation->compile(scene.model);
  RunOptions options;
  options.end = end_of_run(scene);
  options.output = scene.output;
  const RunSummary run = simulate(*scene.model, *equations, *scene.integrator, scene.initial, options, {});
  EXPECT_EQ(run.status, RunStatus::completed) << run.message;
  const auto at = scene.model->find_frame("payload.tip");
  const auto end = equations->frame_pose(run.final.y, at->body, at->frame).position;
  EXPECT_LT(std::hypot(end[0] - 0.72299320, end[1] + 1.70744217), 1e-4);
  // The whole's deflection is in the summary, its segments' are not. Of the exact rod: 0.0467 m.
  EXPECT_NEAR(run.peak_deflection.at("link1")[1], 0.0467, 5e-4);
  EXPECT_EQ(run.peak_deflection.count("link1.1"), 0u);
}

TEST_F(Segments, families_that_cannot_be_strained_evenly_are_refused) {
  std::string text = cantilever(4, 2, 0);
  const auto with = [&](const std::string& family) {
    std::string changed = text;
    const std::string from = "orthogonal-polynomials";
    return changed.replace(changed.find(from), from.size(), family);
  };
  EXPECT_THAT(problems(with("clamped-free")),
              HasSubstr("s.yaml:6:113: /bodies/boom/bending_y/family: these 2 modes of a "
                        "segment cannot be strained evenly"));
  EXPECT_THAT(problems(with("craig-bampton")), "");
}

TEST_F(Segments, states_and_frames_are_reported_by_the_beams_name) {
  EXPECT_THAT(problems(tapered + "initial: {bodies: {boom: {modes: [0]}}}\n"),
              HasSubstr("body 'boom' is in segments; name each, 'boom.1' to 'boom.5'"));
  EXPECT_EQ(problems(tapered + "initial: {bodies: {boom.5: {modes: [0.01, 0]}}}\n"), "");
  std::string text = tapered;
  text.replace(text.find("at: 1.3"), 7, "at: 2.3");
  EXPECT_THAT(problems(text),
              HasSubstr("/bodies/boom/frames/camera/at: no station 2.3; need root, tip, or a coordinate"));
}

}  // namespace
}  // namespace withy::test
