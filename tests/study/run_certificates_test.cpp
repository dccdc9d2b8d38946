// What certificates say of truncations: momenta, energies and what indicators tell.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scene_runs.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// A free body keeps its momenta; a truncated formulation does not, which is no error of the integration.
TEST(RunCertificates, CertificatesHaveTheMomentaOfFreeTrees) {
  const CertifiedRun sound = run_of("beam-on-base", {}, "quadratic"), cut = run_of("beam-on-base", {}, "ruthless");
  ASSERT_TRUE(sound.certificate.momentum.conserved);
  EXPECT_LT(sound.certificate.momentum.angular, 1e-5);
  EXPECT_GT(cut.certificate.momentum.angular, 0.01);
  EXPECT_FALSE(run_of("pendulum", {}, "quadratic").certificate.momentum.conserved) << "it hangs on the world";
}

/// A stiff boom that a servo turns slowly, in steps that are far too loose: in tight ones the model alone drifts by
/// less than a thousandth of it, and what its coarse run drifts by is that run's.
TEST(RunCertificates, NoDriftIsTheModelsWhereACoarseRunDriftsByMore) {
  SceneValues values = SceneValues::parse(R"(
format: withy/1
bodies:
  hub: {type: rigid, mass: 2.8, center_of_mass: [0.08, 0, 0], inertia: [0.003, 0.008, 0.01, 0, 0, 0], frames: {rim: {position: [0.15, 0, 0]}}}
  boom: {type: beam, length: 3.7, mass_per_length: 5, bending_y: {stiffness: 2.7e5, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.rim, child: boom}
loads: {servo: {type: pid, hinge: axle, proportional: 3.4, integral: 1.3, derivative: 0.34, reference: -0.94}}
time: {end: 0.155, output: 0.00155}
)",
                                          "stiff");
  values.choose_formulation("ruthless", "the test");
  const auto drifts = [&](const char* integrator) {
    values.set_text(std::string("integrator=") + integrator);
    return run(prepare(values, plugins()), plugins()).certificate;
  };
  const Certificate loose = drifts("{name: dopri5, rtol: 1e-3, atol: 1e-12}");
  const Certificate tight = drifts("{name: dop853, rtol: 1e-11, atol: 1e-13}");
  ASSERT_TRUE(loose.estimate && loose.shares);
  EXPECT_LT(tight.energy_drift, 1e-3 * loose.energy_drift);
  EXPECT_GT(loose.estimate->drifts.energy, 1.25 * loose.energy_drift);
  EXPECT_FALSE(loose.shares->energy);
}

/// (d/L)² is of a state, and phases run apart: on random scenes the run was off by up to fifty times that.
TEST(RunCertificates, WhatIsLeftOutAtAnInstantIsNotToldAsTheErrorOfARun) {
  const Prepared prepared = prepare(short_slew().choose_formulation("quadratic", "the test"), plugins());
  const std::string said = run(prepared, plugins()).certificate.without_estimate;
  EXPECT_NE(said.find("at an instant where it is"), std::string::npos) << said;
  EXPECT_NE(said.find("the error of the run grows with time"), std::string::npos) << said;
}

/// A boom that falls from level. Where nothing is said of the model up, its own error is less than what is told of the
/// model used; where it bends far something is said, and there it is not.
TEST(RunCertificates, SayWhereTheModelUpMayBeAsFarOff) {
  const auto certificate = [](const std::string& stiffness, const std::string& formulation, Estimate estimate) {
    SceneValues values = SceneValues::parse(R"(
format: withy/1
gravity: [0, -9.81, 0]
time: {end: 0.5, output: 0.01}
bodies: {boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: )" +
                                                stiffness +
                                                R"(, modes: 2}}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
loads: {stop: {type: hinge-spring, hinge: pin, stiffness: 50}}
)",
                                            "boom");
    values.choose_formulation(formulation, "the test");
    RunSettings settings;
    settings.estimate = estimate;
    return run(prepare(values, plugins()), plugins(), settings).certificate;
  };
  const auto off = [](const Certificate& c) { return c.estimate->distances.deflections.begin()->second; };
  struct Case {
    std::string stiffness, formulation;
    bool said;
  };
  for (const Case& c : {Case{"1", "symmetric", true}, Case{"100", "symmetric", true}, Case{"100", "ruthless", false}}) {
    const Certificate used = certificate(c.stiffness, c.formulation, Estimate::always),
                      up = certificate(c.stiffness, "quadratic", Estimate::always);
    ASSERT_TRUE(used.estimate && up.estimate) << c.stiffness;
    EXPECT_EQ(used.estimate->lacks.find("quadratic itself neglects") != std::string::npos, c.said) << c.stiffness;
    EXPECT_EQ(up.estimate->lacks, "") << "exact neglects nothing";
    if (c.said) {
      EXPECT_GT(off(up), 0.1 * off(used)) << c.stiffness;
    } else {
      EXPECT_LT(off(up), off(used)) << c.stiffness;
    }
  }
}

/// A heavy boom on a ball joint that gravity turns about its axis: nothing turns fast or bends far, and in `consistent`
/// the tip is off by three quarters of its deflection.
/// \param in_space it turns little there, and bends by its spring alone
CertifiedRun run_of_a_boom_on_a_ball(const std::string& formulation, bool in_space) {
  SceneValues values = SceneValues::parse(R"(
format: withy/1
bodies:
  ball: {type: rigid, mass: 4, center_of_mass: [0.38, 0, 0], inertia: [0.11, 0.29, 0.34, 0, 0, 0], frames: {rim: {position: [0.76, 0, 0]}}}
  boom: {type: beam, length: 11, mass_per_length: 0.2, bending_y: {stiffness: 31400, modes: 3}}
hinges:
  joint: {type: spherical, parent: world, child: ball}
  pin: {type: revolute, axis: [0, 0, 1], parent: ball.rim, child: boom}
loads: {spring: {type: hinge-spring, hinge: pin, stiffness: 4240, free_position: 0.08}}
initial: {hinges: {joint: {rate: [1.283, 0.069, 0.151]}}}
time: {end: 2.45, output: 0.0245}
integrator: {name: dop853, rtol: 1e-8, atol: 1e-10}
)",
                                          "ball");
  values.set_text(in_space ? "initial.hinges.joint.rate=[0.02, 0.01, 0.01]" : "gravity=[0, -9.81, 0]");
  return run(prepare(values.choose_formulation(formulation, "the test"), plugins()), plugins());
}

TEST(RunCertificates, AnIndicatorTellsWhatATruncationWithSecondOrderLeavesOut) {
  const auto indicator = [](const CertifiedRun& run) {
    const std::vector<Indicator>& all = run.certificate.indicators;
    const auto found = std::find_if(all.begin(), all.end(), [](const Indicator& i) {
      return i.text.find("accelerations left out against quadratic") != std::string::npos;
    });
    return found == all.end() ? std::nullopt : std::optional(*found);
  };
  const CertifiedRun falling = run_of_a_boom_on_a_ball("consistent", false);
  ASSERT_EQ(falling.summary.status, RunStatus::completed);
  ASSERT_TRUE(indicator(falling));
  EXPECT_GT(indicator(falling)->use(), 1);
  EXPECT_EQ(indicator(falling)->value, falling.certificate.neglected.rms);
  for (const Indicator& i : falling.certificate.indicators) EXPECT_EQ(i.use() > 1, i.text == indicator(falling)->text);
  const CertifiedRun floating = run_of_a_boom_on_a_ball("consistent", true);
  ASSERT_TRUE(indicator(floating));
  EXPECT_LT(indicator(floating)->use(), 1);
  // Rates and loads tell the others, and nothing is truncated in `quadratic`.
  for (const char* other : {"ruthless", "linear", "quadratic"})
    EXPECT_FALSE(indicator(run_of_a_boom_on_a_ball(other, true))) << other;
}

/// Of a spacecraft that drifts: its momentum is of another order than its velocity's own. Nothing else feels a drift,
/// and an arm on a foundation has none.
TEST(RunCertificates, CertificatesTellWhatTheSymmetricTruncationMakesOfAVelocityOfTheWhole) {
  const auto told = [](const std::string& name, const std::string& formulation, double drift) {
    const Value end(0.05), velocity(drift);
    std::vector<std::pair<std::string, Value>> changes = {{"time.end", end}};
    if (drift != 0) changes.emplace_back("initial.hinges.float.rate.4", velocity);
    const std::vector<Indicator> all = run_of(name, changes, formulation).certificate.indicators;
    const auto found = std::find_if(all.begin(), all.end(), [](const Indicator& i) {
      return i.text.find("velocity of the whole") != std::string::npos;
    });
    return found == all.end() ? std::nullopt : std::optional(*found);
  };
  const auto slow = told("spacecraft", "symmetric", 10), fast = told("spacecraft", "symmetric", 1000);
  ASSERT_TRUE(slow && fast);
  EXPECT_GT(slow->use(), 1);
  EXPECT_NEAR(fast->value, 1, 0.1) << "nearly all of the accelerations are made by it";
  EXPECT_LT(told("spacecraft", "symmetric", 0)->value, 0.5 * slow->value);
  EXPECT_FALSE(told("spacecraft", "quadratic", 1000));
  EXPECT_FALSE(told("spacecraft", "linear", 1000));
  EXPECT_FALSE(told("two-link-slew", "symmetric", 0));
}

TEST(RunCertificates, TheSymmetricTruncationConservesItsOwnEnergy) {
  const CertifiedRun r = run_of("two-link-slew", {}, "symmetric");
  EXPECT_LT(r.certificate.energy_drift, 1e-4);
  EXPECT_GT(r.certificate.untruncated_drift, 10 * r.certificate.energy_drift);
}

}  // namespace
}  // namespace withy::study
