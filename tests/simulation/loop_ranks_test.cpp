/// \file
/// Loops whose equations say nothing that the tree does not say itself, or say it twice: the motion and what bears it
/// are those of equations that are needed.
#include <gmock/gmock.h>

#include <sstream>
#include <string>

#include "four_bar.hpp"

namespace withy::test {
namespace {

/// A door of 1.6 m times `size` and of mass `mass`, on a hinge whose axis stands askew. `carrier`: that of the body
/// which carries it, or empty. \param again a constraint at the door's top, on the axis of its hinge; or empty
std::string door(double size, double mass, const std::string& carrier, const std::string& again) {
  std::ostringstream text;
  text.precision(17);
  const auto list = [&](std::initializer_list<double> values, double unit) {
    const char* before = "[";
    for (const double value : values) {
      text << before << value * unit;
      before = ", ";
    }
    text << "]";
  };
  text << "format: withy/1\ngravity: ";
  list({carrier.empty() ? 0.5 : 0, carrier.empty() ? -9.81 : 0, 0}, size);
  text << "\ntime: {end: 1}\nintegrator: {name: dopri5, rtol: 1e-9, atol: 1e-12}\nbodies:\n";
  if (!carrier.empty()) {
    text << "  craft: {type: rigid, mass: " << 100 * mass << ", inertia: ";
    list({20, 30, 40, 0, 0, 0}, size * size * mass);
    text << ", frames: {up: {position: ";
    list({0.48, 0.32, 1.6}, size);
    text << "}}}\n";
  }
  text << "  door: {type: rigid, mass: " << 20 * mass << ", center_of_mass: ";
  list({0.4, 0.1, 0.9}, size);
  text << ", inertia: ";
  list({6, 7, 1.5, 0, 0, 0}, size * size * mass);
  text << ", frames: {top: {position: ";
  list({0.48, 0.32, 1.6}, size);
  text << "}}}\nhinges:\n";
  if (!carrier.empty()) text << "  float: {type: " << carrier << ", parent: world, child: craft}\n";
  text << "  low: {type: revolute, axis: [0.3, 0.2, 1], parent: " << (carrier.empty() ? "world" : "craft")
       << ", child: door}\n";
  if (!again.empty()) {
    text << "constraints:\n  high: {type: hinge, hinge: " << again << ", b: door.top, a: ";
    if (carrier.empty()) {
      text << "world, offset: {position: ";
      list({0.48, 0.32, 1.6}, size);
      text << "}}\n";
    } else {
      text << "craft.up}\n";
    }
  }
  text << "initial: {hinges: {low: {position: [0.3], rate: [1]}";
  if (carrier == "free") text << ", float: {rate: [0.2, 0.1, 0.3, 0, 0, 0]}";
  text << "}}\noutputs: {r: {type: reaction, hinge: low}}\n";
  return text.str();
}

// Five rows, of which rounding alone is left.
TEST(LoopRanks, ASecondHingeOnTheAxisOfTheFirstLeavesADoorAsItIs) {
  struct Size {
    double length, mass;
  };
  for (const char* carrier : {"", "free", "revolute, axis: [0, 0.4, 1]"}) {
    for (const Size& s : {Size{1, 1}, Size{1e-6, 1e-12}, Size{1e4, 1e9}}) {
      const Made once(door(s.length, s.mass, carrier, ""));
      const RunSummary wanted = run(once, 1);
      ASSERT_EQ(wanted.status, RunStatus::completed) << wanted.message;
      const std::vector<double> borne = read_sensors(once, wanted.final);
      double most = 0;
      for (const double value : borne) most = std::max(most, std::abs(value));
      for (const char* again : {"revolute, axis: [0.3, 0.2, 1]", "spherical", "cylindrical, axis: [0.3, 0.2, 1]"}) {
        SCOPED_TRACE(std::string(again) + " on '" + carrier + "', " + std::to_string(s.length) + " times as long");
        const Made twice(door(s.length, s.mass, carrier, again));
        const ClosedLoops& loops = loops_of(*twice.equations);
        Work work = twice.equations->make_work();
        EXPECT_EQ(loops.counts(twice.scene.initial.y, work).at(0).independent, 0U);
        EXPECT_EQ(loops.rank_at(twice.scene.initial.y, work).distinct, 0U);
        const RunSummary found = run(twice, 1);
        ASSERT_EQ(found.status, RunStatus::completed) << found.message;
        const std::size_t low = twice.scene.model->layout().hinge("low")->position;
        EXPECT_NEAR(found.final.y[low], wanted.final.y[low], 1e-8);
        const std::vector<double> shared = read_sensors(twice, found.final);
        for (std::size_t i = 0; i < borne.size(); ++i) EXPECT_NEAR(shared[i], borne[i], 1e-6 * most) << i;
      }
    }
  }
}

// What a loop's rows have in common with speeds that a motion prescribes moves nothing either.
TEST(LoopRanks, ADrivenDoorOnAFreeCraftMayHaveASecondHinge) {
  std::string text = door(1, 1, "free", "revolute, axis: [0.3, 0.2, 1]");
  text = replaced(text, "low: {position: [0.3], rate: [1]}, ", "");
  text = replaced(text, "outputs:", "motions: {turn: {hinge: low, type: constant-rate, rate: 1, from: 0.3}}\noutputs:");
  const Made made(text);
  const RunSummary summary = run(made, 1);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  for (const double value : read_sensors(made, summary.final)) EXPECT_LT(std::abs(value), 1e4);
}

/// A parallelogram whose cranks both have motions that agree: of the two equations in its plane one is needed.
std::string driven_twice(const std::string& motions, const std::string& turned) {
  std::string text = four_bar(rigid_coupler, "{name: dopri5, rtol: 1e-9, atol: 1e-11}");
  text = replaced(text, "frames: {pin: {position: [0.8, 0, 0]}}", "frames: {pin: {position: [0.3, 0, 0]}}");
  text = replaced(text, "offset: {position: [0.9, 0, 0]}", "offset: {position: [1.0, 0, 0]}");
  text = replaced(text, "b: rocker.pin}",
                  "b: rocker.pin, offset: {orientation: {axis: [0, 0, 1], angle: " + turned + "}}}");
  text = text.substr(0, text.find("loads:"));
  return text + "motions:\n" + motions + R"(outputs:
  drive: {type: effort, hinge: motor}
  base: {type: reaction, hinge: motor}
  second_drive: {type: effort, hinge: pivot}
  second_base: {type: reaction, hinge: pivot}
initial: {guess: {hinges: {elbow: {position: [-1.2]}}}}
)";
}

// How a constraint's frame is turned about its axis changes nothing, and what drives a hinge is what the hinge bears.
TEST(LoopRanks, EffortsOfMotionsThatShareALoadAreThoseOfTheLeastMultipliers) {
  const std::string turn =
      "  one: {hinge: motor, type: constant-rate, rate: 1, from: 1.2}\n"
      "  other: {hinge: pivot, type: constant-rate, rate: 1, from: 1.2}\n";
  const std::string sway =
      "  one: {hinge: motor, type: expression, value: 1.2 + 0.4 * sin(6 * t)}\n"
      "  other: {hinge: pivot, type: expression, value: 1.2 + 0.4 * sin(6 * t)}\n";
  for (const std::string& motions : {turn, sway}) {
    std::vector<double> straight;
    for (const char* turned : {"0", "0.5", "-0.8"}) {
      SCOPED_TRACE(motions + turned);
      const Made made(driven_twice(motions, turned));
      const RunSummary summary = run(made, 0.5);
      ASSERT_EQ(summary.status, RunStatus::completed) << summary.message;
      const std::vector<double> values = read_sensors(made, summary.final);
      EXPECT_NEAR(values[0], values[6], 1e-8 * (1 + std::abs(values[0])));
      EXPECT_NEAR(values[7], values[13], 1e-8 * (1 + std::abs(values[7])));
      EXPECT_GT(std::abs(values[0]), 1e-2);
      if (straight.empty()) straight = values;
      for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], straight[i], 1e-6) << i;
      EXPECT_LT(summary.energy_drift, 1e-6);
    }
  }
}

}  // namespace
}  // namespace withy::test
