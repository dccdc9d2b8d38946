// Equations that change their formulation along one run: what goes over, and that everything else goes on.
#include "withy/core/simulation/changing_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

const std::string sampled =
    "loads:\n  control: {type: pd-controller, law: constant, sample: 0.01, hinges: {axle: {to: 0.5, stiffness: 2, "
    "damping: 0.1}}}\n";

/// A beam on an axle that falls.
std::string falling(const std::string& more, const std::string& integrator = "{name: dopri5, rtol: 1e-8}") {
  return "format: withy/1\ntime: {end: 1, output: 0.01}\ngravity: [0, -9.81, 0]\nintegrator: " + integrator +
         "\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 20, modes: 2}}\nhinges:"
         "\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}\n" +
         more;
}

struct Ladder {
  explicit Ladder(const std::string& text) : made(text) {
    for (const char* id : {"ruthless", "quadratic"}) {
      equations.push_back(made.in(id));
      rungs.push_back({id, make_plugin<Formulation>(made.registry, id)->terms(), equations.back().get()});
    }
    options.end = *made.scene.end;
    options.output = made.scene.output;
  }
  RunSummary run(std::vector<Stretch> stretches) {
    ChangingEquations changing(rungs, std::move(stretches));
    options.changing = &changing;
    outputs.clear();
    RunSummary summary = simulate(*made.scene.model, changing, *made.scene.integrator, made.scene.initial, options,
                                  [&](const State& s) { outputs.push_back(s); });
    evaluations = changing.evaluations();
    return summary;
  }
  RunSummary plain(std::size_t rung) {
    options.changing = nullptr;
    return simulate(*made.scene.model, *equations[rung], *made.scene.integrator, made.scene.initial, options, {});
  }
  Made made;
  std::vector<std::unique_ptr<EquationsOfMotion>> equations;
  std::vector<Rung> rungs;
  RunOptions options;
  std::vector<State> outputs;
  std::vector<std::size_t> evaluations;  ///< of the last run, in each rung
};

double apart(const State& a, const State& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.y.size(); ++i) most = std::max(most, std::abs(a.y[i] - b.y[i]));
  return most;
}

TEST(ChangingEquations, one_stretch_is_the_run_of_its_formulation_bit_by_bit) {
  Ladder l(falling(""));
  const RunSummary changing = l.run({{1, 0, 1}}), plain = l.plain(1);
  EXPECT_EQ(changing.final.y, plain.final.y);
  EXPECT_EQ(changing.steps.evaluations, plain.steps.evaluations);
}

TEST(ChangingEquations, the_state_goes_over_as_it_is_and_energy_counts_anew) {
  for (const char* integrator :
       {"{name: dopri5, rtol: 1e-8}", "{name: imex, rtol: 1e-8}", "{name: radau, rtol: 1e-8}"}) {
    Ladder l(falling("", integrator));
    const RunSummary run = l.run({{0, 0, 0.4}, {1, 0.4, 1}});
    ASSERT_EQ(run.status, RunStatus::completed) << integrator;
    EXPECT_EQ(l.outputs.size(), 101U) << "every output once";
    Ladder first(falling("", integrator));
    first.options.end = 0.4;
    const RunSummary before = first.plain(0);
    RunOptions rest = l.options;
    rest.changing = nullptr;
    const RunSummary after =
        simulate(*l.made.scene.model, *l.equations[1], *l.made.scene.integrator, before.final, rest, {});
    EXPECT_LT(apart(run.final, after.final), 1e-6) << integrator;
    EXPECT_GT(apart(run.final, first.plain(0).final), 1e-3);
    // Ruthless truncation does not conserve energy; after the change nothing is added to what was lost before it.
    EXPECT_NEAR(run.energy_drift, before.energy_drift, 0.5 * before.energy_drift) << integrator;
  }
}

/// With both rungs the same equations, a hand-over changes nothing but a step: the sampled controller's states and
/// instants go on.
TEST(ChangingEquations, discrete_states_go_on_over_a_change) {
  Ladder l(falling(sampled));
  l.rungs[0] = l.rungs[1];
  const RunSummary changing = l.run({{0, 0, 0.37}, {1, 0.37, 0.61}, {0, 0.61, 1}});
  const RunSummary plain = l.plain(1);
  ASSERT_EQ(changing.status, RunStatus::completed) << changing.message;
  ASSERT_EQ(plain.status, RunStatus::completed) << plain.message;
  EXPECT_LT(apart(changing.final, plain.final), 1e-6);
}

TEST(ChangingEquations, a_checkpoint_on_either_side_of_a_change_is_resumed_bit_by_bit) {
  for (const double at : {0.2, 0.4, 0.7}) {
    Ladder l(falling(sampled));
    std::optional<Checkpoint> kept;
    l.options.checkpoint_due = [&] { return !kept; };
    l.options.checkpoint = [&](const Checkpoint& c) {
      if (c.state.time >= at) kept = c;
    };
    const std::vector<Stretch> stretches = {{0, 0, 0.4}, {1, 0.4, 1}};
    const RunSummary whole = l.run(stretches);
    ASSERT_TRUE(kept) << whole.message;
    const std::vector<std::size_t> evaluations = l.evaluations;
    l.options.resume = &*kept;
    const RunSummary resumed = l.run(stretches);
    EXPECT_EQ(resumed.final.y, whole.final.y) << at;
    EXPECT_EQ(resumed.energy_drift, whole.energy_drift) << at;
    EXPECT_EQ(resumed.peak_deflection, whole.peak_deflection) << at;
    EXPECT_GT(evaluations[0], 0U) << at;
    EXPECT_EQ(l.evaluations, evaluations) << "those before the checkpoint count, at " << at;
  }
}

}  // namespace
}  // namespace withy::test
