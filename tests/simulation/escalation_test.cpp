// Formulation `auto`: the least formulation that the motion allows, changed where an indicator passes its limit.
#include "withy/core/simulation/escalation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "withy/core/simulation/validity_limits.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

/// A beam with first frequency 3.516 √(20/1) = 15.7 rad/s on an axle that is spun up in one second.
std::string spun_up(double rate) {
  return "format: withy/1\ntime: {end: 1.5, output: 0.01}\nbodies:\n  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, "
         "0, "
         "0, 0]}\n  beam: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 20, modes: 2}}\nhinges:\n"
         "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
         "  root: {type: weld, parent: hub, child: beam}\nmotions:\n  spin: {type: spin-up, hinge: axle, rate: " +
         std::to_string(rate) + ", duration: 1}\n";
}

struct Ladder {
  explicit Ladder(const std::string& text) : made(text) {
    for (const char* id : {"ruthless", "quadratic", "exact"}) {
      equations.push_back(made.in(id));
      rungs.push_back({id, make_plugin<Formulation>(made.registry, id)->terms(), equations.back().get()});
    }
    options.end = *made.scene.end;
    options.output = made.scene.output;
  }
  EscalatedRun run() {
    outputs.clear();
    of.clear();
    return simulate_escalating(*made.scene.model, rungs, *made.scene.integrator, made.scene.initial, options,
                               [&](const State& s, std::size_t rung) {
                                 outputs.push_back(s);
                                 of.push_back(rung);
                               });
  }
  Made made;
  std::vector<std::unique_ptr<EquationsOfMotion>> equations;
  std::vector<Rung> rungs;
  RunOptions options;
  std::vector<State> outputs;
  std::vector<std::size_t> of;
};

TEST(Escalation, slow_motion_stays_in_the_first_formulation_bit_by_bit) {
  Ladder l(spun_up(1));
  const EscalatedRun run = l.run();
  ASSERT_EQ(run.stretches.size(), 1U);
  EXPECT_EQ(run.stretches[0].rung, 0U);
  EXPECT_EQ(run.discarded_evaluations, 0U);
  const RunSummary plain =
      simulate(*l.made.scene.model, *l.equations[0], *l.made.scene.integrator, l.made.scene.initial, l.options, {});
  EXPECT_EQ(run.summary.final.y, plain.final.y);
  EXPECT_EQ(run.summary.steps.evaluations, plain.steps.evaluations);
}

TEST(Escalation, hands_over_before_an_output_is_past_a_limit) {
  Ladder l(spun_up(8));
  const EscalatedRun run = l.run();
  ASSERT_EQ(run.stretches.size(), 2U);
  EXPECT_EQ(run.stretches[0].rung, 0U);
  EXPECT_EQ(run.stretches[1].rung, 1U);
  EXPECT_EQ(run.stretches[0].end, run.stretches[1].start);
  EXPECT_EQ(run.stretches[1].end, l.options.end);
  ASSERT_FALSE(run.stretches[0].excess.empty());
  for (const Excess& e : run.stretches[0].excess) {
    EXPECT_GT(e.value, e.limit);
    EXPECT_EQ(e.body, "beam");
    EXPECT_NEAR(e.time, run.stretches[0].end + l.options.output, 1e-12) << "the first output that is past a limit";
  }
  LimitWatch watch(*l.made.scene.model);
  std::size_t ruthless = 0;
  for (std::size_t i = 0; i < l.outputs.size(); ++i) {
    if (i > 0) {
      EXPECT_GT(l.outputs[i].time, l.outputs[i - 1].time);
    }
    if (l.of[i] != 0) continue;
    ++ruthless;
    EXPECT_TRUE(watch.excess(l.outputs[i], l.rungs[0], l.rungs[0].terms).empty()) << l.outputs[i].time;
  }
  EXPECT_GT(ruthless, 10U);
  EXPECT_EQ(l.outputs.size(), 151U) << "every output once";
}

TEST(Escalation, the_state_goes_over_as_it_is) {
  Ladder l(spun_up(8));
  const EscalatedRun run = l.run();
  ASSERT_EQ(run.stretches.size(), 2U);
  RunOptions first = l.options;
  first.end = run.stretches[0].end;
  const Model& model = *l.made.scene.model;
  const Integrator& integrator = *l.made.scene.integrator;
  const RunSummary before = simulate(model, *l.equations[0], integrator, l.made.scene.initial, first, {});
  const RunSummary after = simulate(model, *l.equations[1], integrator, before.final, l.options, {});
  EXPECT_EQ(run.summary.final.y, after.final.y);
  EXPECT_EQ(run.summary.steps.accepted, before.steps.accepted + after.steps.accepted);
  EXPECT_GE(run.summary.peak_deflection_ratio.at("beam"), after.peak_deflection_ratio.at("beam"));
}

TEST(Escalation, the_same_input_gives_the_same_bits) {
  Ladder one(spun_up(8)), two(spun_up(8));
  const EscalatedRun a = one.run(), b = two.run();
  EXPECT_EQ(a.summary.final.y, b.summary.final.y);
  EXPECT_EQ(a.discarded_evaluations, b.discarded_evaluations);
  ASSERT_EQ(one.outputs.size(), two.outputs.size());
  for (std::size_t i = 0; i < one.outputs.size(); ++i) EXPECT_EQ(one.outputs[i].y, two.outputs[i].y);
}

/// The spin-up's rate is smooth and increasing, so an angle and a rate of the axle are each passed once.
TEST(Escalation, events_are_those_of_what_is_kept) {
  const std::string events = "events:\n  early: {hinge: axle, of: rate, value: 0.5}\n  late: {hinge: axle, value: 5}\n";
  Ladder l(spun_up(8) + events);
  l.options.events = l.made.scene.events;
  const EscalatedRun run = l.run();
  ASSERT_EQ(run.stretches.size(), 2U);
  ASSERT_EQ(run.summary.events.size(), 2U) << "none twice, though part of the run is made twice";
  EXPECT_EQ(run.summary.events[0].name, "early");
  EXPECT_LT(run.summary.events[0].time, run.stretches[0].end);
  EXPECT_EQ(run.summary.events[1].name, "late");
  EXPECT_GT(run.summary.events[1].time, run.stretches[1].start);
  // The axle is driven: the times are those of any formulation.
  RunOptions options = l.options;
  const RunSummary plain =
      simulate(*l.made.scene.model, *l.equations[1], *l.made.scene.integrator, l.made.scene.initial, options, {});
  ASSERT_EQ(plain.events.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(run.summary.events[i].time, plain.events[i].time, 1e-6);
}

TEST(Escalation, an_event_that_stops_ends_the_run_in_whichever_stretch_it_is) {
  for (const double rate : {0.5, 7.9}) {
    Ladder l(spun_up(8) + "events:\n  there: {hinge: axle, of: rate, value: " + std::to_string(rate) +
             ", stop: true}\n");
    l.options.events = l.made.scene.events;
    const EscalatedRun run = l.run();
    EXPECT_EQ(run.stretches.size(), rate < 1 ? 1U : 2U);
    EXPECT_EQ(run.summary.status, RunStatus::completed);
    ASSERT_EQ(run.summary.events.size(), 1U);
    EXPECT_EQ(run.summary.final.time, run.summary.events[0].time);
    EXPECT_EQ(run.stretches.back().end, run.summary.events[0].time);
    EXPECT_EQ(l.outputs.back().time, run.summary.events[0].time);
  }
}

TEST(Escalation, what_cannot_be_handed_over_is_refused) {
  Ladder l(spun_up(8));
  l.options.checkpoint = [](const Checkpoint&) {};
  EXPECT_THROW(l.run(), std::invalid_argument);
  Ladder sampled(
      "format: withy/1\ntime: {end: 1}\nbodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\nhinges: "
      "{axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}\nloads:\n  control: {type: "
      "pd-controller, law: constant, sample: 0.03, hinges: {axle: {to: 0.5, stiffness: 5, damping: 0.4}}}\n");
  EXPECT_THROW(sampled.run(), std::invalid_argument);
}

/// Weight along the beam's y bends it by ρg/8EI = 0.61 of its length, statically.
TEST(Escalation, great_deflections_go_to_exact_kinematics) {
  Ladder l(
      "format: withy/1\ntime: {end: 1, output: 0.01}\ngravity: [0, -9.81, 0]\nbodies:\n  beam: {type: beam, length: 1, "
      "mass_per_length: 1, bending_y: {stiffness: 2, modes: 2}}\nhinges:\n  root: {type: weld, parent: world, child: "
      "beam}\n");
  const EscalatedRun run = l.run();
  ASSERT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
  EXPECT_EQ(run.stretches.back().rung, 2U);
  const auto& last_left = run.stretches[run.stretches.size() - 2];
  EXPECT_EQ(last_left.excess.front().indicator, "deflection over length");
  EXPECT_EQ(last_left.excess.front().limit, deflection_limit);
}

TEST(Escalation, what_is_past_its_limit_at_the_start_begins_higher) {
  Ladder l(spun_up(8));
  // 8 rad/s at the start: half of the first frequency.
  Made fast(
      "format: withy/1\ntime: {end: 0.2, output: 0.01}\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 1, "
      "bending_y: {stiffness: 20, modes: 2}}\nhinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: "
      "beam}\ninitial: {hinges: {axle: {rate: [8]}}}\n");
  const auto ruthless = fast.in("ruthless"), quadratic = fast.in("quadratic");
  const std::vector<Rung> rungs = {{"ruthless", l.rungs[0].terms, ruthless.get()},
                                   {"quadratic", l.rungs[1].terms, quadratic.get()}};
  RunOptions options;
  options.end = 0.2;
  const EscalatedRun run =
      simulate_escalating(*fast.scene.model, rungs, *fast.scene.integrator, fast.scene.initial, options, {});
  ASSERT_EQ(run.stretches.size(), 2U);
  EXPECT_EQ(run.stretches[0].end, run.stretches[0].start);
  const RunSummary plain =
      simulate(*fast.scene.model, *quadratic, *fast.scene.integrator, fast.scene.initial, options, {});
  EXPECT_EQ(run.summary.final.y, plain.final.y);
}

}  // namespace
}  // namespace withy::test
