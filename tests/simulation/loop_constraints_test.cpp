/// \file
/// Constraints that close loops: they move and bear as the hinges they are, their forces do no work, and what a scene
/// has wrong about them is told.
#include <gmock/gmock.h>

#include <ostream>

#include "four_bar.hpp"
#include "withy/core/simulation/changing_equations.hpp"
#include "withy/core/simulation/end_notes.hpp"

namespace withy::test {
namespace {

using Row = std::vector<double>;

/// Two bodies: one on a revolute hinge and flexible, the other on its tip by the hinge under test. `cut`: the second
/// body floats freely, and a constraint is that hinge.
std::string joined(const std::string& hinge, const std::string& position, const std::string& rate, bool cut) {
  const std::string first = R"(format: withy/1
gravity: [0.3, -9.81, 0.5]
time: {end: 1}
integrator: {name: dop853, rtol: 1e-12, atol: 1e-12}
bodies:
  arm: {type: beam, length: 0.9, mass_per_length: 1.3, bending_y: {stiffness: 60, modes: 2, family: clamped-free}, bending_z: {stiffness: 90, modes: 1, family: clamped-free}}
  load: {type: rigid, mass: 0.8, center_of_mass: [0.1, -0.2, 0.15], inertia: [0.02, 0.03, 0.025, 0.001, 0, 0], frames: {grip: {position: [0.05, 0.02, 0], orientation: {axis: [1, 2, 0], angle: 0.3}}}}
hinges:
  shoulder: {type: revolute, axis: [0, 0.2, 1], parent: world, child: arm}
)";
  const std::string offset = "offset: {position: [0.02, 0, 0.01], orientation: {axis: [0, 1, 1], angle: 0.4}}";
  const std::string outputs = R"(
outputs:
  place: {type: frame, of: load, in: world}
  base: {type: reaction, hinge: shoulder}
  middle: {type: section, of: arm, at: 0.5}
)";
  if (!cut)
    return first + "  wrist: {" + hinge + ", parent: arm.tip, child: load.grip, " + offset + "}\n" +
           "initial: {hinges: {shoulder: {rate: [2]}" +
           (position.empty() ? "" : ", wrist: {position: " + position + ", rate: " + rate + "}") + "}}" + outputs +
           "  wrist_load: {type: reaction, hinge: wrist}\n";
  return first + "  wrist: {type: free, parent: world, child: load}\n" + "constraints:\n  grip: {" +
         replaced(hinge, "type: ", "type: hinge, hinge: ") + ", a: arm.tip, b: load.grip, " + offset + "}\n" + outputs +
         "  wrist_load: {type: reaction, constraint: grip}\n";
}

struct Joint {
  const char* hinge;
  const char* position;
  const char* rate;
  std::size_t freedoms;
};
void PrintTo(const Joint& joint, std::ostream* out) { *out << joint.hinge; }

class Joints : public testing::TestWithParam<Joint> {};

// The state of the cut one is that of the tree: pose and twist of the free body, read by its sensor.
TEST_P(Joints, AConstraintMovesAndBearsAsTheHingeInATree) {
  const Joint& joint = GetParam();
  const Made tree(joined(joint.hinge, joint.position, joint.rate, false));
  Made cut(joined(joint.hinge, joint.position, joint.rate, true));
  const Layout &layout = tree.scene.model->layout(), &there = cut.scene.model->layout();
  const State& from = tree.scene.initial;
  State& to = cut.scene.initial;
  const auto copy = [&](const Slot& a, const Slot& b) {
    std::copy_n(&from.y[a.position], a.positions, &to.y[b.position]);
    std::copy_n(&from.y[layout.positions + a.speed], a.speeds, &to.y[there.positions + b.speed]);
  };
  copy(*layout.hinge("shoulder"), *there.hinge("shoulder"));
  copy(*layout.body("arm"), *there.body("arm"));
  const auto seen = tree.equations->make_observation();
  seen->observe(from.y);
  const int load = tree.scene.model->body("load");
  const WorldPose pose = seen->frame_pose(load, 0);
  const WorldVelocity velocity = seen->frame_velocity(load, 0);
  const Slot& free = *there.hinge("wrist");
  const Eigen::Quaterniond q(
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()).eval());
  const Row values = {q.w(), q.x(), q.y(), q.z(), pose.position[0], pose.position[1], pose.position[2]};
  std::copy(values.begin(), values.end(), &to.y[free.position]);
  std::copy(velocity.angular.begin(), velocity.angular.end(), &to.y[there.positions + free.speed]);
  std::copy(velocity.linear.begin(), velocity.linear.end(), &to.y[there.positions + free.speed + 3]);

  Work work = cut.equations->make_work();
  const ClosedLoops& loops = loops_of(*cut.equations);
  Row closed = to.y;
  EXPECT_LT(loops.close(closed, work).gap, 1e-14);
  const std::vector<LoopCount> counts = loops.counts(to.y, work);
  ASSERT_EQ(counts.size(), 1U);
  EXPECT_EQ(counts[0].equations, 6 - joint.freedoms);
  EXPECT_EQ(counts[0].independent, 6 - joint.freedoms);
  const RunSummary a = run(tree, 1.0), b = run(cut, 1.0);
  EXPECT_EQ(b.status, RunStatus::completed) << b.message;
  const Row of_tree = read_sensors(tree, a.final), of_cut = read_sensors(cut, b.final);
  ASSERT_EQ(of_tree.size(), of_cut.size());
  // Place and velocity, then accelerations, forces and moments.
  for (std::size_t i = 0; i < of_tree.size(); ++i)
    EXPECT_NEAR(of_cut[i], of_tree[i], i < 6 ? 2e-9 : 2e-8 * (1 + std::abs(of_tree[i]))) << i;
}

INSTANTIATE_TEST_SUITE_P(
    ClosedLoops, Joints,
    testing::Values(Joint{"type: weld", "", "", 0}, Joint{"type: revolute, axis: [1, 0.5, 0.2]", "[0.4]", "[3]", 1},
                    Joint{"type: prismatic, axis: [1, 0.5, 0.2]", "[0.1]", "[0.3]", 1},
                    Joint{"type: universal, first_axis: [1, 0, 0.2], second_axis: [0, 1, 0]", "[0.3, -0.5]", "[2, 1]",
                          2},
                    Joint{"type: cylindrical, axis: [0, 1, 0.2]", "[0.3, 0.05]", "[2, 0.4]", 2},
                    Joint{"type: planar, normal: [0, 0.1, 1]", "[0.3, 0.05, 0.02]", "[2, 0.1, -0.3]", 3},
                    Joint{"type: spherical", "{axis: [1, 1, 0], angle: 0.5}", "[1, 2, -1]", 3}));

TEST(ClosedLoops, RowsAreTheDerivativesOfGapsAndTheirForcesDoNoWork) {
  const Made made(joined("type: revolute, axis: [1, 0.5, 0.2]", "", "", true));
  const ClosedLoops& loops = loops_of(*made.equations);
  const Layout& layout = made.scene.model->layout();
  const std::size_t m = loops.closing_equations(), n = layout.speeds;
  Work work = made.equations->make_work();
  State state = made.scene.initial;
  for (std::size_t i = 0; i < layout.positions + n; ++i)
    state.y[i] += 0.2 * std::sin(1.0 + 3.0 * static_cast<double>(i));
  made.equations->normalize(state.y);
  Row g(m), rates(m), J(m * n), slopes(made.equations->size());
  loops.see(state.y, g, rates, J, work);
  made.equations->position_rates(0, state.y, slopes, work);
  Row product(m, 0.0);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < n; ++k) product[i] += J[i * n + k] * state.y[layout.positions + k];
  const auto gaps_at = [&](double h) {
    State moved = state;
    for (std::size_t i = 0; i < layout.positions; ++i) moved.y[i] += h * slopes[i];
    made.equations->normalize(moved.y);
    Row gaps(m), unused(m), rows(m * n);
    loops.see(moved.y, gaps, unused, rows, work);
    return gaps;
  };
  const Row ahead = gaps_at(1e-5), behind = gaps_at(-1e-5);
  for (std::size_t i = 0; i < m; ++i) {
    EXPECT_NEAR(product[i], rates[i], 1e-14 * (1 + std::abs(rates[i])));  // Jᵀ is the transpose of u → ġ
    EXPECT_NEAR((ahead[i] - behind[i]) / 2e-5, rates[i], 1e-8);
  }
}

TEST(ClosedLoops, DependentEquationsAreCountedAndLeaveTheMotionAsItIs) {
  const std::string planar = four_bar(rigid_coupler, "{name: dopri5, rtol: 1e-10, atol: 1e-11}");
  const Made once(planar);
  // The same loop twice, by another hinge.
  const Made twice(replaced(
      planar,
      "loads:", "  again: {type: hinge, hinge: cylindrical, axis: [0, 0, 1], a: coupler.tip, b: rocker.pin}\nloads:"));
  Work work = twice.equations->make_work();
  const auto counts = loops_of(*twice.equations).counts(twice.scene.initial.y, work);
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].equations, 5U);
  EXPECT_EQ(counts[0].independent, 2U);
  EXPECT_EQ(counts[1].equations, 4U);
  EXPECT_EQ(counts[1].independent, 0U);
  const RunSummary a = run(once, 0.5), b = run(twice, 0.5);
  for (std::size_t i = 0; i + 1 < a.final.y.size(); ++i) EXPECT_NEAR(a.final.y[i], b.final.y[i], 1e-10);
}

/// What a user is told of a scene; empty where it is good.
std::string message(const std::string& scene, const std::string& formulation = "") {
  try {
    const Made unused(scene, formulation);
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

TEST(ClosedLoops, InitialValuesStayOrAreRefusedWithTheDistance) {
  const std::string text = four_bar(rigid_coupler, "dopri5");
  const Made made(text);
  const Layout& layout = made.scene.model->layout();
  EXPECT_EQ(made.scene.initial.y[layout.hinge("motor")->position], M_PI / 2);
  EXPECT_EQ(made.scene.initial.y[layout.positions + layout.hinge("motor")->speed], 6);
  EXPECT_NEAR(made.scene.initial.y[layout.hinge("pivot")->position], Linkage::place(M_PI / 2).rocker, 1e-14);
  EXPECT_THAT(message(replaced(text, "hinges: {motor: {position: [\"90 deg\"], rate: [6]}}",
                               "hinges: {motor: {position: [1]}, elbow: {position: [0]}, pivot: {position: [0]}}")),
              testing::AllOf(testing::HasSubstr("/constraints/loop: the loop cannot be closed"),
                             testing::HasSubstr("its frames are 1.48 m apart there")));
  EXPECT_THAT(message(replaced(text, "rate: [6]}", "rate: [6]}, pivot: {rate: [6]}")),
              testing::HasSubstr("the initial speeds part its frames at"));
}

TEST(ClosedLoops, ALinkWithoutMassIsNamedWhereItKeepsThemOpen) {
  const std::string massless =
      replaced(four_bar(rigid_coupler, "dopri5"), "mass: 2.0, center_of_mass: [0.4, 0, 0], inertia: [0.001, 0.11, 0.11",
               "mass: 0, center_of_mass: [0.4, 0, 0], inertia: [0, 0, 0");
  EXPECT_THAT(message(massless),
              testing::AllOf(testing::HasSubstr("/hinges/pivot: the mass matrix is singular: pivot.0 "
                                                "moves no mass"),
                             testing::Not(testing::HasSubstr("apart"))));
}

TEST(ClosedLoops, ALoadThatFollowsAReactionOfItsOwnInstantIsRefused) {
  for (const char* reaction : {"constraint: loop", "hinge: pivot"}) {
    for (const char* measured : {"k.fx", "twice"}) {
      const std::string good = four_bar(rigid_coupler, "dopri5") + "outputs:\n  k: {type: reaction, " + reaction +
                               "}\n  twice: {type: expression, value: 2 * k.fx}\n";
      const auto with = [&](const std::string& more) {
        return message(replaced(good, "  torque:",
                                std::string("  servo: {type: pid, of: ") + measured + ", hinge: motor, integral: 1" +
                                    more + "}\n  torque:"));
      };
      EXPECT_THAT(with(""), testing::HasSubstr(std::string("signal '") + measured + "' depends on efforts"))
          << reaction;
      EXPECT_EQ(with(", sample: 0.01"), "") << reaction;
    }
  }
}

TEST(ClosedLoops, ANoteOnRejectedStepsNamesWhatMayBeThere) {
  const auto note = [](const std::string& scene) { return note_on_jumps(*Made(scene).scene.model, {1.0}); };
  const std::string loaded = four_bar(rigid_coupler, "radau");
  EXPECT_THAT(note(loaded), testing::HasSubstr("a load jumps without declaring it."));
  const std::string torque = "loads:\n  torque: {type: hinge-effort, hinge: motor, law: constant, value: 1.5}\n";
  EXPECT_THAT(note(replaced(loaded, torque, "")), testing::HasSubstr("what moves there is fast beside the rest."));
}

TEST(ClosedLoops, AllFaultsOfConstraintsAreReportedWhereTheyStand) {
  const std::string good = four_bar(rigid_coupler, "dopri5");
  const std::string bad = replaced(good, "constraints:\n", R"(constraints:
  a: {type: hinge, hinge: revolut, a: coupler.tip, b: rocker.pin}
  b: {type: hinge, hinge: universal, a: coupler.tp, b: rocker.pin}
  c: {type: hinge, hinge: spherical, a: coupler.tip, b: coupler.root}
  e: {type: hinge, hinge: free, a: coupler.tip, b: rocker.pin}
  f: {type: hinge, hinge: spherical, a: world, b: world}
  g: {type: rope, hinge: spherical, a: world, b: rocker.pin}
)");
  EXPECT_THAT(message(bad),
              testing::AllOf(
                  testing::HasSubstr(R"(14:27: /constraints/a/hinge: no hinge plugin "revolut")"),
                  testing::HasSubstr(R"(15:41: /constraints/b/a: no frame "coupler.tp"; did you mean 'coupler.tip'?)"),
                  testing::HasSubstr("16:57: /constraints/c/b: both its frames are on body 'coupler'"),
                  testing::HasSubstr(R"(17:27: /constraints/e/hinge: "free" cannot close a loop)"),
                  testing::HasSubstr("/constraints/f/b: both its frames are in the world"),
                  testing::HasSubstr("19:13: /constraints/g/type: got \"rope\"")));
  // Two loops that no state closes.
  EXPECT_THAT(message(replaced(
                  good, "loads:", "  other: {type: hinge, hinge: spherical, a: coupler.root, b: rocker.pin}\nloads:")),
              testing::HasSubstr("the loop cannot be closed from this start"));
}

TEST(ClosedLoops, WhatKnowsTreesAloneIsRefused) {
  const std::string good = four_bar(beam_coupler, "dopri5");
  EXPECT_THAT(message(good, "consistent"),
              testing::HasSubstr("/formulation: consistent: closed loops (constraints) need"));
  EXPECT_THAT(message(good, "auto"), testing::HasSubstr("/formulation: got 'auto'"));
  EXPECT_THAT(message(replaced(good, "  torque:",
                               "  slew: {type: rigid-inverse-dynamics, law: quintic, duration: 1, "
                               "hinges: {motor: {from: 0, to: 1}}}\n  torque:")),
              testing::HasSubstr("/loads/slew: the inverse dynamics of the rigid tree"));
  const Made made(good);
  for (const char* id : {"cvode", "imex", "rosenbrock-w", "generalized-alpha"}) {
    const std::string options = std::string(id) == "generalized-alpha" ? "{name: generalized-alpha, step: 0.01}" : id;
    const Made other(four_bar(beam_coupler, options));
    EXPECT_THAT([&] { other.scene.integrator->start(*other.equations, other.scene.initial); },
                testing::ThrowsMessage<std::invalid_argument>(
                    testing::HasSubstr("integrator '" + std::string(id) + "' cannot run closed loops")));
  }
  // What stands between equations and integrator would hide the loops.
  const std::vector<Rung> rungs = {{"quadratic", {}, made.equations.get()}};
  EXPECT_THAT(
      [&] {
        ChangingEquations(rungs, {{0, 0, 1}});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("loops are closed")));
}

TEST(ClosedLoops, EventsThatChangeTheTreeAreRefusedWhereTheyStand) {
  std::string text = replaced(four_bar(beam_coupler, "dopri5"), "hinges:\n  motor",
                              "  load: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n  motor");
  text = replaced(text, "constraints:", "  grip: {type: weld, parent: rocker.pin, child: load}\nconstraints:");
  const std::string said = message(text + R"(events:
  hold: {at: 0.2, do: {lock: [motor, pivot]}}
  free: {at: 0.3, do: {unlock: motor}}
  drop: {at: 0.4, do: {release: load}}
  calm: {at: 0.5, do: {switch_off: torque}}
)");
  for (const char* part : {"/events/hold/do/lock", "/events/free/do/unlock", "/events/drop/do/release",
                           "'release' is for trees, and this scene closes loops (constraints.loop)"})
    EXPECT_THAT(said, testing::HasSubstr(part));
  EXPECT_THAT(said, testing::Not(testing::HasSubstr("/formulation")));
  EXPECT_THAT(said, testing::Not(testing::HasSubstr("/events/calm")));
  const Made made(text + "events: {calm: {at: 0.5, do: {switch_off: torque}}}\n");
  EXPECT_EQ(run(made, 0.6).status, RunStatus::completed);
}

}  // namespace
}  // namespace withy::test
