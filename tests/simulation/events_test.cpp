#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "withy/tests/simulation/oscillator.hpp"

namespace withy {
namespace {

using testing::HasSubstr;

double oscillation(double, double q, double) { return -q; }

// q = 0.1 cos t falls through zero at π/2; functions of other sizes and signs pass with it, an angle before and one
// after it.
std::vector<RunEvent> events_at_once(bool second_stop) {
  return {{"plain", [](double, std::span<const double> y) { return y[1]; }, 0, false},
          {"stop", [](double, std::span<const double> y) { return 3 * y[1]; }, 0, true},
          {"mirrored", [](double, std::span<const double> y) { return -1e-3 * y[1]; }, 1, second_stop},
          {"bent", [](double, std::span<const double> y) { return std::sin(y[1]) + y[1] * y[1]; }, 0, false},
          {"upward alone", [](double, std::span<const double> y) { return y[1]; }, 1, false},
          {"before", [](double, std::span<const double> y) { return y[1] - 1e-3; }, 0, false},
          {"after", [](double, std::span<const double> y) { return y[1] + 1e-3; }, 0, false}};
}

TEST(Events, at_one_time_are_each_reported_once_in_any_order_of_the_file) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, oscillation);
  for (const bool second_stop : {false, true}) {
    std::vector<RunEvent> events = events_at_once(second_stop);
    std::vector<std::size_t> order(events.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (int permutation = 0; permutation < 200; ++permutation) {
      // Every order is far too many; each of these differs from the last in many places.
      for (int k = 0; k < 23; ++k) std::next_permutation(order.begin(), order.end());
      RunOptions options = until(10, 0.5);
      for (const std::size_t i : order) options.events.push_back(events[i]);
      Runner run(options);
      const RunSummary summary = run(model, equations, boom_state(0, 0.1));
      EXPECT_EQ(summary.status, RunStatus::completed);
      EXPECT_NEAR(summary.final.time, std::numbers::pi / 2, 1e-8);
      std::vector<std::string> names;
      for (const EventTime& e : summary.events) {
        names.push_back(e.name);
        EXPECT_LE(e.time, summary.final.time);
        EXPECT_NEAR(e.time, std::numbers::pi / 2 - (e.name == "before" ? std::asin(0.01) : 0), 1e-8) << e.name;
        EXPECT_EQ(e.direction, e.name == "mirrored" ? 1 : -1) << e.name;
      }
      EXPECT_EQ(names.front(), "before");
      std::sort(names.begin(), names.end());
      EXPECT_EQ(names, (std::vector<std::string>{"before", "bent", "mirrored", "plain", "stop"}));
      EXPECT_THAT(summary.message, HasSubstr("'stop'"));
      EXPECT_EQ(summary.message.find("'mirrored'") != std::string::npos, second_stop) << summary.message;
    }
  }
}

TEST(Events, that_do_not_stop_are_reported_once_at_every_passage) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, oscillation);
  std::vector<RunEvent> events = events_at_once(false);
  events.erase(events.begin() + 1);
  RunOptions options = until(10, 0.5);
  options.events = events;
  Runner run(options), unwatched(until(10, 0.5));
  const RunSummary summary = run(model, equations, boom_state(0, 0.1));
  // Zeros at π/2, 3π/2, 5π/2: three of "plain" and "bent", two of "mirrored" upward, one of "upward alone".
  const auto count = [&](const std::string& name) {
    return std::count_if(summary.events.begin(), summary.events.end(),
                         [&](const EventTime& e) { return e.name == name; });
  };
  EXPECT_EQ(count("plain"), 3);
  EXPECT_EQ(count("bent"), 3);
  EXPECT_EQ(count("mirrored"), 2);
  EXPECT_EQ(count("upward alone"), 1);
  EXPECT_EQ(unwatched(model, equations, boom_state(0, 0.1)).final.y, summary.final.y) << "they do not change the run";
}

}  // namespace
}  // namespace withy
