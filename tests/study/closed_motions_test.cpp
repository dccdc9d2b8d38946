// Small motions of closed loops: linkages in one coordinate, beams and columns between supports, the equations
// themselves beside a state, and equilibria under small forces.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/core/analysis/adaptive_difference.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/small_motions.hpp"
#include "withy/tests/simulation/four_bar.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::Linkage;
using testing::HasSubstr;

/// Two equal cranks of 0.4 m that carry a body, each on a hinge of the world.
const std::string carried_on_cranks = R"(
gravity: [0, -9.81, 0]
bodies:
  left: {type: rigid, mass: 1.2, center_of_mass: [0.2, 0, 0], inertia: [0.001, 0.016, 0.016, 0, 0, 0], frames: {pin: {position: [0.4, 0, 0]}}}
  carried: {type: rigid, mass: 3, center_of_mass: [0.5, 0, 0], inertia: [0.01, 0.25, 0.25, 0, 0, 0], frames: {pin: {position: [1, 0, 0]}}}
  right: {type: rigid, mass: 1.2, center_of_mass: [0.2, 0, 0], inertia: [0.001, 0.016, 0.016, 0, 0, 0], frames: {pin: {position: [0.4, 0, 0]}}}
hinges:
  first: {type: revolute, axis: [0, 0, 1], parent: world, child: left}
  second: {type: revolute, axis: [0, 0, 1], parent: left.pin, child: carried}
  third: {type: revolute, axis: [0, 0, 1], parent: world, child: right, offset: {position: [1, 0, 0]}}
constraints: {loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: carried.pin, b: right.pin}}
initial: {hinges: {first: {position: ["-60 deg"]}}, guess: {hinges: {second: {position: ["60 deg"]}, third: {position: ["-60 deg"]}}}}
)";
/// It swings like a pendulum of this inertia [kg m²] and this moment of weight [N m].
constexpr double swung = 2 * (0.016 + 1.2 * 0.04) + 3 * 0.16, weighed = 9.81 * (2 * 1.2 * 0.2 + 3 * 0.4);

Prepared linkage(const std::string& coupler, const std::vector<std::string>& changes = {}) {
  SceneValues values = SceneValues::parse(test::four_bar(coupler, "dopri5"), "text");
  values.set_text("initial.hinges.motor.rate=[0]");
  for (const std::string& change : changes) values.set_text(change);
  return prepare(std::move(values), test::plugins());
}

std::vector<Mode> modes_of(const Prepared& prepared, const Holding& holding = {}) {
  const ModesAt at = modes_at({prepared, prepared.scene.initial, holding}, false, {});
  EXPECT_EQ(at.problem, "");
  return at.modes;
}

TEST(ClosedMotions, AParallelogramSwingsLikeAPendulum) {
  const std::vector<Mode> modes = modes_of(scene_of(carried_on_cranks));
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_NEAR(modes[0].frequency(), std::sqrt(weighed / swung), 1e-12 * modes[0].frequency());
  // What follows is in the shape: the carried body keeps its direction.
  EXPECT_NEAR(std::abs(modes[0].shape[1] + modes[0].shape[0]), 0, 1e-14);
  EXPECT_NEAR(std::abs(modes[0].shape[2] - modes[0].shape[0]), 0, 1e-14);
}

TEST(ClosedMotions, ALinkageMovesAsItsOneCoordinateDoes) {
  const auto slope = [](auto&& f, double at) {
    return adaptive_difference([&](double h) { return Eigen::VectorXd::Constant(1, f(at + h)); }, 1e-2).slope[0];
  };
  const auto push = [&](double x) { return 1.5 - slope([](double at) { return Linkage::weight(at); }, x); };
  const Prepared prepared = linkage(test::rigid_coupler);
  const Configuration start = at_start(prepared);
  EXPECT_FALSE(start.follows(0)) << "the motor moves, the others follow";
  EXPECT_TRUE(start.follows(1) && start.follows(2));
  // Where it does not rest too.
  const LinearModel m = linear_model(start, {{"motor"}, {}});
  ASSERT_EQ(m.system.A.rows(), 2);
  const double x = std::numbers::pi / 2;
  EXPECT_NEAR(m.accelerations[0].second, push(x) / Linkage::inertia(x), 1e-10 * std::abs(m.accelerations[0].second));
  const double stiffness = slope([&](double at) { return push(at) / Linkage::inertia(at); }, x);
  EXPECT_NEAR(m.system.A(1, 0), stiffness, 1e-6 * std::abs(stiffness));
  EXPECT_NEAR(m.system.B(1, 0), 1 / Linkage::inertia(x), 1e-10 * m.system.B(1, 0));

  const Equilibrium found = find_equilibrium(start, {}, test::plugins());
  ASSERT_TRUE(found.steady.converged);
  const double rest = found.steady.state.y[0];
  EXPECT_NEAR(push(rest), 0, 1e-8 * 1.5);
  const std::vector<Mode> modes = modes_of(prepared);
  EXPECT_NEAR(modes.at(0).squared_frequency(), -slope(push, rest) / Linkage::inertia(rest),
              1e-6 * std::abs(modes[0].squared_frequency()));
}

TEST(ClosedMotions, AreTheSameWhicheverHingeIsCut) {
  std::string other = test::replaced(carried_on_cranks, "parent: world, child: right, offset: {position: [1, 0, 0]}",
                                     "parent: carried.pin, child: right.pin");
  other = test::replaced(other, "a: carried.pin, b: right.pin", "a: world, b: right, offset: {position: [1, 0, 0]}");
  const std::vector<Mode> modes = modes_of(scene_of(other));
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_NEAR(modes[0].frequency(), std::sqrt(weighed / swung), 1e-12 * modes[0].frequency());
}

TEST(ClosedMotions, ADoorOnTwoHingesSwingsAsOnOne) {
  const std::string door = R"(
gravity: [0, 0, -9.81]
bodies: {door: {type: rigid, mass: 20, center_of_mass: [0.4, 0, 1], inertia: [9, 8, 2, 0, 0, 0], frames: {top: {position: [0.3, 0.2, 1]}}}}
hinges: {low: {type: revolute, axis: [0.3, 0.2, 1], parent: world, child: door}}
)";
  const std::string high =
      "constraints: {high: {type: hinge, hinge: revolute, axis: [0.3, 0.2, 1], a: world, b: door.top, offset: "
      "{position: "
      "[0.3, 0.2, 1]}}}\n";
  const std::vector<Mode> one = modes_of(scene_of(door)), two = modes_of(scene_of(door + high));
  ASSERT_EQ(two.size(), 1U);
  EXPECT_NEAR(two[0].frequency(), one.at(0).frequency(), 1e-12 * one[0].frequency());
  // As far open as loops may begin, where nothing can close it.
  const std::string open = test::replaced(high, "1]}}}\n", "1.0000000001]}}}\n");
  EXPECT_NEAR(modes_of(scene_of(door + open)).at(0).frequency(), one[0].frequency(), 1e-9 * one[0].frequency());
}

/// A beam of 2 m, 3 kg/m and 500 N m² whose tip is on a slider of the world; `push` along it.
std::string supported(const std::string& root, const std::string& bending, double push) {
  return "bodies:\n  beam: {type: beam, length: 2, mass_per_length: 3, bending_y: {stiffness: 500, " + bending +
         "}}\n  shoe: {type: rigid, mass: 0.01, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n  root: {" + root +
         ", parent: world, child: beam}\n  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: shoe, "
         "offset: "
         "{position: [2, 0, 0]}}\nconstraints: {pin: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: beam.tip, b: "
         "shoe}}\nloads: {push: {type: force, frame: shoe, value: [" +
         std::to_string(-push) + ", 0, 0]}}\n";
}
const std::string turns = "type: revolute, axis: [0, 0, 1]";

TEST(ClosedMotions, BeamsBetweenSupportsHaveTheirFrequencies) {
  const double unit = std::sqrt(500.0 / 3) / 4;  // √(EI/μ)/L²
  const auto first = [&](const std::string& root, const std::string& family, int count) {
    const std::vector<Mode> modes =
        modes_of(scene_of(supported(root, "modes: " + std::to_string(count) + ", family: " + family, 0)));
    return modes.at(0).rigid ? modes.at(1).frequency() : modes.at(0).frequency();
  };
  const double pinned = std::pow(std::numbers::pi, 2) * unit, propped = std::pow(3.926602312047919, 2) * unit;
  EXPECT_NEAR(first(turns, "pinned-pinned", 3), pinned, 1e-9 * pinned);
  // Modes of a cantilever, which no support at the tip knows: from above, with more modes nearer.
  for (const auto& [root, exact] : {std::pair(turns, pinned), std::pair(std::string("type: weld"), propped)}) {
    const double few = first(root, "clamped-free", 4), many = first(root, "clamped-free", 8);
    EXPECT_GT(few, exact);
    EXPECT_GT(many, exact * (1 - 1e-12));
    EXPECT_LT(many - exact, 0.5 * (few - exact)) << root;
    EXPECT_LT(many - exact, 1e-2 * exact) << root;
  }
}

TEST(ClosedMotions, AColumnBetweenPinsLosesItsStiffnessAtEulersLoad) {
  const double critical = std::pow(std::numbers::pi, 2) * 500 / 4, unit = std::sqrt(500.0 / 3) / 4;
  for (const double share : {0.3, 0.9, 1.2}) {
    const std::vector<Mode> modes =
        modes_of(scene_of(supported(turns, "modes: 2, family: pinned-pinned", share * critical)));
    const double squared = std::pow(std::numbers::pi, 4) * unit * unit * (1 - share);
    EXPECT_NEAR(modes.at(0).squared_frequency(), squared, 1e-7 * std::abs(squared)) << share;
  }
}

/// A stage on two legs of a metre with flexures of 3 cm at their ends, all welded, under gravity; lengths times `unit`.
std::string flexures(double unit) {
  const auto n = [](double x) { return fmt::format("{}", x); };
  const double k = unit, k2 = k * k;
  const std::string beam = "{type: beam, length: " + n(0.03 * k) + ", mass_per_length: " + n(0.05 / k) +
                           ", bending_y: {stiffness: " + n(0.06 * k * k2) + ", modes: 2, family: clamped-free}}";
  const std::string leg = "{type: rigid, mass: 1, center_of_mass: [" + n(0.5 * k) + ", 0, 0], inertia: [" +
                          n(0.001 * k2) + ", " + n(0.08 * k2) + ", " + n(0.08 * k2) +
                          ", 0, 0, 0], frames: {end: {position: [" + n(k) + ", 0, 0]}}}";
  const std::string turned = "orientation: {axis: [0, 0, 1], angle: ";
  return "gravity: [" + n(-2.943 * k) + ", " + n(-9.81 * k) + ", 0]\nbodies:\n  foot_a: " + beam +
         "\n  head_a: " + beam + "\n  foot_b: " + beam + "\n  head_b: " + beam + "\n  leg_a: " + leg +
         "\n  leg_b: " + leg + "\n  stage: {type: rigid, mass: 3, center_of_mass: [" + n(0.2 * k) + ", " + n(0.05 * k) +
         ", 0], inertia: [" + n(0.05 * k2) + ", " + n(0.05 * k2) + ", " + n(0.1 * k2) +
         ", 0, 0, 0], frames: {end: {position: [" + n(0.5 * k) + ", 0, 0], " + turned +
         "\"-90 deg\"}}}}\nhinges:\n  a1: {type: weld, parent: world, child: foot_a, offset: {" + turned +
         "\"-90 deg\"}}}\n  a2: {type: weld, parent: foot_a.tip, child: leg_a}\n  a3: {type: weld, parent: leg_a.end, "
         "child: head_a}\n  a4: {type: weld, parent: head_a.tip, child: stage, offset: {" +
         turned + "\"90 deg\"}}}\n  b1: {type: weld, parent: world, child: foot_b, offset: {position: [" + n(0.5 * k) +
         ", 0, 0], " + turned +
         "\"-90 deg\"}}}\n  b2: {type: weld, parent: foot_b.tip, child: leg_b}\n  b3: {type: weld, parent: leg_b.end, "
         "child: head_b}\nconstraints: {loop: {type: hinge, hinge: weld, a: head_b.tip, b: stage.end}}\n";
}

TEST(ClosedMotions, OfShortFlexuresAreTheSameInOtherUnitsOfLength) {
  const std::vector<Mode> metres = modes_of(scene_of(flexures(1))), others = modes_of(scene_of(flexures(100)));
  ASSERT_EQ(metres.size(), 5U);
  ASSERT_EQ(others.size(), 5U);
  for (std::size_t k = 0; k < metres.size(); ++k)
    EXPECT_NEAR(others[k].frequency(), metres[k].frequency(), 1e-8 * metres[k].frequency());
}

/// The linkage on a boom that bends, on a hub that turns; springs, a damper and a controller with states.
const std::vector<std::string> aboard = {
    "bodies.hub={type: rigid, mass: 5, inertia: [1, 1, 2, 0, 0, 0]}",
    "bodies.boom={type: beam, length: 1.5, mass_per_length: 2, bending_y: {stiffness: 900, modes: 2}, bending_z: "
    "{stiffness: 900, modes: 1}, damping_ratio: 0.01}",
    "hinges.axle={type: revolute, axis: [0, 0, 1], parent: world, child: hub}",
    "hinges.base={type: weld, parent: hub, child: boom, offset: {position: [0.2, 0, 0]}}",
    "hinges.motor.parent=boom.tip",
    "hinges.pivot.parent=boom.tip",
    "loads.spring={type: hinge-spring, hinge: elbow, stiffness: 4, free_position: -1}",
    "loads.damper={type: hinge-spring, hinge: pivot, stiffness: 0, damping: 0.3}",
    "loads.servo={type: pid, hinge: pivot, proportional: 300, integral: 200, derivative: 20, filter: 0.02, "
    "reference: 1.6}",
};

TEST(ClosedMotions, AreThoseOfTheEquationsBesideAState) {
  for (const std::string formulation : {"quadratic", "symmetric", "ruthless"}) {
    for (const double spin : {0.0, 4.0}) {
      std::vector<std::string> changes = aboard;
      changes.push_back("formulation=" + formulation);
      const Prepared prepared = linkage(test::beam_coupler, changes);
      State state = prepared.scene.initial;
      const Configuration c(prepared, state, {{}, {{"axle", spin}}});
      const SmallMotions motions(c, {});
      const auto free = static_cast<Eigen::Index>(motions.free().size());
      Work work = motions.equations().make_work();
      const auto rates = [&](const State& at) {
        std::vector<double> slope(motions.equations().size());
        EXPECT_TRUE(motions.equations().derivatives(at.time, at.y, slope, work).ok());
        const Layout& layout = motions.model().layout();
        const Eigen::Map<const Eigen::VectorXd> all(slope.data() + layout.positions,
                                                    static_cast<Eigen::Index>(layout.speeds + layout.continuous));
        Eigen::VectorXd of_free(free + static_cast<Eigen::Index>(layout.continuous));
        of_free << all(motions.free()), all.tail(static_cast<Eigen::Index>(layout.continuous));
        return of_free;
      };
      ASSERT_EQ(motions.size(), 2 * free + 2);
      for (Eigen::Index i = 0; i < motions.size(); ++i) {
        const Eigen::VectorXd column =
            adaptive_difference([&](double h) { return rates(motions.displaced(i, h)); }, motions.step(i)).slope;
        const Eigen::VectorXd exact = motions.A().col(i).tail(column.size());
        EXPECT_LT((column - exact).norm(), 1e-7 * std::max(1.0, exact.norm()))
            << formulation << ' ' << spin << ' ' << motions.names()[static_cast<std::size_t>(i)];
      }
    }
  }
}

TEST(ClosedMotions, AStaticForceMovesAsTheEquilibriumDoes) {
  const auto with = [](double value) {
    std::vector<std::string> changes = aboard;
    changes.push_back("loads.torque=null");
    changes.push_back("loads.force={type: force, frame: coupler.tip, value: [0, " + std::to_string(value) + ", 0]}");
    changes.push_back("loads.push={type: input, frame: coupler.tip, direction: [0, 1, 0]}");
    changes.push_back(
        "outputs={angle: {type: hinge, hinge: elbow}, tip: {type: frame, of: coupler.tip, in: world}, pin: {type: "
        "reaction, constraint: loop}}");
    return linkage(test::beam_coupler, changes);
  };
  const Holding locked{{"axle"}, {}};
  const auto rest = [&](double value) {
    const Prepared prepared = with(value);
    const Configuration c(prepared, prepared.scene.initial, locked);
    Configuration at = c;
    const Equilibrium found = find_equilibrium(c, locked, test::plugins());
    EXPECT_TRUE(found.steady.converged);
    at.set_state(found.steady.state);
    LinearModel m = linear_model(at, {{"push"}, {}});
    EXPECT_TRUE(m.equilibrium);
    for (const auto& [speed, acceleration] : m.accelerations) EXPECT_NEAR(acceleration, 0, 1e-6) << speed;
    return m;
  };
  constexpr double push = 0.02;  // [N] what it does is linear to 1e-6
  const LinearModel m = rest(0), more = rest(push), less = rest(-push);
  const Eigen::VectorXd gain =
      m.system.D.col(0) - m.system.C * m.system.A.colPivHouseholderQr().solve(m.system.B.col(0));
  for (std::size_t k = 0; k < m.outputs.size(); ++k) {
    if (m.outputs[k].name.find("rate") != std::string::npos) continue;
    const double difference = (more.output_values[k] - less.output_values[k]) / (2 * push);
    EXPECT_NEAR(gain[static_cast<Eigen::Index>(k)], difference, 1e-4 * std::max(1e-3, std::abs(difference)))
        << m.outputs[k].name;
  }
}

TEST(ClosedMotions, ASampledControllerOfWhatFollowsHasItsPoles) {
  // The first and the third hinge turn alike: a controller of either is the same.
  const auto with = [](const std::string& hinge) {
    return modes_of(scene_of(carried_on_cranks + "loads: {servo: {type: pid, hinge: " + hinge +
                             ", proportional: 40, derivative: 6, sample: 0.02, reference: -1.2}}\n"));
  };
  const std::vector<Mode> first = with("first"), third = with("third");
  ASSERT_EQ(first.size(), third.size());
  ASSERT_FALSE(first.empty());
  for (std::size_t k = 0; k < first.size(); ++k)
    EXPECT_LT(std::abs(third[k].eigenvalue - first[k].eigenvalue), 1e-8 * std::abs(first[k].eigenvalue));
}

TEST(ClosedMotions, KeepTheWayInWhichLoopsAreClosed) {
  // A rocker of 0.8, which reaches from -1.745 to -0.846 rad with the links on this side, and as far on the other; they
  // cannot come from one to the other.
  const std::string linkage = R"(
gravity: [0, -9.81, 0]
bodies:
  rocker: {type: rigid, mass: 1, center_of_mass: [0.4, 0, 0], inertia: [0.001, 0.02, 0.02, 0, 0, 0], frames: {pin: {position: [0.8, 0, 0]}}}
  coupler: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.001, 0.2, 0.2, 0, 0, 0], frames: {pin: {position: [1, 0, 0]}}}
  crank: {type: rigid, mass: 1, center_of_mass: [0.15, 0, 0], inertia: [0.001, 0.02, 0.02, 0, 0, 0], frames: {pin: {position: [0.3, 0, 0]}}}
hinges:
  first: {type: revolute, axis: [0, 0, 1], parent: world, child: rocker}
  second: {type: revolute, axis: [0, 0, 1], parent: rocker.pin, child: coupler}
  third: {type: revolute, axis: [0, 0, 1], parent: world, child: crank, offset: {position: [0.9, 0, 0]}}
constraints: {loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: coupler.pin, b: crank.pin}}
initial: {hinges: {first: {position: [-1.5]}}, guess: {hinges: {second: {position: [2.49]}, third: {position: [3.0]}}}}
)";
  const Prepared prepared = scene_of(linkage);
  const SteadyState found = find_equilibrium(at_start(prepared), {}, test::plugins()).steady;
  ASSERT_TRUE(found.converged);
  // Where weight is least on this side: dV/dθ = 0 of the heights of three centres of mass.
  EXPECT_NEAR(found.state.y[0], -1.540, 1e-3);
}

TEST(ClosedMotions, AreRefusedInSingularConfigurations) {
  const auto refused = [](const std::string& text) {
    try {
      at_start(scene_of(text));
    } catch (const InputError& e) {
      return std::string(e.what()).find("singular configuration") != std::string::npos;
    }
    return false;
  };
  const auto at_angle = [](const std::string& degrees) {
    return test::replaced(carried_on_cranks,
                          "initial: {hinges: {first: {position: [\"-60 deg\"]}}, guess: {hinges: {second: {position: "
                          "[\"60 deg\"]}, third: {position: [\"-60 deg\"]}}}}",
                          "initial: {hinges: {first: {position: [\"" + degrees +
                              " deg\"]}}, guess: {hinges: {third: {position: [\"" + degrees + " deg\"]}}}}");
  };
  EXPECT_TRUE(refused(at_angle("0"))) << "links in one line go on in two ways";
  EXPECT_FALSE(refused(at_angle("-1")));
  // Welded at both ends it cannot bend without shortening.
  const std::string fixed = test::replaced(
      R"(bodies: {beam: {type: beam, length: 2, mass_per_length: 3, bending_y: {stiffness: 500, modes: 4}EXTENSION}}
hinges: {root: {type: weld, parent: world, child: beam}}
constraints: {end: {type: hinge, hinge: weld, a: world, b: beam.tip, offset: {position: [2, 0, 0]}}}
)",
      "EXTENSION", ", extension: {stiffness: 1e6, modes: 2}");
  EXPECT_FALSE(refused(fixed));
  EXPECT_TRUE(refused(test::replaced(fixed, ", extension: {stiffness: 1e6, modes: 2}", "")));
}

TEST(ClosedMotions, AreRefusedWhereLoopsMove) {
  const auto message = [](const auto& run) -> std::string {
    try {
      run();
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message([] { at_start(linkage(test::rigid_coupler, {"initial.hinges.motor.rate=[1]"})); }),
              HasSubstr("motor.0 is in a closed loop and moves, at 1 a second"));
  EXPECT_THAT(message([] {
                const Prepared p = linkage(test::rigid_coupler);
                Configuration(p, p.scene.initial, {{}, {{"pivot", 2}}});
              }),
              HasSubstr("'pivot' is in a closed loop"));
}

}  // namespace
}  // namespace withy::study
