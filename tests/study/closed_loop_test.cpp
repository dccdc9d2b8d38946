// Margins of loops against the closed system: where a run begins to grow, and its eigenvalues.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/input_error.hpp"
#include "withy/study/response.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

using Gains = std::vector<std::pair<std::string, double>>;

/// Greatest |coordinate| in the last over that in the first fifth of a run with the controller's gains times `factor`.
double growth_in_simulation(SceneValues values, double factor, const Gains& gains) {
  for (const auto& [path, gain] : gains) values.set("loads.control." + path, Value(factor * gain), "the test");
  const Prepared prepared = prepare(std::move(values), plugins());
  const double end = *prepared.scene.end;
  double first = 0, last = 0;
  simulate(prepared, plugins(), [&](const State& s) {
    double& most = s.time < 0.2 * end ? first : last;
    if (s.time < 0.2 * end || s.time > 0.8 * end) most = std::max(most, std::abs(s.y[0]));
  });
  return last / first;
}

/// Where the margin says that the loop is on the edge, a run two per cent below decays and one two per cent above
/// grows.
void confirm(const std::string& text, bool from_below, const Gains& gains) {
  SceneValues values = SceneValues::parse("format: withy/1\n" + text, "text");
  const Prepared prepared = prepare(values, plugins());
  State rest = prepared.scene.initial;
  std::fill(rest.y.begin(), rest.y.end(), 0.0);
  const Response r = response({prepared, rest, {}}, {"control", "", {}, {}, 100, {}});
  ASSERT_TRUE(r.margins && r.margins->stable);
  const GainMargin* margin = from_below ? r.margins->lower() : r.margins->upper();
  ASSERT_NE(margin, nullptr);
  const double inside = from_below ? 1.02 : 0.98, outside = from_below ? 0.98 : 1.02;
  EXPECT_LT(growth_in_simulation(values, inside * margin->factor, gains), 0.9) << margin->factor;
  EXPECT_GT(growth_in_simulation(values, outside * margin->factor, gains), 1.1) << margin->factor;
}

TEST(Loop, OfASampledControllerOfAFlexibleArmGoesUnstableInSimulationWhereItsMarginSays) {
  confirm(R"(
time: {end: 12, output: 0.02}
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0], frames: {out: {position: [0.1, 0, 0]}}}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2, family: clamped-free}, damping_ratio: 0.02}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
loads: {control: {type: pd-controller, law: constant, sample: 0.02, hinges: {axle: {stiffness: 10, damping: 2}}}}
initial: {hinges: {axle: {position: [0.001]}}}
)",
          false, {{"hinges.axle.stiffness", 10}, {"hinges.axle.damping", 2}});
}

// p⁺ = −g a with a from the p before: alone that converges for g below the mass felt, whatever the sample.
TEST(Loop, OfASampledAccelerationGoesUnstableInSimulationWhereItsMarginSays) {
  confirm(R"(
time: {end: 6, output: 0.002}
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30, damping: 0.5}
  control: {type: pid, of: imu.x, hinge: slide, proportional: 1, sample: 0.01}
initial: {hinges: {slide: {position: [0.01]}}}
)",
          false, {{"proportional", 1}});
}

TEST(Loop, ThatHoldsAPendulumUprightFallsInSimulationWhereItsMarginSays) {
  confirm(R"(
gravity: [-9.81, 0, 0]
time: {end: 12, output: 0.02}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-13}
bodies:
  pole: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: pole}}
loads: {control: {type: pd-controller, law: constant, hinges: {axle: {stiffness: 20, damping: 0.5}}}}
initial: {hinges: {axle: {position: [1.0e-6], rate: [0]}}}
)",
          true, {{"hinges.axle.stiffness", 20}, {"hinges.axle.damping", 0.5}});
}

/// J s³ + k (k_d s² + k_p s + k_i) is stable for k above J k_i/(k_d k_p).
TEST(Loop, ThatIntegratesGoesUnstableInSimulationWhereItsMarginSays) {
  const std::string text = R"(
time: {end: 60, output: 0.05}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-12}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {control: {type: pid, hinge: axle, proportional: 8, integral: 10, derivative: 4}}
initial: {hinges: {axle: {position: [0.01]}}}
)";
  const Response r = response(at_start(prepare(SceneValues::parse("format: withy/1\n" + text, "text"), plugins())),
                              {"control", "", {}, {}, 50, {}});
  EXPECT_EQ(r.integrators, 3);
  ASSERT_TRUE(r.margins && r.margins->lower() != nullptr);
  EXPECT_NEAR(r.margins->lower()->factor, 2.0 * 10 / (4 * 8), 1e-8);
  confirm(text, true, {{"proportional", 8}, {"integral", 10}, {"derivative", 4}});
}

// A controller measures the reaction to the torque that it gives itself. Slide and beam move apart from one another but
// for rounding, which the poles of the closed loop have to bear.
TEST(Loop, OfAReactionToItsOwnTorqueGrowsAsTheClosedSystemDoes) {
  const Prepared prepared = scene_of(R"(
bodies:
  boom:
    type: beam
    length: 1
    mass_per_length: 1
    bending_y: {stiffness: 50, modes: 2}
    torsion: {stiffness: 50, inertia: 0.003, modes: 2}
    frames: {r: {at: root, position: [-0.1, -0.1, 0.3], orientation: {xyz: [0.7, 1.1, 0.4]}}, a: {at: tip}}
hinges: {slide: {type: prismatic, axis: [-0.5, -0.8, 0], parent: world, child: boom.r}}
outputs: {rail: {type: reaction, hinge: slide}}
loads:
  control: {type: pid, of: rail.my, to: push, proportional: 0.05, sample: 0.01, delay: 0.02}
  push: {type: input, frame: boom.a, direction: [-0.7, 0, -0.8], following: true, acts: torque}
)");
  const Response r = response(at_start(prepared), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins.has_value());
  const LinearModel closed = linear_model(at_start(prepared), {{"push"}, {"slide"}});
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::complex<double> pole : poles(closed.system))
    nearest = std::min(nearest, std::abs(exponent_of(closed.system, pole).real() - r.margins->growth));
  EXPECT_LT(nearest, 1e-6);
}

/// A boom on a bus with a wheel, and a sampled controller of the bus.
std::string bus_with_wheel(const std::string& loads) {
  return R"(
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies:
  bus: {type: rigid, mass: 50, inertia: [5, 5, 6, 0, 0, 0], frames: {out: {position: [0.3, 0, 0]}}}
  boom: {type: beam, length: 3, mass_per_length: 0.5, bending_y: {stiffness: 60, modes: 2, family: clamped-free}, damping_ratio: 0.02}
  wheel: {type: rigid, mass: 2, inertia: [0.01, 0.01, 0.02, 0, 0, 0]}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: bus}
  root: {type: weld, parent: bus.out, child: boom}
  axle: {type: revolute, axis: [0, 0, 1], parent: bus, child: wheel}
outputs: {sense: {type: gyro, of: bus}, back: {type: expression, value: -sense.z}}
initial: {hinges: {turn: {rate: [0.001]}}}
loads:
  hold: {type: hinge-spring, hinge: turn, stiffness: 2}
)" + loads;
}

TEST(Loop, OfASampledControllerThatActsThroughAContinuousLoadIsThatOfOneThatActsItself) {
  const std::string law = "type: pid, of: back, proportional: 4, integral: 1, sample: 0.05, delay: 0.1";
  const auto loop = [](const std::string& loads) {
    return response(at_start(scene_of(bus_with_wheel(loads))), {"control", "", {}, {}, 50, {}});
  };
  const Response itself = loop("  control: {" + law + ", hinge: axle}\n");
  const Response through =
      loop("  control: {" + law + ", to: nothing}\n  drive: {type: reaction-wheel, of: control, hinge: axle}\n");
  ASSERT_TRUE(itself.margins && through.margins && itself.margins->lag() && itself.margins->upper());
  EXPECT_TRUE(through.opened);
  EXPECT_EQ(through.margins->stable, itself.margins->stable);
  EXPECT_NEAR(through.margins->growth, itself.margins->growth, 1e-9);
  ASSERT_NE(through.margins->lag(), nullptr);
  EXPECT_NEAR(through.margins->lag()->angle, itself.margins->lag()->angle, 1e-8);
  ASSERT_NE(through.margins->upper(), nullptr);
  EXPECT_NEAR(through.margins->upper()->factor, itself.margins->upper()->factor, 1e-8);
  ASSERT_EQ(through.values.size(), itself.values.size());
  for (std::size_t i = 0; i < itself.values.size(); ++i)
    EXPECT_LT(std::abs(through.values[i].value - itself.values[i].value), 1e-8 * std::abs(itself.values[i].value));
}

TEST(Loop, OfASampledControllerBehindADriveWithALagGoesUnstableInSimulationWhereItsMarginSays) {
  confirm(
      "time: {end: 200, output: 0.05}\n" +
          bus_with_wheel("  control: {type: pid, of: back, to: nothing, proportional: 4, sample: 0.05, delay: 0.05}\n"
                         "  drive: {type: reaction-wheel, of: control, hinge: axle, time_constant: 0.2}\n"),
      false, {{"proportional", 4}});
}

/// The accelerations of the wheel are felt by what is sampled: the loop is opened at the command for these too.
TEST(Loop, OfASampledControllerBehindADriveGrowsAsTheClosedSystemDoesWhereItMeasuresWhatTheDriveDoes) {
  std::string text = bus_with_wheel(
      "  control: {type: pid, of: felt.mz, to: nothing, proportional: 0.2, sample: 0.05, delay: 0.05}\n"
      "  drive: {type: reaction-wheel, of: control, hinge: axle}\n"
      "  torque: {type: input, hinge: turn}\n");
  text.replace(text.find("outputs: {"), 10, "outputs: {felt: {type: reaction, hinge: root}, ");
  const Prepared felt = scene_of(text);
  const Response r = response(at_start(felt), {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins.has_value());
  const LinearModel closed = linear_model(at_start(felt), {{"torque"}, {"turn"}});
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::complex<double> pole : poles(closed.system))
    nearest = std::min(nearest, std::abs(exponent_of(closed.system, pole).real() - r.margins->growth));
  EXPECT_LT(nearest, 1e-6);
}

/// The wheel turns freely, which the loop neither sees nor moves: two poles at z = 1, and of the zeros there a third
/// one, since a rate is measured. By itself rounding moves a threefold zero by 1e-5.
TEST(Loop, BehindADelayIsAsStableAsTheClosedSystemWhateverItsOrder) {
  for (const double gain : {3.0, 60.0})
    for (const double time : {0.07, 0.19})
      for (int order = 1; order <= 6; ++order) {
        const Prepared prepared = scene_of(bus_with_wheel(
            fmt::format("  control: {{type: pid, of: back, to: nothing, proportional: {}, sample: 0.05}}\n"
                        "  drive: {{type: delay, of: control, hinge: axle, time: {}, order: {}}}\n",
                        gain, time, order)));
        const Response r = response(at_start(prepared), {"control", "", {}, {}, 50, {}});
        ASSERT_TRUE(r.margins.has_value());
        const LinearModel closed = linear_model(at_start(prepared), {{"axle"}, {"turn"}});
        double growth = -std::numeric_limits<double>::infinity();
        for (const std::complex<double> pole : poles(closed.system)) {
          const std::complex<double> s = exponent_of(closed.system, pole);
          if (std::abs(s) > 1e-3) growth = std::max(growth, s.real());  // all but the wheel's
        }
        EXPECT_EQ(r.margins->stable, growth < 0) << gain << ", " << time << " s, order " << order;
        EXPECT_NEAR(r.margins->growth, growth, 1e-6) << gain << ", " << time << " s, order " << order;
      }
}

TEST(Loop, OfACommandThatSampledLoadsMeasureAsWellIsRefused) {
  const Prepared prepared =
      scene_of(bus_with_wheel("  control: {type: pid, of: back, to: nothing, proportional: 4, sample: 0.05}\n"
                              "  drive: {type: actuator, of: control, hinge: axle, frequency: 20}\n"
                              "  mean: {type: moving-average, of: control, hinge: turn, window: 0.1, sample: 0.05}\n"));
  try {
    static_cast<void>(response(at_start(prepared), {"control", "", {}, {}, 50, {}}));
    FAIL() << "the loop has two ways";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("sampled ones measure its command as well"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace withy::study
