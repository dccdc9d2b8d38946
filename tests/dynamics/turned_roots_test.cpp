/// \file
/// Exact kinematics of beams whose modes turn or move the root: beside beams of the same strains that are clamped at
/// it, and by what is conserved.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "random_case.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

/// Functions less the motion of the root: φ − φ(0) − x φ′(0), of twists φ − φ(0). Strains are the same.
class SeenFromRoot final : public ShapeFunctions {
 public:
  SeenFromRoot(std::unique_ptr<ShapeFunctions> functions, bool bending)
      : functions_(std::move(functions)), bending_(bending), at_(count()), slope_(count()) {
    std::vector<double> curvature(count());
    functions_->evaluate(0, at_, slope_, curvature);
  }
  std::size_t count() const override { return functions_->count(); }
  double wave_number() const override { return functions_->wave_number(); }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    functions_->evaluate(x, phi, slope, curvature);
    for (std::size_t i = 0; i < count(); ++i) {
      phi[i] -= at_[i] + (bending_ ? x * slope_[i] : 0);
      if (bending_) slope[i] -= slope_[i];
    }
  }

 private:
  std::unique_ptr<ShapeFunctions> functions_;
  bool bending_;
  std::vector<double> at_, slope_;
};

class FamilySeenFromRoot final : public ModeFamily {
 public:
  explicit FamilySeenFromRoot(const std::string& family) {
    enroll_static_plugins(registry_);
    family_ = make_plugin<ModeFamily>(registry_, family);
  }
  std::size_t most() const override { return family_->most(); }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    return std::make_unique<SeenFromRoot>(family_->functions(beam, count), beam.strain == BeamData::Strain::bending);
  }

 private:
  Registry registry_;
  std::unique_ptr<ModeFamily> family_;
};

constexpr std::array turning_families = {"pinned-pinned", "pinned-free", "free-free"};

template <std::size_t k>
void enroll_seen_from_root(Enrollment& enrollment) {
  enrollment.add<ModeFamily>({.id = std::string("seen-") + turning_families[k],
                              .summary = "Less the motion of the root",
                              .parameters = {},
                              .make = [](const Value&, const MakeContext&) -> std::unique_ptr<ModeFamily> {
                                return std::make_unique<FamilySeenFromRoot>(turning_families[k]);
                              }});
}

/// A craft with two such beams one after the other and a body at the end of them.
std::string craft(const std::string& prefix, const std::string& family, bool planar, const std::string& first) {
  const std::string bending = "modes: 2, family: " + prefix + family;
  const std::string space = planar ? ""
                                   : ", bending_z: {stiffness: 30, " + bending +
                                         "}, torsion: {stiffness: 20, inertia: 0.004, modes: 2, family: " + prefix +
                                         "free-free}";
  const std::string beam =
      "{type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 40, rotary_inertia: 0.002, " + bending +
      "}" + space + "}";
  return "format: withy/1\ntime: {end: 1}\nbodies:\n"
         "  hub: {type: rigid, mass: 2, inertia: [0.2, 0.3, 0.4, 0, 0, 0], frames: {out: {position: [0.1, 0.2, 0]}}}\n"
         "  inner: " +
         beam + "\n  outer: " + beam +
         "\n  bob: {type: rigid, mass: 0.3, inertia: [0.01, 0.02, 0.02, 0, 0, 0], center_of_mass: [0.05, 0.01, 0]}\n"
         "hinges:\n  base: {type: " +
         first +
         ", parent: world, child: hub}\n"
         "  root: {type: " +
         (planar ? "revolute, axis: [0, 0, 1]" : "spherical") +
         ", parent: hub.out, child: inner}\n"
         "  elbow: {type: revolute, axis: [0, " +
         (planar ? "0, 1" : "0.6, 0.8") +
         "], parent: inner.tip, child: outer}\n"
         "  grip: {type: weld, parent: outer.tip, child: bob}\n";
}

struct Craft {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  State state;

  Craft(const std::string& text, const std::string& formulation) {
    enroll_static_plugins(registry);
    Enrollment enrollment;
    enroll_seen_from_root<0>(enrollment);
    enroll_seen_from_root<1>(enrollment);
    enroll_seen_from_root<2>(enrollment);
    registry.admit(std::move(enrollment), "this test");
    scene = parse_scene(text, "text", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    RandomScene random(7, {});
    state = random.state(*scene.model, scene.initial);
    for (const Slot& b : scene.model->layout().bodies)
      for (std::size_t i = 0; i < b.positions; ++i) state.y[b.position + i] *= 4;
  }
  [[nodiscard]] std::vector<double> derivatives() const {
    std::vector<double> y_dot(equations->size());
    Work work = equations->make_work();
    EXPECT_TRUE(equations->derivatives(0, state.y, y_dot, work).ok());
    return y_dot;
  }
};

/// Over the greatest of b.
double largest_difference(std::span<const double> a, std::span<const double> b) {
  double most = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return most / size;
}

/// A hinge holds the root's section. Whatever the modes move the frame by that the body is written in, the sections
/// beyond follow from the strains: mass matrix, forces and accelerations are those of the beam that is clamped at its
/// root. 1e-8: what is interpolated along the rod differs. The expansions of second order are good for less, as they
/// are about different frames.
TEST(TurnedRoots, move_as_clamped_ones_of_the_same_strains) {
  for (const std::string family : turning_families) {
    for (const bool planar : {true, false}) {
      const std::string first = planar ? "prismatic, axis: [1, 0, 0]" : "free";
      const auto made = [&](const std::string& prefix, const std::string& formulation) {
        return Craft(craft(prefix, family, planar, first), formulation);
      };
      const Craft turning = made("", "exact"), clamped = made("seen-", "exact");
      const DenseSystem a = turning.equations->system(0, turning.state.y),
                        b = clamped.equations->system(0, turning.state.y);
      const std::string what = family + (planar ? " in a plane" : " in space");
      EXPECT_LT(largest_difference(a.mass, b.mass), 1e-8) << what;
      EXPECT_LT(largest_difference(a.force, b.force), 1e-8) << what;
      EXPECT_LT(largest_difference(turning.derivatives(), clamped.derivatives()), 1e-8) << what;
      EXPECT_GT(largest_difference(made("", "quadratic").derivatives(), made("seen-", "quadratic").derivatives()), 1e-4)
          << what;
    }
  }
}

/// Without gravity and damping, over a second in which beams bend by some tenths of their length.
TEST(TurnedRoots, conserve_energy_and_momenta_of_a_tree_in_space) {
  for (const std::string family : turning_families) {
    const Craft c(craft("", family, false, "free") + "integrator: {name: dop853, rtol: 1e-12, atol: 1e-12}\n", "exact");
    RunOptions options;
    options.end = 1;
    options.output = 0.1;
    const RunSummary run =
        simulate(*c.scene.model, *c.equations, *c.scene.integrator, c.state, options, [](const State&) {});
    ASSERT_EQ(run.status, RunStatus::completed) << run.message;
    const Energies before = c.equations->energies(c.state.y), after = c.equations->energies(run.final.y);
    const double energy = before.kinetic + before.potential;
    EXPECT_NEAR(after.kinetic + after.potential, energy, 1e-9 * energy) << family;
    EXPECT_LT(largest_difference(after.linear_momentum, before.linear_momentum), 1e-9) << family;
    EXPECT_LT(largest_difference(after.angular_momentum, before.angular_momentum), 1e-9) << family;
  }
}

}  // namespace
}  // namespace withy::test
