/// \file
/// Loads of the states in which most happens, against those of all accepted states.
#include "withy/core/simulation/busiest_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/step_watch.hpp"
#include "withy/tests/simulation/cantilever.hpp"

namespace withy::test {
namespace {

/// Loads over buckling loads at every accepted state of a run.
class EveryLoad : public StepWatch {
 public:
  explicit EveryLoad(const Made& m)
      : m_(m),
        motion_(*m.scene.model),
        felt_(*m.scene.model, *m.equations),
        rates_(m.equations->size()),
        work_(m.equations->make_work()) {
    for (std::size_t b = 0; b < m.scene.model->bodies().size(); ++b)
      if (m.scene.model->layout().modes(b) != nullptr) stiffness_.emplace_back(*m.scene.model, b);
    greatest.resize(stiffness_.size());
  }
  void begin_at(const State& state) override { look(state); }
  void observe(const Stepper& stepper) override { look(stepper.state()); }
  void remember(Memory& /*memory*/) override {}
  std::vector<double> greatest;  ///< of each flexible body

 private:
  void look(const State& state) {
    const Layout& layout = m_.scene.model->layout();
    ASSERT_TRUE(m_.equations->derivatives(state.time, state.y, rates_, work_).ok());
    motion_.update(state.y, std::span<const double>(rates_).subspan(layout.positions, layout.speeds));
    felt_.update(state, motion_.bodies());
    for (std::size_t i = 0; i < stiffness_.size(); ++i)
      greatest[i] = std::max(greatest[i], stiffness_[i].evaluate(felt_.bodies(), felt_.at_frames()).size());
  }
  const Made& m_;
  TreeMotion motion_;
  FeltMotion felt_;
  std::vector<MotionStiffness> stiffness_;
  std::vector<double> rates_;
  Work work_;
};

// A latch that strikes, torques that switch, a thruster that fires: loads that are there for some steps. Samples alone
// found 0.4 to 0.7 of them. What is between two looks may be missed, so they need not be the greatest of all steps.
TEST(BusiestState, loads_are_those_of_the_states_in_which_most_happens) {
  for (const char* file : {"boom-latch", "least-time-slew", "thruster"}) {
    SCOPED_TRACE(file);
    std::ifstream text(std::string(WITHY_SOURCE_DIRECTORY) + "/scenes/" + file + ".yaml");
    Made m(std::string(std::istreambuf_iterator<char>(text), {}), "linear");
    RunOptions options;
    options.end = end_of_run(m.scene);
    options.output = options.end;
    options.events = m.scene.events;
    EveryLoad every(m);
    const RunSummary summary =
        simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {}, &every);
    ASSERT_EQ(summary.validity.bodies.size(), every.greatest.size());
    for (std::size_t i = 0; i < every.greatest.size(); ++i) {
      const BodyValidity& b = summary.validity.bodies[i];
      EXPECT_GE(b.load.size(), 0.75 * every.greatest[i]) << b.name;
      EXPECT_LE(b.load.size(), every.greatest[i]) << b.name;
    }
  }
}

// Two coordinates in units 2⁶⁰ apart, each with a stroke of its own; the same of them is found in any units, and after
// a checkpoint. What a jump of the speeds looks like is no acceleration.
TEST(BusiestState, is_where_a_coordinate_is_struck_in_any_units) {
  const auto at = [](double t, double unit) {
    const auto stroke = [t](double when) { return std::exp(-std::pow((t - when) / 0.05, 2)); };
    return State{t, {std::cos(t) + 0.2 * stroke(3), unit * (std::sin(t) + 0.5 * stroke(7))}};
  };
  const auto strokes = [&](double unit, int saved) {
    std::vector<double> found;
    BusiestState busiest(0, 2, 2);
    busiest.begin_at(at(0, unit));
    for (int i = 1; i <= 1000; ++i) {
      busiest.observe(at(0.01 * i, unit));
      if (i == saved) {
        Memory written;
        busiest.remember(written);
        Memory read(written.numbers());
        busiest = BusiestState(0, 2, 2);
        busiest.remember(read);
      }
      if (i % 250 != 0 || busiest.found() == nullptr) continue;
      found.push_back(busiest.found()->time);
      busiest.look_taken();
    }
    return found;
  };
  const std::vector<double> found = strokes(1, 0);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NEAR(found[1], 3, 0.1);
  EXPECT_NEAR(found[2], 7, 0.1);
  EXPECT_EQ(strokes(0x1p60, 0), found);
  EXPECT_EQ(strokes(1, 299), found);

  BusiestState jumped(0, 1, 1);
  jumped.begin_at({0, {-50}});
  for (int i = 1; i <= 20; ++i) {
    if (i == 10) jumped.begin_at({0.1 * (i - 1), {50}});
    jumped.observe({0.1 * i, {i < 10 ? -50.0 : i < 15 ? 50.0 : 49.0}});
  }
  ASSERT_NE(jumped.found(), nullptr);
  EXPECT_NEAR(jumped.found()->time, 1.45, 0.06) << "where it is slowed down, not where it jumped";
}

}  // namespace
}  // namespace withy::test
