// Simulations that a host sets back to where they were.
#include <gmock/gmock.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/tests/host/busy.hpp"

namespace withy {
namespace {

using host::Scene;
using host::Simulation;
using host::Snapshot;
using test::busy_scene;
using test::drive;
using test::library;
using testing::HasSubstr;

TEST(HostedSnapshots, replays_from_a_snapshot_bit_by_bit) {
  for (const char* integrator : {"dopri5", "{name: rk4, step: 0.007}", "rosenbrock-w"}) {
    const Scene scene = busy_scene().set("integrator", integrator);
    Simulation first(scene);
    drive(first, 0, 6);
    first.set_input("torque", 0.05);  // waiting when the snapshot is taken
    const Snapshot middle = first.snapshot();
    EXPECT_EQ(middle.time(), first.time());
    first.step(0.25);
    const std::vector<double> went_on = drive(first, 6, 20);
    const auto again = [&](Simulation& simulation) {
      EXPECT_EQ(simulation.input("torque"), 0.05);
      simulation.step(0.25);
      return drive(simulation, 6, 20);
    };
    first.restore(middle);
    EXPECT_EQ(again(first), went_on) << integrator;
    Simulation other(scene);
    other.restore(Snapshot::of_numbers(middle.numbers()));
    EXPECT_EQ(again(other), went_on) << integrator;
  }
}

/// The same number of coordinates, rates, inputs and events is not the same scene.
TEST(HostedSnapshots, goes_back_to_snapshots_of_its_own_scene_alone) {
  Simulation first(busy_scene());
  first.step(0.1);
  const Snapshot kept = first.snapshot();
  const auto refusal = [&](const Scene& scene) -> std::string {
    Simulation other(scene);
    try {
      other.restore(kept);
    } catch (const std::invalid_argument& e) {
      EXPECT_EQ(other.time(), 0);
      return e.what();
    }
    EXPECT_EQ(other.time(), first.time());
    return {};
  };
  std::string renamed = test::busy_arm, sliding = test::busy_arm;
  for (std::size_t at = 0; (at = renamed.find("axle", at)) != std::string::npos;) renamed.replace(at, 4, "knob");
  sliding.replace(sliding.find("type: revolute"), 14, "type: prismatic");
  EXPECT_THAT(refusal(busy_scene().set("bodies.hub.mass", 50)), HasSubstr("of another scene"));
  EXPECT_THAT(refusal(busy_scene().set("integrator.rtol", 1e-6)), HasSubstr("of another scene"));
  EXPECT_THAT(refusal(Scene::parse(library(), renamed)), HasSubstr("of another scene"));
  EXPECT_THAT(refusal(Scene::parse(library(), sliding)), HasSubstr("of another scene"));
  // Where a run begins and ends and what it shows says nothing of the steps from a state.
  EXPECT_EQ(refusal(busy_scene().set("time.end", 7).set("name", "x").set("initial.hinges.axle.position", "[0.2]")), "");
}

/// What a run shows has no part in its steps, whatever plugins it takes to show it; what a load measures has.
TEST(HostedSnapshots, goes_back_where_outputs_that_nothing_names_are_others) {
  Simulation first(busy_scene());
  first.step(0.1);
  const Snapshot kept = first.snapshot();
  const auto refusal = [](Simulation& simulation, const Snapshot& snapshot) -> std::string {
    try {
      simulation.restore(snapshot);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return {};
  };
  first.step(0.2);
  for (const char* outputs : {"{mid: {type: frame, of: boom.tip}}", "{drive: {type: effort, hinge: axle}}", "{}"}) {
    Simulation other(busy_scene().set("outputs", outputs));
    EXPECT_EQ(refusal(other, kept), "") << outputs;
    other.step(0.2);
    EXPECT_EQ(other.output("axle"), first.output("axle")) << outputs;
  }
  const auto measuring = [](const char* seen) {
    return Scene::parse(library(), std::string(R"(format: withy/1
time: {end: 1, output: 0.1}
bodies: {arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {end: {position: [1, 0, 0]}}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads: {servo: {type: pid, of: seen.y, hinge: axle, proportional: 1, reference: 0.5}}
outputs: )") + seen);
  };
  Simulation outside(measuring("{seen: {type: frame, of: arm.end}}"));
  Simulation more(measuring("{seen: {type: frame, of: arm.end}, other: {type: effort, hinge: axle}}"));
  Simulation inside(measuring("{seen: {type: frame, of: arm.end, in: arm}}"));
  outside.step(0.1);
  EXPECT_EQ(refusal(more, outside.snapshot()), "");
  EXPECT_THAT(refusal(inside, outside.snapshot()), HasSubstr("of another scene"));
}

TEST(HostedSnapshots, takes_no_numbers_that_are_not_a_whole_snapshot) {
  Simulation simulation(busy_scene());
  simulation.step(0.1);
  const std::vector<double> good = simulation.snapshot().numbers();
  EXPECT_EQ(Snapshot::of_numbers(good).time(), 0.1);
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const double wrong : {std::nan(""), good[i] == 0 ? 1.0 : -good[i]}) {
      std::vector<double> numbers = good;
      numbers[i] = wrong;
      EXPECT_THROW(static_cast<void>(Snapshot::of_numbers(numbers)), std::invalid_argument) << i;
    }
  }
  EXPECT_THROW(static_cast<void>(Snapshot::of_numbers({good.data(), good.size() - 1})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Snapshot::of_numbers({})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Snapshot().time()), std::invalid_argument);
}

}  // namespace
}  // namespace withy
