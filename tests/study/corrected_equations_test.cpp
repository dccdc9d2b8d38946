// A cheap formulation with a dear one's accelerations: what is sampled, how it goes on, and what an integrator gets.
#include "withy/study/corrected_equations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "withy/study/coarse_run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

Prepared prepared_scene(const std::string& name, const std::string& formulation) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/" + name + ".yaml");
  if (!formulation.empty()) values.choose_formulation(formulation, "the test");
  return prepare(values, plugins());
}

/// The slew's rungs, states of it, and what two of them give there.
struct Pair {
  const Prepared prepared = prepared_scene("two-link-slew", "auto");
  const std::size_t low = index("ruthless"), high = index("quadratic");

  [[nodiscard]] std::size_t index(const std::string& name) const {
    std::size_t i = 0;
    while (prepared.rungs.at(i).name != name) ++i;
    return i;
  }
  /// Some state at a time: bent and moving.
  [[nodiscard]] State state(double time, double phase) const {
    State s = prepared.scene.initial;
    s.time = time;
    for (std::size_t i = 0; i + 1 < s.y.size(); ++i) s.y[i] += 0.02 * std::sin(phase + 2.0 * static_cast<double>(i));
    return s;
  }
  /// Of all elements but the work.
  [[nodiscard]] std::vector<double> rates(const EquationsOfMotion& equations, const State& s) const {
    Work work = equations.make_work();
    std::vector<double> f(s.y.size());
    EXPECT_TRUE(equations.derivatives(s.time, s.y, f, work).ok());
    f.pop_back();
    return f;
  }
  [[nodiscard]] std::vector<double> rates(std::size_t rung, const State& s) const {
    return rates(*prepared.rungs[rung].equations, s);
  }
  [[nodiscard]] std::vector<double> difference(const State& s) const {
    std::vector<double> d = rates(high, s);
    const std::vector<double> f = rates(low, s);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= f[i];
    return d;
  }
};

void expect_equal(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12 * (1 + std::abs(b[i]))) << i;
}

TEST(CorrectedEquations, AreTheDearOnesWhereTheyAreSampledAndNoOthersInOneRung) {
  const Pair p;
  CorrectedEquations corrected(p.prepared.rungs, p.low, p.high);
  const State s = p.state(0.2, 0.3);
  corrected.begin(s);
  expect_equal(p.rates(corrected.faces(), s), p.rates(p.high, s));
  EXPECT_EQ(corrected.samples(), 1U);
  CorrectedEquations alone(p.prepared.rungs, p.high, p.high);
  alone.begin(s);
  EXPECT_EQ(&alone.faces(), p.prepared.rungs[p.high].equations);
  EXPECT_EQ(alone.samples(), 0U);
}

/// As it went between the last two samples, for as long as that took and no longer; `begin` forgets it.
TEST(CorrectedEquations, GoOnAsTheDifferenceWent) {
  const Pair p;
  CorrectedEquations corrected(p.prepared.rungs, p.low, p.high);
  const State first = p.state(0.2, 0.3), second = p.state(0.25, 0.4);
  const std::vector<double> d1 = p.difference(first), d2 = p.difference(second);
  corrected.begin(first);
  corrected.sample(second);
  for (const auto& [time, ahead] : std::vector<std::pair<double, double>>{{0.25, 0}, {0.26, 0.2}, {0.3, 1}, {0.4, 1}}) {
    const State s = p.state(time, 0.9);
    std::vector<double> expected = p.rates(p.low, s);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += d2[i] + ahead * (d2[i] - d1[i]);
    expect_equal(p.rates(corrected, s), expected);
  }
  corrected.begin(second);
  State later = p.state(0.3, 0.9);
  std::vector<double> expected = p.rates(p.low, later);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += d2[i];
  expect_equal(p.rates(corrected, later), expected);
}

/// ẋ = N u_z with z = base + δ ẏ, and the explicit rates at δ → 0 where base is y.
TEST(CorrectedEquations, ImplicitRatesAreThoseOfTheStateThatTheyLeadTo) {
  const Pair p;
  CorrectedEquations corrected(p.prepared.rungs, p.low, p.high);
  corrected.begin(p.state(0.2, 0.3));
  corrected.sample(p.state(0.25, 0.4));
  const LinearlyImplicit* implicit = corrected.linearly_implicit();
  ASSERT_NE(implicit, nullptr);
  const State s = p.state(0.27, 0.9);
  Work work = corrected.make_work();
  std::vector<double> f(s.y.size());
  const double delta = 0.004;
  ASSERT_TRUE(implicit->implicit_derivatives(s.time, s.y, s.y, delta, f, work).ok());
  const std::size_t n = corrected.layout().positions;  // the slew's speeds are the rates of its coordinates
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(f[i], s.y[n + i] + delta * f[n + i], 1e-12 * (1 + std::abs(f[i])));
  ASSERT_TRUE(implicit->implicit_derivatives(s.time, s.y, s.y, 1e-14, f, work).ok());
  f.pop_back();
  const std::vector<double> plain = p.rates(corrected, s);
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], plain[i], 1e-8 * (1 + std::abs(plain[i]))) << i;
}

/// With steps that resolve the motion the run is the dear one's, to second order in them.
TEST(CorrectedEquations, RunsComeToTheDearOnesWithTheSquareOfTheStep) {
  const Pair p;
  const Outputs outputs(p.prepared.model());
  const double end = 0.2;
  const auto final_state = [&](std::size_t low, double step) {
    const auto integrator = make_integrator(plugins(), "rk4", Value::map({{"step", Value(step)}}));
    CoarseRun run(p.prepared, low, p.high, outputs, *integrator, p.prepared.scene.initial, end);
    EXPECT_TRUE(run.to(end, {}, 1000000));
    return run.state().y;
  };
  const std::vector<double> truth = final_state(p.high, 1e-4);
  const auto error = [&](double step) {
    const std::vector<double> y = final_state(p.low, step);
    double most = 0;
    for (std::size_t i = 0; i + 1 < y.size(); ++i) most = std::max(most, std::abs(y[i] - truth[i]));
    return most;
  };
  const double one = error(4e-4), half = error(2e-4), uncorrected = [&] {
    const auto integrator = make_integrator(plugins(), "rk4", Value::map({{"step", Value(1e-3)}}));
    CoarseRun run(p.prepared, p.low, p.low, outputs, *integrator, p.prepared.scene.initial, end);
    EXPECT_TRUE(run.to(end, {}, 1000000));
    double most = 0;
    for (std::size_t i = 0; i + 1 < truth.size(); ++i) most = std::max(most, std::abs(run.state().y[i] - truth[i]));
    return most;
  }();
  EXPECT_GT(one / half, 3);
  EXPECT_LT(one / half, 6);
  EXPECT_LT(half, 1e-2 * uncorrected);
}

TEST(CorrectedEquations, LoopsThatAnIntegratorWouldNotSeeAreRefused) {
  const Prepared closed = prepared_scene("gallery/four-bar", "");
  const std::vector<Rung> rungs = {{"quadratic", {}, closed.equations.get()}};
  EXPECT_THAT([&] { CorrectedEquations(rungs, 0, 0); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("loops are closed")));
}

}  // namespace
}  // namespace withy::study
