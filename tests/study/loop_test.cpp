// Margins of loops: those of textbooks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "withy/study/at_limits.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/response.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using std::numbers::pi;
using test::plugins;

/// A wheel of inertia J behind a controller of one hinge.
std::string servo(const std::string& gains) {
  return R"(
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {control: {type: pd-controller, law: constant, )" +
         gains + "}}\n";
}

TEST(Loop, OfAControllerOnAWheelHasTheTextbooksMargins) {
  const Response r = response(at_start(scene_of(servo("hinges: {axle: {stiffness: 8, damping: 4}}"))),
                              {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.opened);
  EXPECT_TRUE(r.margins->stable);
  EXPECT_EQ(r.margins->upper(), nullptr);
  EXPECT_EQ(r.margins->lower(), nullptr);
  // L = (8 + 4 s)/(2 s²): |L| = 1 at ω⁴ = 4 ω² + 16, phase margin atan(ω/2).
  const double omega = std::sqrt(2 + std::sqrt(20.0));
  ASSERT_EQ(r.margins->phases.size(), 1U);
  EXPECT_NEAR(r.margins->lag()->omega, omega, 1e-9);
  EXPECT_NEAR(r.margins->lag()->angle, std::atan(omega / 2), 1e-9);
}

TEST(Loop, OfASampledDamperIsUnstableAtTwiceTheInertiaOverTheDamping) {
  const Response r = response(at_start(scene_of(servo("sample: 0.05, hinges: {axle: {stiffness: 0, damping: 4}}"))),
                              {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.margins->upper() != nullptr);
  EXPECT_NEAR(r.margins->upper()->factor, 2 * 2 / (4 * 0.05), 1e-9);
  EXPECT_NEAR(r.margins->upper()->omega, pi / 0.05, 1e-9);
  // L = c T / (J (z − 1)) has the pole 1 and no zero.
  EXPECT_EQ(r.roots.poles.size(), 1);
}

/// A mass of 45 kg behind a PID, far from its reference: a chain of three integrators.
std::string chain(const std::string& clock) {
  return R"(
bodies: {m: {type: rigid, mass: 45}}
hinges: {rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: m}}
loads: {control: {type: pid, hinge: rail, proportional: 4500, integral: 2000, derivative: 630, reference: 0.5)" +
         clock + "}}\n";
}

TEST(Loop, OfAChainOfIntegratorsHasItsMarginsWhateverEffortStands) {
  const Response r = response(at_start(scene_of(chain(""))), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins);
  EXPECT_EQ(r.integrators, 3);
  EXPECT_NEAR(r.static_gain, 2000. / 45, 1e-8);
  EXPECT_TRUE(r.margins->stable);
  // L = (630 s² + 4500 s + 2000)/(45 s³) is real at ω² = 2000/630.
  ASSERT_NE(r.margins->lower(), nullptr);
  EXPECT_NEAR(r.margins->lower()->omega, std::sqrt(2000. / 630), 1e-8);
  EXPECT_NEAR(r.margins->lower()->factor, 45 * 2000 / (630. * 4500), 1e-9);
  ASSERT_EQ(r.margins->phases.size(), 1U);
  const std::complex<double> s(0, r.margins->lag()->omega);
  const std::complex<double> L = (630. * s * s + 4500. * s + 2000.) / (45. * s * s * s);
  EXPECT_NEAR(std::abs(L), 1, 1e-8);
  EXPECT_NEAR(r.margins->lag()->angle, pi + std::arg(L), 1e-8);
}

TEST(Loop, HasItsMarginsWhateverFrequenciesAreShown) {
  for (const std::string clock : {"", ", sample: 0.01"}) {
    const auto shown = [&](std::optional<double> from, std::optional<double> to, int points) {
      return response(at_start(scene_of(chain(clock))), {"control", "", from, to, points, {}});
    };
    const Response whole = shown({}, {}, 100), part = shown(1e-3, 2e-3, 5);
    ASSERT_TRUE(whole.margins && part.margins);
    ASSERT_NE(whole.margins->lower(), nullptr);
    ASSERT_NE(part.margins->lower(), nullptr) << clock;
    EXPECT_NEAR(part.margins->lower()->factor, whole.margins->lower()->factor, 1e-9);
    ASSERT_EQ(part.margins->phases.size(), whole.margins->phases.size());
    EXPECT_NEAR(part.margins->lag()->angle, whole.margins->lag()->angle, 1e-9);
    EXPECT_LT(part.values.back().omega, 2 * pi * 2.1e-3) << "what is shown is what was asked for";
  }
}

TEST(Loop, OfASampledChainOfIntegratorsWithADelayHasItsMargins) {
  constexpr double T = 0.002;
  const Response r =
      response(at_start(scene_of(chain(", sample: 0.002, delay: 0.002"))), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins);
  EXPECT_EQ(r.integrators, 3);
  EXPECT_NEAR(r.static_gain, 2000. / 45, 1e-6);
  EXPECT_TRUE(r.margins->stable);
  const auto L = [T](double omega) {
    const std::complex<double> z = std::polar(1., omega * T), d = z - 1.;
    return ((4500. + 2000. * T / d) * T * T * (z + 1.) / (2. * d * d) + 630. * T / d) / (45. * z);
  };
  ASSERT_NE(r.margins->lower(), nullptr);
  ASSERT_NE(r.margins->upper(), nullptr);
  for (const GainMargin* g : {r.margins->lower(), r.margins->upper()}) {
    EXPECT_NEAR(L(g->omega).real(), -1 / g->factor, 1e-6 / g->factor);
    EXPECT_NEAR(L(g->omega).imag(), 0, 1e-6 / g->factor);
  }
  ASSERT_EQ(r.margins->phases.size(), 1U);
  EXPECT_NEAR(std::abs(L(r.margins->lag()->omega)), 1, 1e-6);
  EXPECT_NEAR(r.margins->lag()->angle, pi + std::arg(L(r.margins->lag()->omega)), 1e-6);
}

TEST(Loop, OfAControllerAtItsLimitIsSaidToBeOpen) {
  const Configuration far = at_start(scene_of(chain(", limit: 400")));
  try {
    response(far, {"control", "", {}, {}, 50, {}});
    FAIL() << "no error";
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("it is at a limit"), std::string::npos) << e.what();
  }
}

TEST(SmallMotions, NameTheLoadsThatAreAtTheirLimits) {
  for (const std::string clock : {"", ", sample: 0.01"}) {
    const Prepared narrow = scene_of(chain(clock + ", limit: 400")), wide = scene_of(chain(clock + ", limit: 4.0e6"));
    const Configuration at = at_start(narrow), within = at_start(wide);
    const std::vector<std::string> control = {"control"}, none;
    EXPECT_EQ(modes_at(at, true).limited, control) << clock;
    EXPECT_EQ(modes_at(within, true).limited, none) << clock;
    EXPECT_EQ(linear_model(at, {}).limited, control) << clock;
    EXPECT_EQ(linear_model(within, {}).limited, none) << clock;
    // It comes to rest where the controller asks for nothing.
    EXPECT_EQ(find_equilibrium(at, {}, plugins()).limited, none) << clock;
  }
  EXPECT_EQ(at_limits_text({}), "");
  EXPECT_NE(at_limits_text({"control"}).find("'control' is at its limit"), std::string::npos);
}

/// A wheel on a spring whose rate is fed back with the wrong sign of its angle, which the spring outweighs: stable, and
/// nearer to instability by a lead than by a lag. `command` says where the controller's effort goes.
std::string lead_is_least(const std::string& command) {
  return R"(
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
outputs:
  turn: {type: hinge, hinge: axle}
  back: {type: expression, value: turn.rate - 0.5 * turn.position}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 1, damping: 0.1}
  control: {type: pid, of: back, proportional: 1, )" +
         command + "}\n";
}

/// The fastest growth [1/s] of what oscillates with positive frequency in the loop v = −e^{−i lag} y.
double growth_with_lag(const LinearSystem& s, double lag) {
  const std::complex<double> k = std::polar(1.0, -lag);
  const Eigen::MatrixXcd A = s.A - s.B * s.C * (k / (1.0 + k * s.D(0, 0)));
  double growth = -std::numeric_limits<double>::infinity();
  for (const std::complex<double> pole : Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(A, false).eigenvalues())
    if (pole.imag() > 0) growth = std::max(growth, pole.real());
  return growth;
}

TEST(Loop, ThatIsStableNamesTheLagAndTheLeadThatMakeItUnstable) {
  const Response r = response(at_start(scene_of(lead_is_least("hinge: axle"))), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.margins->stable && r.margins->lag() && r.margins->lead());
  const double lag = r.margins->lag()->angle, lead = -r.margins->lead()->angle;
  EXPECT_GT(lag, lead);
  EXPECT_GT(lead, 0);
  for (int i = 0; i < 50; ++i)
    EXPECT_LT(growth_with_lag(r.model.system, -lead + (lag + lead) * (i + 0.5) / 50), 0) << i;
  EXPECT_NEAR(growth_with_lag(r.model.system, lag), 0, 1e-9);
  EXPECT_NEAR(growth_with_lag(r.model.system, -lead), 0, 1e-9);
  EXPECT_GT(growth_with_lag(r.model.system, lag + 0.01), 1e-4);
  EXPECT_GT(growth_with_lag(r.model.system, -lead - 0.01), 1e-4);
}

TEST(Loop, BecomesUnstableAtTheDelayThatItsMarginSays) {
  const Response r = response(at_start(scene_of(lead_is_least("hinge: axle"))), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.margins->delay());
  const double delay = r.margins->delay()->delay;
  for (const double part : {0.2, 0.5, 0.8, 0.99, 1.01}) {
    const std::string drive =
        fmt::format("  late: {{type: delay, of: control, hinge: axle, time: {}, order: 8}}\n", part * delay);
    const Response late =
        response(at_start(scene_of(lead_is_least("to: nothing") + drive)), {"late", "", {}, {}, 50, {}});
    ASSERT_TRUE(late.margins);
    EXPECT_EQ(late.margins->stable, part < 1) << part << " of " << delay << " s: growth " << late.margins->growth;
  }
}

TEST(Loop, MayTakeTheLeastOfTheDelaysAlthoughItsLeastLagHasAGreaterOne) {
  const Response r =
      response(at_start(prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/pd-arm.yaml"), plugins())),
               {"control.shoulder", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.margins->stable && r.margins->lag() && r.margins->delay());
  for (const PhaseMargin& p : r.margins->phases) EXPECT_LE(r.margins->delay()->delay, p.delay);
  EXPECT_LT(r.margins->delay()->delay, r.margins->lag()->delay / 100);
}

TEST(Loop, WhoseGainStaysAboveOneTakesNoDelayAndOneThatIsUnstableHasNoMargin) {
  const auto margins_of = [](double D, double pole) {
    LinearSystem s;
    s.A = Eigen::MatrixXd::Constant(1, 1, pole);
    s.B = s.C = Eigen::MatrixXd::Constant(1, 1, 3);
    s.D = Eigen::MatrixXd::Constant(1, 1, D);
    const TransferFunction G(s);
    return margins(G, frequency_response(G, 1e-2, 1e3, 50, {}), {}, G(0.0)(0, 0).real());
  };
  // 1.5 + 9/(s + 1), and 0.5 + 9/(s + 1): |G| falls to 1.5, and below 1.
  EXPECT_TRUE(margins_of(1.5, -1).stable);
  EXPECT_EQ(margins_of(1.5, -1).delay(), nullptr);
  ASSERT_NE(margins_of(0.5, -1).delay(), nullptr);
  // 0.5 + 9/(s − 10) closed has the pole at 10 − 9/1.5.
  const Margins unstable = margins_of(0.5, 10);
  EXPECT_NEAR(unstable.growth, 4, 1e-12);
  EXPECT_EQ(unstable.lag(), nullptr);
  EXPECT_EQ(unstable.lead(), nullptr);
  EXPECT_EQ(unstable.delay(), nullptr);
}

/// A wheel of 0.01 kg m² times `scale` behind a controller with an integral, all efforts as small.
Response of_small_wheel(double scale, const std::string& sample, double limit) {
  const std::string bounded = limit > 0 ? fmt::format(", limit: {}", limit * scale) : "";
  return response(at_start(scene_of(fmt::format(R"(
bodies: {{wheel: {{type: rigid, mass: 1, inertia: [{0}, {0}, {0}, 0, 0, 0]}}}}
hinges: {{axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}}}
loads: {{control: {{type: pid, hinge: axle, proportional: {1}, integral: {0}, derivative: {2}, filter: 0.05{3}{4}}}}}
)",
                                                0.01 * scale, 0.04 * scale, 0.03 * scale, sample, bounded))),
                  {"control", "", {}, {}, 50, {}});
}

TEST(Loop, OfAControllerIsThatWithoutItsLimitHoweverSmallTheLimitIs) {
  for (const char* sample : {"", ", sample: 0.01"}) {
    for (const double scale : {1.0, 1e-3, 1e-6}) {
      const Response free = of_small_wheel(scale, sample, 0), bounded = of_small_wheel(scale, sample, 1e-3);
      ASSERT_TRUE(free.margins && bounded.margins && free.margins->lag() && bounded.margins->lag());
      EXPECT_TRUE(bounded.margins->stable) << scale << sample;
      EXPECT_NEAR(bounded.margins->lag()->omega, free.margins->lag()->omega, 1e-7) << scale << sample;
      EXPECT_NEAR(bounded.margins->lag()->angle, free.margins->lag()->angle, 1e-7) << scale << sample;
    }
  }
}

TEST(Loop, OfAWheelIsTheSameWhateverItsSize) {
  for (const char* sample : {"", ", sample: 0.01"}) {
    const Response wheel = of_small_wheel(1, sample, 0);
    for (const double scale : {1e12, 1e-6, 1e-12, 1e-18}) {
      const Response small = of_small_wheel(scale, sample, 0);
      ASSERT_TRUE(small.margins && small.margins->lag()) << scale << sample;
      EXPECT_TRUE(small.margins->stable) << scale << sample;
      EXPECT_NEAR(small.margins->lag()->omega, wheel.margins->lag()->omega, 1e-7) << scale << sample;
      EXPECT_NEAR(small.margins->lag()->angle, wheel.margins->lag()->angle, 1e-7) << scale << sample;
    }
  }
}

}  // namespace
}  // namespace withy::study
