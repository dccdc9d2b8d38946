/// \file
/// Integrators of plugins that do not keep what Stepper::step promises: a run ends with a message, and does not hang.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/session.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/stop.hpp"
#include "withy/tests/simulation/made_scene.hpp"
#include "withy/tests/simulation/wrapped_steps.hpp"

namespace withy::test {
namespace {

constexpr const char* pendulum =
    "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 1, center_of_mass: [1, 0, 0], inertia: [0.1, "
    "0.1, "
    "0.1, 0, 0, 0]}}\nhinges: {r: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n";

/// Says that a step is done and stays where it is.
class Standing final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { return {}; }
};
/// Goes on past the time that it is given.
class Passing final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double t_limit) override { return WrappedSteps::step(t_limit + 0.01); }
};

/// Throws in a step, or where it is asked between its steps.
class Throwing final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { throw std::runtime_error("out of order"); }
};
class ThrowingNumber final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { throw 3; }
};
class Opaque final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  void interpolate(double, std::span<double>) const override { throw std::logic_error("nothing is known inside"); }
};
/// Ends with an outcome that there is not.
class Undecided final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { return {static_cast<StepResult::Outcome>(99)}; }
};
/// Has numbers at the ends of its steps alone.
class Hollow final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  void interpolate(double, std::span<double> y) const override {
    std::fill(y.begin(), y.end(), std::numeric_limits<double>::quiet_NaN());
  }
};
/// Blames a body that there is not.
class Blaming final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { return {StepResult::Outcome::singular, 77}; }
};
/// Steps with a state of its own, which it changes to what a test asks for.
class OwnState : public WrappedSteps {
 public:
  explicit OwnState(std::unique_ptr<Stepper> own) : WrappedSteps(std::move(own)), state_(WrappedSteps::state()) {}
  const State& state() const override { return state_; }

 protected:
  State state_;
};
class Shrinking final : public OwnState {
 public:
  using OwnState::OwnState;
  StepResult step(double t_limit) override {
    state_.time = t_limit;
    state_.y.resize(1);
    return {};
  }
};
/// Gains the least that a number can, and does not count its steps.
class Creeping final : public OwnState {
 public:
  using OwnState::OwnState;
  StepResult step(double /*t_limit*/) override {
    state_.time = std::nextafter(state_.time, 1e9);
    return {};
  }
  void interpolate(double, std::span<double> y) const override {
    std::copy(state_.y.begin(), state_.y.end(), y.begin());
  }
};
/// Makes its first coordinate no number.
class Losing final : public OwnState {
 public:
  using OwnState::OwnState;
  StepResult step(double t_limit) override {
    state_.time = t_limit;
    state_.y[0] = std::numeric_limits<double>::quiet_NaN();
    return {};
  }
  void interpolate(double, std::span<double> y) const override {
    std::copy(state_.y.begin(), state_.y.end(), y.begin());
  }
};

/// Stays where it is when it is sent elsewhere.
class Stubborn final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  void jump(const State& /*state*/) override {}
};

/// Ends at the next number after the one that it is given, as sums of steps do.
class Rounding final : public OwnState {
 public:
  using OwnState::OwnState;
  StepResult step(double t_limit) override {
    state_.time = std::nextafter(t_limit, 1e9);
    return {};
  }
};

/// Goes where it is sent but for its first rate.
class Careless final : public WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  void jump(const State& state) override {
    State other = state;
    other.y[1] += 0.25;
    WrappedSteps::jump(other);
  }
};

/// A pendulum at an angle, run by these steps to 1 s.
/// \param rest of its scene
template <class Steps>
RunSummary run_by(const std::string& rest = {}) {
  Made made(pendulum + rest);
  made.scene.integrator = std::make_shared<WrappedIntegrator<Steps>>(made.scene.integrator);
  RunOptions options;
  options.end = 1;
  return simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options,
                  [](const State&) {});
}

template <class Steps>
std::string message_of_a_run(const std::string& rest = {}) {
  try {
    run_by<Steps>(rest);
  } catch (const PluginError& e) {
    return e.what();
  }
  return "it ran";
}

/// What an integrator is, of which one thing is not as it should be.
class Wrong final : public Integrator {
 public:
  explicit Wrong(std::string fault) : fault_(std::move(fault)) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion&, const State&) const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    return nullptr;
  }
  int order() const override { return 1; }
  std::optional<double> stability_limit() const override {
    if (fault_ == "limit") return -1.0;
    if (fault_ == "throws-limit") throw std::runtime_error("no limit known");
    return {};
  }

 private:
  std::string fault_;
};

std::string start_of(const std::string& fault) {
  const Made made(pendulum);
  try {
    static_cast<void>(start_stepper(Wrong(fault), *made.equations, made.scene.initial, "integrator 'mine'"));
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "it began";
}

TEST(WrongSteps, ThatStandStillEndARun) {
  EXPECT_THAT(message_of_a_run<Standing>(), testing::HasSubstr("says of a step that it is done, which began at 0"));
}
TEST(WrongSteps, ThatMissTheLastDigitAreToldWithAllOfThem) {
  EXPECT_THAT(message_of_a_run<Rounding>(),
              testing::HasSubstr("was to end at 1 s at the latest, and ended at 1.0000000000000002 s, 2.22e-16 s too "
                                 "late: no result"));
}
TEST(WrongSteps, ThatGoTooFarEndARun) { EXPECT_THAT(message_of_a_run<Passing>(), testing::HasSubstr("was to end at")); }

TEST(WrongSteps, ThatThrowEndARunWithTheirWords) {
  const std::string who = "the integrator of this scene ";
  EXPECT_EQ(message_of_a_run<Throwing>(), who + "does not step: out of order");
  EXPECT_EQ(message_of_a_run<ThrowingNumber>(), who + "does not step: it throws what is no exception of C++");
  EXPECT_EQ(message_of_a_run<Opaque>(), who + "does not interpolate within its steps: nothing is known inside");
}

TEST(WrongSteps, OfAnOutcomeThatThereIsNotOrAnotherCountOfNumbersEndARun) {
  EXPECT_THAT(message_of_a_run<Undecided>(), testing::HasSubstr("does not step: it ends with an outcome that there is "
                                                                "not, 99"));
  // Angle, rate and work.
  EXPECT_THAT(message_of_a_run<Shrinking>(), testing::HasSubstr("it leaves 1 numbers in the state where 3 are due"));
}

TEST(WrongSteps, ThatDoNotGoWhereAnEventSendsThemEndARun) {
  EXPECT_THAT(
      message_of_a_run<Stubborn>("initial: {hinges: {r: {rate: [1]}}}\nevents: {e: {at: 0.5, do: {lock: r}}}\n"),
      testing::HasSubstr("does not go to another state: it was sent to one at 0.5"));
}

TEST(WrongSteps, ThatGoElsewhereAreToldByTheNumberThatIsNot) {
  EXPECT_THAT(
      message_of_a_run<Careless>("initial: {hinges: {r: {rate: [1]}}}\nevents: {e: {at: 0.5, do: {lock: r}}}\n"),
      testing::ContainsRegex("sent to one at 0.5 s and is in another, where number 2 of [0-9]+ is 0.25 and not 0"));
}

TEST(WrongSteps, ThatBlameABodyThatThereIsNotNameNone) {
  const RunSummary summary = run_by<Blaming>();
  EXPECT_EQ(summary.status, RunStatus::singular);
  EXPECT_THAT(summary.message, testing::Not(testing::HasSubstr("at body")));
}

TEST(WrongSteps, WithoutNumbersWithinThemEndARunAsDiverged) {
  const RunSummary summary = run_by<Hollow>();
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_THAT(summary.message, testing::HasSubstr("within its last step are not finite"));
}

TEST(WrongSteps, ThatGainNothingThatTimeResolvesEndARun) {
  EXPECT_EQ(run_by<Creeping>().status, RunStatus::step_underflow);
}

TEST(WrongSteps, ToWhatIsNoNumberNameIt) {
  const RunSummary summary = run_by<Losing>();
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_THAT(summary.message, testing::HasSubstr("the coordinate 'r.0' is nan"));
  // A host's simulation as well, which sees no energies.
  Made made(pendulum);
  made.scene.integrator = std::make_shared<WrappedIntegrator<Losing>>(made.scene.integrator);
  Session session(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, {});
  const SessionEnd end = session.advance(0.2, false);
  EXPECT_EQ(end.status, RunStatus::diverged);
  EXPECT_THAT(end.message, testing::HasSubstr("the coordinate 'r.0' is nan"));
}

TEST(WrongSteps, AreNotBegunByAnIntegratorThatGivesNoneOrIsStableToNothing) {
  const std::string who = "integrator 'mine' ";
  EXPECT_EQ(start_of("null"), who + "cannot begin and does not say why");
  EXPECT_EQ(start_of("throws"), who + "cannot begin: out of order");
  EXPECT_THAT(start_of("limit"), testing::StartsWith(who + "says that it is stable to h"));
  EXPECT_EQ(start_of("throws-limit"), who + "does not say how long its steps may be: no limit known");
}

}  // namespace
}  // namespace withy::test
