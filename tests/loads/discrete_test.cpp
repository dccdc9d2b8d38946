// Loads that change at instants alone: sampled controllers and relays.
#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>

#include <cmath>
#include <optional>

#include "withy/core/plugin/effortless_load.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using test::turntable;
using testing::HasSubstr;

std::unique_ptr<Load> discrete_load(const std::string& id, std::vector<Value::Member> given) {
  Registry registry = load_registry();
  return make_plugin<Load>(registry, id, std::move(given));
}

/// Sets the effort of its discrete or of its continuous state in the place of adding it.
class SettingParts final : public Load {
 public:
  explicit SettingParts(bool discrete) : discrete_(discrete) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<Bound>(discrete_); }

 private:
  class Bound final : public EffortlessLoad, private DiscretePart, private ContinuousPart {
   public:
    explicit Bound(bool discrete) : discrete_(discrete) {}
    const DiscretePart* discrete() const override { return discrete_ ? this : nullptr; }
    const ContinuousPart* continuous() const override { return discrete_ ? nullptr : this; }

   private:
    using EffortlessLoad::add;
    using EffortlessLoad::add_derivatives;
    using EffortlessLoad::begin;
    std::size_t states() const override { return 1; }
    std::string name(std::size_t) const override { return "z"; }
    void renew(double, std::span<const double>, std::span<const double>, const Crossing&, std::span<double>,
               std::span<double>) const noexcept override {}
    void begin(const LoadView&, std::span<double> z) const noexcept override { z[0] = 3; }
    void rates(const LoadView&, std::span<double> rates) const noexcept override { rates[0] = 0; }
    void add(double, std::span<const double> d, std::span<double> efforts) const noexcept override {
      efforts[0] = d[0];
    }
    void add(const LoadView& view, std::span<double> efforts) const noexcept override {
      efforts[0] = view.continuous[0];
    }

    bool discrete_;
  };
  bool discrete_;
};

const std::string sampled_feedback = turntable + R"(loads:
  control: {type: pd-controller, law: constant, sample: 0.03, hinges: {axle: {to: 0.5, stiffness: 5, damping: 0.4}}}
)";

// Between two samples the held effort τ gives x + v s + τ s²/2J: the loop of digital control, exactly.
TEST(SampledController, moves_as_its_difference_equation) {
  const double J = 0.2, period = 0.03;
  for (const char* integrator : {"{name: dopri5, rtol: 1e-10, atol: 1e-12}", "{name: rk4, step: 0.007}", "dop853"}) {
    test::LoadedScene s(sampled_feedback, {std::string("integrator=") + integrator});
    double x = 0, v = 0, tau = 0, last = 0;
    int next = 0;
    for (const State& state : s.run()) {
      for (; next * period <= state.time; ++next) {
        const double h = next * period - last;
        x += h * v + h * h / (2 * J) * tau;
        v += h / J * tau;
        tau = 5 * (0.5 - x) - 0.4 * v;
        last = next * period;
      }
      const double s_ = state.time - last;
      EXPECT_NEAR(s.position(state, "axle"), x + s_ * v + s_ * s_ / (2 * J) * tau, 1e-12) << integrator;
      EXPECT_NEAR(s.rate(state, "axle"), v + s_ / J * tau, 1e-12) << integrator;
    }
    EXPECT_TRUE(s.summary.suspected_jumps.empty());
  }
}

// Against the stability limit of the sampled loop with damping alone: v → (1 − c h / J) v, stable for h < 2J/c = 1 s.
TEST(SampledController, loses_stability_where_its_difference_equation_does) {
  const auto last_rate = [](const char* sample) {
    test::LoadedScene s(turntable + R"(loads:
  brake: {type: pd-controller, law: constant, sample: 1, hinges: {axle: {stiffness: 0, damping: 0.4}}}
)",
                        {std::string("loads.brake.sample=") + sample, "time.end=40", "time.output=40",
                         "initial={hinges: {axle: {rate: [1]}}}"});
    return std::abs(s.rate(s.run().back(), "axle"));
  };
  EXPECT_LT(last_rate("0.98"), 0.3);
  EXPECT_GT(last_rate("1.02"), 2.0);  // 1.04³⁹ = 4.6 at the sample before
}

TEST(SampledController, approaches_the_continuous_one_as_its_period_shrinks) {
  const auto end = [](const std::vector<std::string>& overrides) {
    test::LoadedScene s(sampled_feedback, overrides);
    return s.position(s.run().back(), "axle");
  };
  test::LoadedScene continuous(turntable + R"(loads:
  control: {type: pd-controller, law: constant, hinges: {axle: {to: 0.5, stiffness: 5, damping: 0.4}}}
)");
  const double limit = continuous.position(continuous.run().back(), "axle");
  const double coarse = std::abs(end({"loads.control.sample=4e-3"}) - limit);
  const double fine = std::abs(end({"loads.control.sample=1e-3"}) - limit);
  // A hold delays by half a period: an error of first order.
  EXPECT_NEAR(coarse / fine, 4, 0.2);
}

TEST(SampledController, computed_torque_holds_the_efforts_of_its_samples) {
  test::LoadedScene s(turntable + R"(loads:
  control: {type: computed-torque, law: constant, sample: 0.1, bandwidth: 2, damping_ratio: 1, hinges: {axle: {to: 0.5}}}
)",
                      {"time.output=0.05"});
  const auto work = std::make_unique<Work>(s.equations->make_work());
  std::vector<double> before;
  for (const State& state : s.run()) {
    std::vector<double> efforts(1);
    s.equations->load_efforts(state.time, state.y, EquationsOfMotion::all_loads, efforts, *work);
    // The output at an instant shows what was held until then; the last state has passed it.
    if (state.time > 0 && state.time < 2 && std::lround(state.time / 0.05) % 2 == 0) {
      EXPECT_EQ(efforts, before) << state.time;
    }
    // At rest the inverse dynamics asks for J ω² (x_r − x).
    if (state.time == 0) {
      EXPECT_NEAR(efforts[0], 0.2 * 4 * 0.5, 1e-12);
    }
    before = efforts;
    EXPECT_EQ(s.equations->system(state.time, state.y).applied, efforts);
  }
}

TEST(SampledController, conforms_to_the_suite) {
  const test::LoadedScene s(sampled_feedback);
  test::expect_load_conforms(
      *discrete_load("pd-controller", {{"law", Value(std::string("constant"))},
                                       {"time_scale", Value(1.0)},
                                       {"sample", Value(0.1)},
                                       {"hinges", Value::map({{"axle", Value::map({{"component", Value(0.0)},
                                                                                   {"stiffness", Value(5.0)},
                                                                                   {"damping", Value(1.0)}})}})}}),
      *s.scene.model);
}

// They would wipe out other loads.
TEST(LoadSuite, finds_parts_that_set_their_efforts) {
  const test::LoadedScene s(turntable);
  EXPECT_NONFATAL_FAILURE(test::expect_efforts_are_added(SettingParts(true), *s.scene.model),
                          "(DiscretePart::add): it sets efforts, and is to add to them");
  EXPECT_NONFATAL_FAILURE(test::expect_efforts_are_added(SettingParts(false), *s.scene.model),
                          "(ContinuousPart::add): it sets efforts, and is to add to them");
}

// Off and on again between two of its samples, of which it met none while it was off: it begins anew all the same, at
// the next, its integral at zero, and holds nothing until then.
TEST(SampledController, begins_anew_when_it_was_off_for_less_than_a_sample) {
  const double J = 0.2, period = 0.02, off = 0.513, on = 0.516;
  test::LoadedScene s(turntable + R"(loads:
  servo: {type: pid, hinge: axle, proportional: 4, integral: 8, reference: 0.5, sample: 0.02}
initial: {hinges: {axle: {position: [0.2], rate: [0.2]}}}
events:
  stop: {at: 0.513, do: {switch_off: servo}}
  go: {at: 0.516, do: {switch_on: servo}}
)",
                      {"time={end: 0.8, output: 0.01}"});
  double x = 0.2, v = 0.2, tau = 0, integral = 0, last = 0;
  const auto move = [&](double to) {
    const double h = to - last;
    x += h * v + h * h / (2 * J) * tau;
    v += h / J * tau;
    last = to;
  };
  const auto sample = [&] {
    tau = 4 * (0.5 - x) + integral;
    integral += period * 8 * (0.5 - x);
  };
  int next = 0;
  bool is_off = false, is_on = false;
  for (const State& state : s.run()) {
    for (; next * period <= state.time; ++next) {
      if (!is_off && next * period > off) move(off), tau = 0, is_off = true;
      if (!is_on && next * period > on) move(on), integral = 0, is_on = true;
      move(next * period);
      sample();
    }
    const double h = state.time - last;
    // No output falls between the events and the sample after them.
    EXPECT_NEAR(s.position(state, "axle"), x + h * v + h * h / (2 * J) * tau, 1e-10) << state.time;
  }
  EXPECT_TRUE(is_on);
}

// At rest until its first sample, whether that is where the run begins or comes a part of a period later: what it moves
// and what it asks for are then the same.
TEST(SampledController, that_begins_between_two_samples_waits_for_the_next) {
  for (const std::string load :
       {"{type: pd-controller, law: constant, sample: 0.1, hinges: {axle: {to: 0.5, stiffness: 5, damping: 0.4}}}",
        "{type: computed-torque, law: constant, sample: 0.1, bandwidth: 2, damping_ratio: 1, hinges: {axle: {to: "
        "0.5}}}",
        "{type: pid, hinge: axle, proportional: 4, integral: 8, derivative: 1, filter: 0.05, reference: 0.5, sample: "
        "0.1}",
        "{type: transfer-function, hinge: axle, reference: 0.5, numerator: [4, 8], denominator: [0.5, 1], sample: "
        "0.1}"}) {
    const auto moved = [&](const std::string& start) {
      test::LoadedScene s(turntable + "loads: {servo: " + load + "}\ninitial: {time: " + start + "}\n",
                          {"time={end: 1.15, output: 5}"});
      return s.position(s.run().back(), "axle");
    };
    const double there = moved("0.1");
    EXPECT_GT(std::abs(there), 0.01) << load;
    for (const char* start : {"0.01", "0.09", "0.0999999999999"}) EXPECT_NEAR(moved(start), there, 1e-9) << load;
  }
}

// Pulses of a constant effort between the zeros of s = x: all arcs are parabolas. From x = 0.5 at rest, −τ until
// x = off, then coasting at v = −√(2 τ/J (x₀ − off)) to x = −on, braking there and back, and so on between the two.
TEST(HingeRelay, switches_where_its_signal_says) {
  test::LoadedScene s(turntable + R"(loads:
  jets: {type: hinge-relay, hinge: axle, effort: 0.1, on: 0.1, off: 0.02}
initial: {hinges: {axle: {position: [0.5]}}}
events:
  off: {hinge: axle, value: 0.02, direction: down}
  reversed: {hinge: axle, value: -0.1, direction: down}
  turned: {hinge: axle, of: rate, direction: up}
)",
                      {"time.end=6"});
  s.run();
  const double a = 0.1 / 0.2;
  const double t_off = std::sqrt(2 * 0.48 / a), v = a * t_off, t_on = t_off + 0.12 / v, t_turn = t_on + v / a;
  ASSERT_GE(s.summary.events.size(), 3U);
  const std::vector<std::pair<const char*, double>> expected = {{"off", t_off}, {"reversed", t_on}, {"turned", t_turn}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(s.summary.events[i].name, expected[i].first);
    EXPECT_NEAR(s.summary.events[i].time, expected[i].second, 1e-9);
  }
  // Off, reversed, off, and on again at 4.6 s: each of the two passes levels on its way that switch nothing there.
  EXPECT_EQ(s.summary.switchings, 4U);
  EXPECT_LT(s.summary.energy_drift, 1e-9);
}

// Where it begins beyond a level it is on, to either side of what it holds: x = ±τ t²/(2 J) at first.
TEST(HingeRelay, is_on_at_once_on_the_side_of_its_target_where_it_begins) {
  for (const double target : {0.3, -0.3}) {
    test::LoadedScene s(turntable +
                            "loads: {jets: {type: hinge-relay, hinge: axle, effort: 0.1, on: 0.1, off: 0.02, target: " +
                            std::to_string(target) + "}}\n",
                        {"time.end=0.5"});
    EXPECT_NEAR(s.position(s.run().back(), "axle"), std::copysign(0.1 * 0.25 / 0.4, target), 1e-12);
  }
}

// s = x + T ẋ with T > 0 takes energy out until the motion is a limit cycle within the dead zone.
TEST(HingeRelay, with_a_rate_comes_to_rest_within_its_dead_zone) {
  test::LoadedScene s(turntable + R"(loads:
  jets: {type: hinge-relay, hinge: axle, effort: 0.1, on: 0.1, off: 0.02, rate_time: 1}
initial: {hinges: {axle: {position: [0.5]}}}
)",
                      {"time.end=60"});
  for (const State& state : s.run()) {
    if (state.time < 20) continue;
    EXPECT_LT(std::abs(s.position(state, "axle") + s.rate(state, "axle")), 0.1 + 1e-9);
  }
}

TEST(HingeRelay, conforms_to_the_suite) {
  const test::LoadedScene s(turntable);
  test::expect_load_conforms(*discrete_load("hinge-relay", {{"hinge", Value(std::string("axle"))},
                                                            {"component", Value(0.0)},
                                                            {"effort", Value(1.0)},
                                                            {"target", Value(0.0)},
                                                            {"rate_time", Value(0.0)},
                                                            {"on", Value(0.2)},
                                                            {"off", Value(0.1)}}),
                             *s.scene.model);
}

TEST(HingeRelay, without_hysteresis_is_refused) {
  EXPECT_THAT(test::problem_of(turntable + R"(loads:
  jets: {type: hinge-relay, hinge: axle, effort: 0.1, on: 0.1, off: 0.1}
)"),
              HasSubstr("not below 'on'"));
}

/// A hinge's column by its name is what `hinge` and `of` name: an event that does nothing is looked for beside the run.
TEST(Events, of_a_column_of_a_hinge_are_those_of_the_hinge) {
  const auto of = [](const std::string& watched) {
    test::LoadedScene s(turntable + "initial: {hinges: {axle: {rate: [1.5]}}}\nevents: {passed: {" + watched + "}}\n");
    s.run();
    EXPECT_EQ(s.scene.events.size(), 1U) << watched;
    EXPECT_EQ(s.summary.events.size(), 1U) << watched;
    return s.summary.events.empty() ? 0.0 : s.summary.events[0].time;
  };
  EXPECT_NEAR(of("signal: axle, value: 0.3"), 0.2, 1e-9);
  EXPECT_EQ(of("signal: axle, value: 0.3"), of("hinge: axle, value: 0.3"));
}

// A falling weight passes x = −½ g t²: known to the accuracy of the dense output, and known exactly where it stops.
TEST(Events, are_found_where_they_are_and_do_not_change_the_run) {
  const std::string falling = R"(format: withy/1
gravity: [0, 0, -9.81]
time: {end: 2, output: 0.5}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {weight: {type: rigid, mass: 1}}
hinges: {rail: {type: prismatic, axis: [0, 0, 1], parent: world, child: weight}}
)";
  test::LoadedScene plain(falling);
  const State undisturbed = plain.run().back();
  test::LoadedScene watched(falling + R"(events:
  fifth: {hinge: rail, value: -5, direction: down}
  never: {hinge: rail, value: -5, direction: up}
  fast: {hinge: rail, of: rate, value: -9.81}
)");
  EXPECT_EQ(watched.run().back().y, undisturbed.y);
  ASSERT_EQ(watched.summary.events.size(), 2U);
  EXPECT_EQ(watched.summary.events[0].name, "fast");
  EXPECT_NEAR(watched.summary.events[0].time, 1, 1e-9);
  EXPECT_NEAR(watched.summary.events[1].time, std::sqrt(2 * 5 / 9.81), 1e-9);
  EXPECT_EQ(watched.summary.events[1].direction, -1);

  test::LoadedScene stopped(falling + R"(events:
  fifth: {hinge: rail, value: -5, stop: true}
)");
  const State last = stopped.run().back();
  EXPECT_NEAR(last.time, std::sqrt(2 * 5 / 9.81), 1e-9);
  EXPECT_NEAR(stopped.position(last, "rail"), -5, 1e-9);
  EXPECT_EQ(stopped.summary.events.size(), 1U);
  EXPECT_THAT(stopped.summary.message, HasSubstr("The event 'fifth' ended the run"));
}

TEST(Events, of_hinges_that_are_not_there_are_bad_input) {
  EXPECT_THAT(test::problem_of(turntable + "events: {e: {hinge: axel}}\n"), HasSubstr("did you mean 'axle'"));
  EXPECT_THAT(test::problem_of(turntable + "events: {e: {hinge: axle, component: 1}}\n"), HasSubstr("no component 1"));
}

/// What a run remembers: samples, a relay, inputs, events, a beam.
const std::string busy_boom = R"(format: withy/1
time: {end: 2, output: 0.05}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}, damping_ratio: 0.01}
  turret: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
  ball: {type: spherical, parent: boom.tip, child: turret}
loads:
  control: {type: pd-controller, law: quintic, duration: 1.5, sample: 0.03, hinges: {axle: {to: 1, stiffness: 5, damping: 1}}}
  push: {type: hinge-effort, hinge: ball, component: 2, law: steps, table: [[0.2, 0.05], [0.9, 0]]}
  given: {type: input, frame: boom.tip, direction: [0, 1, 0], following: true}
  planned: {type: input, hinge: ball, component: 2, hold: linear, table: [[0.3, 0], [0.7, 0.02]]}
initial: {inputs: {given: 0.1}}
events:
  half: {hinge: axle, value: 0.5}
  back: {hinge: axle, of: rate, direction: down}
)";

struct InPieces {
  std::vector<State> outputs;
  RunSummary summary;
  std::size_t pieces = 0;
};

/// Runs the scene, saved and resumed after every seventh step.
InPieces run_in_pieces(const test::LoadedScene& s) {
  InPieces run;
  std::size_t saved_at = 0;
  std::optional<Checkpoint> stored;
  do {
    const std::optional<Checkpoint> resumed = stored;
    run.outputs.resize(saved_at);  // without the last state of the interrupted piece, which is no output of the whole
    RunOptions options;
    options.end = end_of_run(s.scene);
    options.output = s.scene.output;
    options.events = s.scene.events;
    options.resume = resumed ? &*resumed : nullptr;
    int steps = 0;
    options.interrupted = [&] { return steps++ == 7; };
    options.checkpoint = [&](const Checkpoint& c) {
      stored = c;
      saved_at = run.outputs.size();
    };
    run.summary = simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options,
                           [&](const State& state) { run.outputs.push_back(state); });
    ++run.pieces;
  } while (run.summary.status == RunStatus::interrupted && run.pieces < 10'000);
  return run;
}

void expect_same(const RunSummary& a, const RunSummary& b) {
  EXPECT_EQ(a.steps.evaluations, b.steps.evaluations);
  EXPECT_EQ(a.steps.rejected, b.steps.rejected);
  EXPECT_EQ(a.peak_effort, b.peak_effort);
  EXPECT_EQ(a.peak_deflection, b.peak_deflection);
  EXPECT_EQ(a.energy_drift, b.energy_drift);
  EXPECT_EQ(a.validity.samples, b.validity.samples);
  EXPECT_EQ(a.suspected_jumps, b.suspected_jumps);
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events[i].name, b.events[i].name);
    EXPECT_EQ(a.events[i].time, b.events[i].time);
  }
}

TEST(Checkpoints, let_a_run_go_on_bit_by_bit) {
  for (const char* integrator : {"{name: dopri5, rtol: 1e-6, atol: 1e-8}", "{name: rk4, step: 0.01}", "dop853",
                                 "rosenbrock-w", "imex", "rk4-adaptive"}) {
    test::LoadedScene s(busy_boom, {std::string("integrator=") + integrator});
    const std::vector<State> whole = s.run();
    EXPECT_FALSE(s.summary.events.empty());
    const InPieces run = run_in_pieces(s);
    EXPECT_GT(run.pieces, 4U) << integrator;
    ASSERT_EQ(run.outputs.size(), whole.size()) << integrator;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(run.outputs[i].time, whole[i].time);
      EXPECT_EQ(run.outputs[i].y, whole[i].y) << integrator << " at " << whole[i].time;
    }
    expect_same(run.summary, s.summary);
  }
}

}  // namespace
}  // namespace withy
