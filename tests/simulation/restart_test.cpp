/// \file
/// A run goes on from the state in which another has ended as that one would have: with what controllers hold and
/// remember between their samples, and with relays as they stood.
#include <gmock/gmock.h>

#include "acted_run.hpp"

namespace withy {
namespace {

using test::ActedRun;
using test::Made;
using testing::HasSubstr;

// Everything that remembers between instants, with periods that have no common one at the times of the cuts.
std::string controlled_arm(double end, const std::string& initial) {
  return R"(format: withy/1
integrator: {name: dop853, rtol: 1e-10, atol: 1e-12}
bodies:
  disc: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  arm: {type: rigid, mass: 1, center_of_mass: [0.3, 0, 0], inertia: [0.01, 0.02, 0.02, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disc}
  elbow: {type: revolute, axis: [0, 0, 1], parent: disc, child: arm}
outputs: {imu: {type: accelerometer, of: arm}, turn: {type: gyro, of: arm}}
loads:
  spring: {type: hinge-spring, hinge: elbow, stiffness: 2}
  servo: {type: pid, of: axle, hinge: axle, proportional: 3, integral: 4, derivative: 0.1, filter: 0.05, sample: 0.03, delay: 0.06, reference: 0.4}
  lead: {type: transfer-function, of: elbow, hinge: elbow, reference: 0.1, numerator: [0.2, 1], denominator: [0.1, 1], sample: 0.025}
  mean: {type: moving-average, of: imu.x, window: 0.1, sample: 0.02}
  noisy: {type: noise, of: mean, deviation: 0.1, seed: 3, sample: 0.02}
  read: {type: quantizer, of: noisy, step: 0.05, range: 10, sample: 0.02}
  total: {type: over-time, of: turn.z, what: mean}
  least: {type: over-time, of: elbow, what: min, sample: 0.02}
  damp: {type: pid, of: read, hinge: elbow, proportional: 0.3, sample: 0.04}
  lag: {type: expression, hinge: axle, value: -0.2 * total - 0.3 * least}
  jets: {type: hinge-relay, hinge: axle, effort: 0.3, target: 0.3, on: 0.05, off: 0.02, rate_time: 0.1}
events: {weaker: {at: 0.31, do: {set: loads.servo.proportional=2}}}
time: {end: )" +
         std::to_string(end) + ", output: 10}\n" + initial;
}

TEST(Restarts, go_on_with_what_controllers_and_relays_hold) {
  const std::string start = "initial: {hinges: {axle: {rate: 1}, elbow: {position: 0.3, rate: -1}}}\n";
  const ActedRun whole(controlled_arm(1, start));
  for (const double cut : {0.2, 0.317, 0.6, 0.77}) {
    const ActedRun half(controlled_arm(cut, start));
    const std::string state = write_state(*half.scene.model, half.summary.final);
    const ActedRun rest(controlled_arm(1, "initial: " + state + "\n"));
    ASSERT_EQ(rest.scene.initial.y, half.summary.final.y) << state;
    // Steps are others from the cut on: errors are those of the integrator, on numbers of about one.
    for (std::size_t i = 0; i < whole.summary.final.y.size(); ++i)
      EXPECT_NEAR(rest.summary.final.y[i], whole.summary.final.y[i], 1e-7) << cut << " s, " << i;
  }
}

std::string refusal_of(const std::string& initial) {
  try {
    const Made made(controlled_arm(1, initial));
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

TEST(Restarts, need_what_all_loads_hold_as_it_was_written) {
  const std::string text = refusal_of("initial: {held: {jets: 3, noisy: [1], servos: [1]}}\n");
  for (const char* part : {"need a list of", "nothing of load \"damp\"", "no load that holds numbers", "'servo'"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(refusal_of("initial: {held: 3}\n"), HasSubstr("need a map of names of loads that hold numbers"));
}

// Steps see what is until then at their end; just before zero there are but numbers that count as zero.
TEST(Restarts, before_zero_meet_what_jumps_at_zero_there) {
  for (const std::string integrator : {"{name: rk4, step: 0.05}", "{name: generalized-alpha, step: 0.05}", "dopri5",
                                       "dop853", "radau", "cvode", "imex"}) {
    const auto rate = [&](const std::string& begin, const std::string& jump, const std::string& end) {
      const ActedRun run(
          "format: withy/1\nbodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
          "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
          "loads: {push: {type: hinge-effort, hinge: slide, law: steps, table: [[" +
          jump + ", 1]]}}\ninitial: {time: " + begin + "}\ntime: {output: 10, end: " + end +
          "}\nintegrator: " + integrator + "\n");
      return run.rate("slide");
    };
    EXPECT_NEAR(rate("-0.25", "0", "0.5"), 0.5, 1e-9) << integrator;
    EXPECT_NEAR(rate("0", "0.25", "0.75"), 0.5, 1e-9) << integrator;
  }
}

}  // namespace
}  // namespace withy
