/// \file
/// The sweeps against the dense reference and against physics, on seeded random trees.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "random_case.hpp"
#include "withy/core/tree/tree.hpp"
#include "withy/core/tree/twins.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

class RandomTrees : public testing::TestWithParam<std::string> {
 protected:
  /// In space the sweep and the reference turn the sections of a rod by different methods, which differ by less than
  /// 1e-8 here.
  static double tolerance() { return GetParam() == "exact" ? 1e-8 : 1e-11; }
};

/// The backward error |M a − f − τ| against the size of the terms in each row: independent of κ(M), since elimination
/// in either order is backward stable. 1e-11 leaves room for trees of eight bodies.
void expect_solves(const Case& c, const std::string& what, double tolerance = 1e-11) {
  const DenseSystem s = c.equations->system(0, c.state.y);
  const std::vector<double> y_dot = c.derivatives(c.state);
  const double* a = y_dot.data() + c.equations->layout().positions;
  for (std::size_t i = 0; i < s.size; ++i) {
    double residual = -s.force[i] - s.applied[i];
    double scale = std::abs(s.force[i]) + 1e-12;
    for (std::size_t j = 0; j < s.size; ++j) {
      residual += s.mass[i * s.size + j] * a[j];
      scale += std::abs(s.mass[i * s.size + j] * a[j]);
    }
    EXPECT_LT(std::abs(residual), tolerance * scale) << what << ", row " << c.equations->layout().speed_names[i];
  }
}

TEST_P(RandomTrees, sweep_solves_the_dense_equations_in_space) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const Case c(seed, {.bodies = 2 + static_cast<int>(seed % 7)}, GetParam());
    expect_solves(c, "seed " + std::to_string(seed), tolerance());
  }
}

TEST_P(RandomTrees, sweep_solves_the_dense_equations_in_a_plane) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const Case c(seed, {.bodies = 2 + static_cast<int>(seed % 7), .planar = true}, GetParam());
    if (c.scene.model->layout().speeds == 0) continue;
    expect_solves(c, "seed " + std::to_string(seed));
  }
}

TEST_P(RandomTrees, sweep_solves_the_dense_equations_where_beams_are_held_at_their_tip) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5), .planar = seed % 2 == 0, .any_root = true};
    expect_solves(Case(seed, wish, GetParam()), "seed " + std::to_string(seed), tolerance());
  }
}

/// Families without clamped root too: hinges hold their moving root section, and frames at the root move with it.
TEST_P(RandomTrees, sweep_solves_the_dense_equations_in_every_mode_family) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 2 == 0,
                         .any_family = true};
    const Case c(seed, wish, GetParam());
    if (c.scene.model->layout().speeds == 0) continue;
    expect_solves(c, "seed " + std::to_string(seed), tolerance());
  }
}

/// Of beams that vary strains have kinks, at which `exact` cuts the turns of a rod: these are 6e-11 off here, and
/// 4e-10 where the sweeps leave the cuts out.
TEST_P(RandomTrees, sweep_solves_the_dense_equations_where_beams_vary) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5), .planar = seed % 3 == 0, .varying = true};
    const Case c(seed, wish, GetParam());
    if (c.scene.model->layout().speeds == 0) continue;
    expect_solves(c, "seed " + std::to_string(seed), GetParam() == "exact" ? 2e-10 : 1e-11);
  }
}

/// Extension, shear and rotary inertia, of which rods of `exact` have what turns and stretches with their sections.
TEST_P(RandomTrees, sweep_solves_the_dense_equations_where_beams_stretch_and_shear) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 4 == 0,
                         .rotary = seed % 2 == 0,
                         .stretching = true};
    const Case c(seed, wish, GetParam());
    if (c.scene.model->layout().speeds > 0) expect_solves(c, "seed " + std::to_string(seed), tolerance());
  }
}

/// Products of modes are summed in tiles, of which what is left over has a size of its own: in these formulations.
TEST(MassProducts, of_any_number_of_modes_are_those_of_the_dense_equations) {
  const std::pair<const char*, bool> kinds[] = {
      {"linear", false}, {"quadratic", false}, {"quadratic", true}, {"exact", false}, {"exact", true}};
  for (const auto& [formulation, rotary] : kinds) {
    for (int modes = 1; modes <= 13; ++modes) {
      for (const bool planar : {true, false}) {
        const SceneWish wish{
            .bodies = 4, .planar = planar, .modes = modes, .aligned = modes % 2 == 0, .rotary = rotary};
        // As in RandomTrees.
        const double tolerance = !planar && formulation == std::string("exact") ? 1e-8 : 1e-11;
        expect_solves(Case(static_cast<unsigned>(modes), wish, formulation), std::to_string(modes) + " modes",
                      tolerance);
      }
    }
  }
}

/// Of so many modes the products span few dimensions for their number, and their basis is found in another way.
TEST(MassProducts, of_very_many_modes_are_those_of_the_dense_equations) {
  const SceneWish wish{.bodies = 2, .planar = true, .modes = 40};
  expect_solves(Case(3, wish, "quadratic"), "40 modes");
}

/// Inverse dynamics undoes forward dynamics' equations: M u̇ − f and M a against the assembled M, f.
TEST_P(RandomTrees, inverse_dynamics_and_mass_products_are_those_of_the_dense_equations) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 6), .planar = seed % 3 == 0, .any_root = seed % 2 == 0};
    const Case c(seed, wish, GetParam());
    const DenseSystem s = c.equations->system(0, c.state.y);
    std::vector<double> a(s.size), efforts(s.size), product(s.size);
    for (std::size_t i = 0; i < s.size; ++i) a[i] = std::sin(1.0 + 3.0 * static_cast<double>(i + seed));
    Work work = c.equations->make_work();
    work.poison();
    c.equations->inverse_dynamics(c.state.y, a, efforts, work);
    c.equations->mass_times(c.state.y, a, product, work);
    for (std::size_t i = 0; i < s.size; ++i) {
      double expected = 0, scale = std::abs(s.force[i]) + 1e-12;
      for (std::size_t j = 0; j < s.size; ++j) {
        expected += s.mass[i * s.size + j] * a[j];
        scale += std::abs(s.mass[i * s.size + j] * a[j]);
      }
      EXPECT_NEAR(product[i], expected, tolerance() * scale) << "seed " << seed << ", row " << i;
      EXPECT_NEAR(efforts[i], expected - s.force[i], tolerance() * scale) << "seed " << seed << ", row " << i;
    }
  }
}

TEST_P(RandomTrees, evaluation_neither_allocates_nor_depends_on_its_work_memory) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Case c(seed, {.bodies = 6, .planar = seed % 2 == 0, .any_root = true, .any_family = seed > 2}, GetParam());
    std::vector<double> first(c.equations->size()), second(c.equations->size());
    Work work = c.equations->make_work();
    c.equations->derivatives(0, c.state.y, first, work);
    work.poison();
    const std::size_t before = allocations();
    c.equations->derivatives(0, c.state.y, second, work);
    EXPECT_EQ(allocations() - before, 0U);
    EXPECT_EQ(first, second);
  }
}

/// Deflections of a few tenths of the length and more, turns of sections to 3 rad. In a plane the two agree to
/// rounding. In space the sweep goes from node to node with an error of the seventh power of the turn, here to 0.5 rad;
/// the reference does not.
/// So that the run without AVX2 (see CMakeLists.txt) is one.
TEST(InstructionSet, is_the_processors_unless_it_is_denied) {
  const char* tunables = std::getenv("GLIBC_TUNABLES");
  const bool denied = tunables != nullptr && std::string(tunables).find("-AVX2") != std::string::npos;
  bool taken = false;
  for (const std::string& line : Case(1, {}, "quadratic").equations->savings())
    taken = taken || line.find("x86-64-v3") != std::string::npos;
  EXPECT_EQ(taken, !denied && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"));
}

/// A body without mass or inertia at the end of a chain: its hinge has nothing to accelerate. With one part in 1e12 of
/// its neighbour's it has.
TEST(Singular, pivots_name_the_body_that_has_nothing_to_accelerate) {
  for (const bool planar : {true, false}) {
    for (const std::string& formulation : formulations) {
      for (const double mass : {0.0, 1e-12}) {
        const std::string scene =
            "{format: withy/1, time: {end: 1}, bodies: {arm: {type: rigid, mass: 1, inertia: "
            "[0.1, 0.1, 0.1, 0, 0, 0]}, bob: {type: rigid, mass: " +
            std::to_string(mass * 1e12) +
            "e-12, center_of_mass: [0.3, 0, 0]}}, hinges: " + "{pivot: {type: revolute, axis: [" +
            (planar ? "0, 0, 1" : "0, 0.6, 0.8") +
            "], parent: world, child: arm}, joint: {type: revolute, axis: [0, 0, 1], " + "parent: arm, child: bob}}}";
        const Case c(scene, formulation);
        std::vector<double> y_dot(c.equations->size());
        Work work = c.equations->make_work();
        const Evaluation e = c.equations->derivatives(0, c.state.y, y_dot, work);
        EXPECT_EQ(e.ok(), mass > 0) << formulation << ' ' << mass;
        if (mass > 0) continue;
        EXPECT_EQ(e.outcome, Evaluation::Outcome::singular);
        EXPECT_EQ(e.body, c.scene.model->body("bob")) << formulation;
      }
    }
  }
}

#ifdef __SSE2__
/// Denormal numbers count as zero within an evaluation; the host's rounding, traps and flags are none of ours.
TEST_P(RandomTrees, evaluation_leaves_the_floating_point_state_as_it_was) {
  Case c(3, {.bodies = 4}, GetParam());
  std::vector<double> y_dot(c.equations->size());
  Work work = c.equations->make_work();
  const unsigned before = _mm_getcsr();
  for (const unsigned state : {before & ~0x3fU, before | 0x8040U, (before & ~0x6000U) | 0x2000U}) {
    _mm_setcsr(state);
    c.equations->derivatives(0, c.state.y, y_dot, work);
    const unsigned after = _mm_getcsr();
    _mm_setcsr(before);
    EXPECT_EQ(after, state);
  }
}
#endif

TEST(Exact, sweep_solves_the_dense_equations_at_large_deflections) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const bool planar = seed % 2 == 0;
    Case c(seed, {.bodies = 4, .planar = planar, .any_root = true, .any_family = seed > 6}, "exact");
    if (c.scene.model->layout().speeds == 0) continue;
    for (const Slot& b : c.scene.model->layout().bodies) {
      for (std::size_t i = 0; i < b.positions; ++i) c.state.y[b.position + i] *= 8;
    }
    expect_solves(c, "seed " + std::to_string(seed), planar ? 1e-11 : 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, RandomTrees, testing::ValuesIn(formulations));

/// Sections of a table make panels of unequal length. Without deflection the mass matrix is that of the second-order
/// kinematics, whose quadrature is another one; at large deflection the sweep solves the dense equations, in which the
/// interpolation of a panel leaves up to 1e-7 between the two ways of integrating in space (see rod_table.hpp).
TEST(ExactWithTables, a_tapered_beam_has_its_mass_and_is_swept_as_the_dense_equations_say) {
  for (const bool planar : {true, false}) {
    const std::string more = planar
                                 ? ""
                                 : ", bending_z: {stiffness: [[0, 25], [1.1, 8]], modes: 2}, torsion: {stiffness: 30, "
                                   "modes: 1, inertia: [[0, 0.004], [0.7, 0.001], [1.1, 0.001]]}";
    const std::string text = R"(format: withy/1
time: {end: 1}
gravity: [0, -9.81, 0]
bodies:
  boom:
    {type: beam, length: 1.1, mass_per_length: [[0, 1.4], [0.3, 0.5], [1.1, 0.2]],
     bending_y: {stiffness: [[0, 40], [0.3, 20], [1.1, 9]], modes: 3})" +
                             more + R"(}
  bob: {type: rigid, mass: 0.4, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}
  tip: {type: weld, parent: boom.tip, child: bob}
)";
    Case exact(text, "exact");
    const Case quadratic(text, "quadratic");
    const std::vector<double> a = exact.equations->system(0, exact.state.y).mass,
                              b = quadratic.equations->system(0, quadratic.state.y).mass;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12 * b[0]);
    const Layout& layout = exact.equations->layout();
    const Slot& boom = *layout.body("boom");
    for (std::size_t i = 0; i < boom.positions; ++i) {
      exact.state.y[boom.position + i] = 0.15 / static_cast<double>(1 + i);
      exact.state.y[layout.positions + boom.speed + i] = 0.4 - 0.1 * static_cast<double>(i);
    }
    exact.state.y[layout.positions] = 1.5;
    expect_solves(exact, planar ? "plane" : "space", planar ? 1e-11 : 1e-6);
  }
}

/// A planar hinge is no motion the sweeps inline, so a tree that has one is swept in space, though all it does is in a
/// plane; with its three rates as two slides and a revolute it is recognised.
TEST_P(RandomTrees, a_planar_hinge_keeps_a_tree_in_space_and_right) {
  for (const bool merged : {true, false}) {
    std::string text = R"(format: withy/1
time: {end: 1}
gravity: [0, -9.81, 0]
bodies:
  cart: {type: rigid, mass: 3, inertia: [0.1, 0.2, 0.3, 0, 0, 0], frames: {a: {position: [0.2, 0.1, 0]}}}
  boom: {type: beam, length: 1.1, mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 2}}
)";
    text += merged ? R"(hinges:
  float: {type: planar, parent: world, child: cart}
)"
                   : R"(  x: {type: rigid, mass: 0}
  y: {type: rigid, mass: 0}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: x}
  y: {type: prismatic, axis: [0, 1, 0], parent: x, child: y}
  float: {type: revolute, axis: [0, 0, 1], parent: y, child: cart}
)";
    text += "  elbow: {type: revolute, axis: [0, 0, 1], parent: cart.a, child: boom}\n";
    Case c(text, GetParam());
    EXPECT_NE(compile_tree(*c.scene.model).planar, merged);
    // Rates of the planar hinge are angle first; those of the chain of three hinges last.
    const Layout& layout = c.equations->layout();
    const std::vector<double> x = merged ? std::vector{0.4, 0.3, -0.2} : std::vector{0.3, -0.2, 0.4};
    const std::vector<double> u = merged ? std::vector{0.7, 1.0, 0.5} : std::vector{1.0, 0.5, 0.7};
    std::copy(x.begin(), x.end(), c.state.y.begin());
    std::copy(u.begin(), u.end(), c.state.y.begin() + static_cast<std::ptrdiff_t>(layout.positions));
    const Slot& elbow = *layout.hinge("elbow");
    const Slot& boom = *layout.body("boom");
    c.state.y[elbow.position] = -0.8, c.state.y[layout.positions + elbow.speed] = 2.0;
    c.state.y[boom.position] = 0.02, c.state.y[layout.positions + boom.speed + 1] = 0.1;
    expect_solves(c, merged ? "planar hinge" : "three hinges");
  }
}

/// Energy: ½ (J + m h²) ω² = m g h θ, so ω̇ = −m g h / (J + m h²) with z up and h > 0.
TEST(ScrewTree, a_heavy_nut_turns_as_its_pitch_says) {
  const Case c(R"(format: withy/1
time: {end: 1}
gravity: [0, 0, -9.81]
bodies: {nut: {type: rigid, mass: 5, inertia: [0.02, 0.02, 0.03, 0, 0, 0]}}
hinges: {spindle: {type: screw, axis: [0, 0, 1], pitch: "200 mm/rev", parent: world, child: nut}}
)",
               "quadratic");
  const double h = 0.1 / std::numbers::pi;
  EXPECT_NEAR(c.derivatives(c.state)[1], -5 * 9.81 * h / (0.03 + 5 * h * h), 1e-12);
}

/// A body that is equal to another and yet not the same: nothing is shared with it.
class EqualBody final : public Body {
 public:
  explicit EqualBody(std::shared_ptr<const Body> body) : body_(std::move(body)), shape_(body_->shape()) {}
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override { return body_->station(name); }
  std::string stations() const override { return body_->stations(); }
  const Rod* rod() const override { return body_->rod(); }
  std::shared_ptr<const Body> expanded(const StrainKinematics& kinematics) const override {
    const auto other = body_->expanded(kinematics);
    return other == nullptr ? nullptr : std::make_shared<const EqualBody>(other);
  }

 private:
  std::shared_ptr<const Body> body_;
  ModalShape shape_;
};

/// Six equal links about two axes in turn: from the third on each has what an earlier one has. The last carries a tool,
/// so that its stations are others.
TEST_P(RandomTrees, what_equal_links_share_changes_no_bit) {
  for (const bool planar : {true, false}) {
    std::string text = "format: withy/1\ntime: {end: 1}\ngravity: [0.3, -9.81, 0]\nbodies:\n";
    std::string hinges = "hinges:\n";
    const std::string across =
        planar ? "" : ", bending_z: {stiffness: 90, modes: 2}, torsion: {stiffness: 20, modes: 1, inertia: 0.01}";
    for (int i = 0; i < 6; ++i) {
      const std::string n = std::to_string(i);
      text += "  b" + n + ": {type: beam, length: 0.7, mass_per_length: 0.9, bending_y: {stiffness: 60, modes: 2}" +
              across + "}\n";
      hinges += "  h" + n + ": {type: revolute, axis: " + (planar || i % 2 == 0 ? "[0, 0, 1]" : "[0, 1, 0]") +
                ", parent: " + (i == 0 ? "world" : "b" + std::to_string(i - 1) + ".tip") + ", child: b" + n + "}\n";
    }
    text += "  tool: {type: rigid, mass: 0.4, inertia: [0.01, 0.02, 0.03, 0, 0, 0]}\n";
    hinges += "  grip: {type: weld, parent: b5.tip, child: tool}\n";
    Case c(text + hinges, GetParam());
    const Model& model = *c.scene.model;
    Twins twins;
    std::size_t found = 0;
    for (const NodeSpec& node : compile_tree(model).nodes)
      found += twins.of(node, StrainOrder::quadratic, Truncation::none).has_value() ? 1 : 0;
    EXPECT_EQ(found, planar ? 5U : 4U);

    std::vector<BodyNode> bodies = model.bodies();
    for (BodyNode& b : bodies) b.body = std::make_shared<EqualBody>(b.body);
    const auto apart =
        c.scene.formulation->compile(std::make_shared<const Model>(std::move(bodies), model.hinges(), model.gravity()));
    for (std::size_t i = 0; i + 1 < c.state.y.size(); ++i)
      c.state.y[i] = 0.03 * std::sin(1.0 + 7.0 * static_cast<double>(i));
    std::vector<double> y_dot(apart->size());
    Work work = apart->make_work();
    ASSERT_TRUE(apart->derivatives(0, c.state.y, y_dot, work).ok());
    EXPECT_EQ(c.derivatives(c.state), y_dot) << (planar ? "in a plane" : "in space");
  }
}

class Untruncated : public testing::TestWithParam<std::string> {};

/// dE/dt along the motion equals the power of damping: E is differentiated numerically (fourth order, h = 1e-4, so that
/// the difference formula leaves about 1e-9 of the terms) along y + h ẏ, a direction in which dE = ∇E·ẏ exactly.
TEST_P(Untruncated, power_of_the_motion_is_the_rate_of_energy) {
  for (unsigned seed = 1; seed <= 24; ++seed) {
    const Case c(seed, {.bodies = 5, .planar = seed % 3 == 0, .any_root = true, .any_family = seed > 12}, GetParam());
    const std::vector<double> y_dot = c.derivatives(c.state);
    double size = 1;
    const auto energy = [&](double h) {
      State s = c.state;
      for (std::size_t i = 0; i < s.y.size(); ++i) s.y[i] += h * y_dot[i];
      const Energies e = c.equations->energies(s.y);
      size = std::max(size, std::abs(e.kinetic) + std::abs(e.potential));
      return e.kinetic + e.potential;
    };
    double rate = 0;
    for (const double y : y_dot) rate = std::max(rate, std::abs(y));
    const double h = 1e-3 / std::max(1.0, rate);
    const double numeric = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
    const double power = y_dot.back();
    EXPECT_NEAR(numeric, power, 1e-8 * size / h * 1e-3 + 1e-7 * std::abs(power)) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, Untruncated, testing::Values("quadratic", "linear", "exact"));

}  // namespace
}  // namespace withy::test
