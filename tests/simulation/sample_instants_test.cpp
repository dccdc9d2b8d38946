/// \file
/// When controllers take their samples: at one instant where times are apart by rounding alone, and once.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "acted_run.hpp"
#include "withy/core/simulation/session.hpp"

namespace withy {
namespace {

using test::ActedRun;
using test::Made;

std::string wheel(const std::string& rest) {
  return R"(format: withy/1
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
)" + rest;
}

/// A decimal number, not a product.
std::string tenths(int count) { return std::to_string(count / 10) + "." + std::to_string(count % 10); }

// What it measured a sample ago acts: none of the effort of the first sample may come within its own period.
TEST(SampleInstants, a_run_that_begins_at_one_samples_there_once) {
  const auto moved = [](int start) {
    return ActedRun(wheel("time: {output: 10, end: " + tenths(start + 10) + "5}\ninitial: {time: " + tenths(start) +
                          "}\nloads:\n  servo: {type: pid, hinge: axle, proportional: 2, integral: 5, derivative: 1, "
                          "reference: 1, sample: 0.1, delay: 0.1}\n"));
  };
  const ActedRun first = moved(0);
  const double from_zero = first.position("axle", first.summary.final);
  EXPECT_GT(from_zero, 0.1);
  for (int start = 1; start < 30; ++start) {
    const ActedRun later = moved(start);
    EXPECT_NEAR(later.position("axle", later.summary.final), from_zero, 1e-9) << tenths(start) << " s";
  }
}

// Both samples come at once, and the second controller sees the effort that was held until then.
TEST(SampleInstants, controllers_of_two_periods_see_what_was_until_then_wherever_their_samples_meet) {
  for (int meeting = 3; meeting <= 30; meeting += 3) {
    const ActedRun run(wheel("time: {output: 10, end: " + tenths(meeting) + R"(5}
outputs: {effort: {type: effort, hinge: axle}}
loads:
  push: {type: expression, hinge: axle, value: t, sample: 0.3}
  seen: {type: quantizer, of: effort, step: 0.001, range: 10, sample: 0.1}
)"));
    const LoadNode& seen = run.scene.model->loads()[1];
    EXPECT_NEAR(seen.discrete(std::span(run.summary.final.y)).back(), 0.1 * (meeting - 3), 1e-9)
        << tenths(meeting) << " s";
  }
}

/// The row of a table of tenths at one of them.
const State& row_at(const ActedRun& run, int count) { return run.outputs.at(static_cast<std::size_t>(count)); }

// Rows are multiples of 0.1, 0.30000000000000004 among them; the events' times and the samples are decimals, or
// multiples of another number.
TEST(SampleInstants, rows_there_show_what_was_until_then_whichever_rounding_leaves_first) {
  for (int at = 1; at < 30; ++at) {
    const ActedRun run(
        wheel("time: {output: 0.1, end: 3}\ninitial: {hinges: {axle: {rate: [1]}}}\nevents: {stop: {at: " + tenths(at) +
              ", do: {lock: axle}}}\n"));
    EXPECT_EQ(run.rate("axle", row_at(run, at)), 1.0) << tenths(at) << " s";
    EXPECT_EQ(run.rate("axle", row_at(run, at + 1)), 0.0) << tenths(at) << " s";
  }
  const ActedRun run(wheel(R"(time: {output: 0.1, end: 3}
loads: {law: {type: expression, hinge: axle, value: t, sample: 0.3}}
)"));
  const LoadNode& law = run.scene.model->loads()[0];
  for (int at = 3; at < 30; at += 3) {
    const auto held = [&](int row) { return law.discrete(std::span(row_at(run, row).y)).back(); };
    EXPECT_NEAR(held(at), 0.1 * (at - 3), 1e-12) << tenths(at) << " s";
    EXPECT_NEAR(held(at + 1), 0.1 * at, 1e-12) << tenths(at) << " s";
  }
}

TEST(SampleInstants, a_resumed_run_gives_the_rows_there_once) {
  const Made made(wheel(R"(time: {output: 0.1, end: 1}
initial: {hinges: {axle: {rate: [1]}}}
loads: {law: {type: expression, hinge: axle, value: t, sample: 0.3}}
events: {stop: {at: 0.7, do: {lock: axle}}}
)"));
  const auto rows = [&](std::size_t save_at, const Checkpoint* resume, std::optional<Checkpoint>& saved) {
    std::vector<State> all;
    RunOptions options;
    options.end = 1;
    options.output = 0.1;
    options.resume = resume;
    std::size_t asked = 0;
    options.checkpoint_due = [&] { return ++asked == save_at; };
    options.checkpoint = [&](const Checkpoint& c) {
      if (!saved) saved = c;  // an interrupted run makes another where it stops
    };
    options.interrupted = [&] { return saved.has_value(); };
    const auto keep = [&](const State& s) {
      if (!saved) all.push_back(s);
    };
    static_cast<void>(
        simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options, keep));
    return all;
  };
  std::optional<Checkpoint> none;
  const std::vector<State> whole = rows(0, nullptr, none);
  ASSERT_EQ(whole.size(), 11U);
  for (std::size_t step = 1;; ++step) {
    std::optional<Checkpoint> saved;
    std::vector<State> both = rows(step, nullptr, saved);
    if (!saved) break;
    const std::vector<State> rest = rows(0, &*saved, none);
    both.insert(both.end(), rest.begin(), rest.end());
    ASSERT_EQ(both.size(), whole.size()) << step;
    for (std::size_t i = 0; i < both.size(); ++i) {
      EXPECT_EQ(both[i].time, whole[i].time) << step;
      EXPECT_EQ(both[i].y, whole[i].y) << step;
    }
  }
}

// As the table's last row and a host see it: what is from the sample on.
TEST(SampleInstants, a_run_and_a_session_that_end_at_one_have_taken_it) {
  const auto controlled = [](int end) {
    return wheel("time: {output: 10, end: " + tenths(end) +
                 "}\nloads: {law: {type: expression, hinge: axle, value: t, sample: 0.1}}\n");
  };
  const Made made(controlled(30));
  Session session(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, {});
  const LoadNode& law = made.scene.model->loads()[0];
  for (int k = 1; k < 30; ++k) {
    const ActedRun run(controlled(k));
    EXPECT_NEAR(law.discrete(std::span(run.summary.final.y)).back(), 0.1 * k, 1e-12) << tenths(k) << " s";
    EXPECT_EQ(run.summary.final.time, std::stod(tenths(k)));
    ASSERT_TRUE(session.advance(std::stod(tenths(k)), false).reached);
    EXPECT_NEAR(law.discrete(std::span(session.state().y)).back(), 0.1 * k, 1e-12) << tenths(k) << " s, a session";
  }
}

// Its commands come by a delay of two samples after what they are made of: what is switched on a tenth of a millisecond
// before the sample takes it all the same.
TEST(SampleInstants, a_controller_switched_on_at_one_has_its_commands_as_one_switched_on_just_before) {
  const auto moved = [](const std::string& on) {
    const ActedRun run(
        wheel("time: {output: 10, end: 1.95}\ninitial: {hinges: {axle: {position: 1}}}\n"
              "loads: {servo: {type: pid, hinge: axle, proportional: 4, derivative: 2, sample: 0.1, "
              "delay: 0.2}}\nevents:\n  off: {at: 0.03, do: {switch_off: servo}}\n  on: {at: " +
              on + ", do: {switch_on: servo}}\n"));
    return run.position("axle", run.summary.final);
  };
  for (const std::string sample : {"0.9", "1.0", "1.1", "1.2", "1.3"}) {
    const double at_once = moved(sample);
    EXPECT_GT(std::abs(at_once - 1), 0.05) << sample;
    // At rest while it is off, so that both measure the same.
    const std::string before = std::to_string(std::stod(sample) - 1e-4);
    EXPECT_NEAR(at_once, moved(before), 1e-9) << sample;
  }
}

}  // namespace
}  // namespace withy
