/// \file
/// Integrators of plugins that do not keep what Stepper::step promises: a run ends with a message, and does not hang.
#include <gmock/gmock.h>

#include "withy/core/plugin/registry.hpp"
#include "withy/core/simulation/simulate.hpp"
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

template <class Steps>
std::string message_of_a_run() {
  Made made(pendulum);
  made.scene.integrator = std::make_shared<WrappedIntegrator<Steps>>(made.scene.integrator);
  RunOptions options;
  options.end = 1;
  try {
    simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options,
             [](const State&) {});
  } catch (const PluginError& e) {
    return e.what();
  }
  return "it ran";
}

TEST(WrongSteps, ThatStandStillEndARun) {
  EXPECT_THAT(message_of_a_run<Standing>(), testing::HasSubstr("says of a step that it is done, which began at 0"));
}
TEST(WrongSteps, ThatGoTooFarEndARun) { EXPECT_THAT(message_of_a_run<Passing>(), testing::HasSubstr("was to end at")); }

}  // namespace
}  // namespace withy::test
