// What errors are measured by, and what a study makes of them.
#include <gtest/gtest.h>

#include <cmath>

#include "withy/study/accuracy.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/probe.hpp"
#include "withy/study/trade.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

Prepared pendulum() {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/pendulum.yaml");
  return prepare(values.set("time.end", Value(0.5), "the test"), plugins());
}

TEST(Distances, EndWhereTheTimesOfTwoRunsPart) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  const auto reading = [&](double x) { return std::vector<double>(outputs.size(), x); };
  const Readings whole{{0, 0.1, 0.2}, {reading(0), reading(0), reading(0)}};
  const Readings stopped{{0, 0.1, 0.15}, {reading(0), reading(0.25), reading(7)}};
  const auto [greatest, until] = distances(outputs, stopped, whole);
  EXPECT_EQ(until, 0.1);
  EXPECT_EQ(greatest[0], 0.25) << "where the stopped run ends is no common time";
}

TEST(Accuracy, ReadsSharesLengthsAndAngles) {
  const Accuracy a = Accuracy::parse("1%, 2 mm, 0.5 deg");
  EXPECT_DOUBLE_EQ(a.share.value(), 0.01);
  EXPECT_DOUBLE_EQ(a.length.value(), 2e-3);
  EXPECT_NEAR(a.angle.value(), 0.5 * 3.14159265358979 / 180, 1e-15);
  for (const char* wrong : {"", "0", "-1%", "150%", "1%,2%", "3 kg"})
    EXPECT_THROW(static_cast<void>(Accuracy::parse(wrong)), std::runtime_error) << wrong;
}

TEST(Accuracy, OfOutputsThatStandStillIsNotZero) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  const Distances limits = Accuracy::parse("1%").limits(outputs, outputs.none());
  for (const double limit : limits) EXPECT_GT(limit, 0);
  EXPECT_EQ(relative_error(outputs.none(), outputs.none()), 0);
}

// Speeds of hinges behind a body with modes stand elsewhere where it has more of them: outputs of one model are read of
// another by their hinges.
TEST(Outputs, OfHingesBehindModesAreReadWhereAModelHasThem) {
  const auto arm = [](int modes) {
    return prepare(SceneValues::parse("format: withy/1\ntime: {end: 1}\nbodies:\n  arm: {type: beam, length: 1, "
                                      "mass_per_length: 1, bending_y: {stiffness: 50, modes: " +
                                          std::to_string(modes) + R"(}}
  hand: {type: rigid, mass: 1, center_of_mass: [0.2, 0, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
  tool: {type: rigid, mass: 0.5, center_of_mass: [0.1, 0, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  elbow: {type: revolute, axis: [0, 0, 1], parent: arm.tip, child: hand}
  wrist: {type: revolute, axis: [0, 0, 1], parent: hand, child: tool}
initial: {hinges: {wrist: {rate: [0.7]}}}
motions:
  a: {hinge: shoulder, type: quintic, to: 1, duration: 2}
  b: {hinge: elbow, type: quintic, to: 1, duration: 2}
)",
                                      "arm.yaml"),
                   plugins());
  };
  const Prepared one = arm(1);
  const Outputs outputs(one.model(), {"elbow.motion_effort", "wrist.rate"});
  for (const int modes : {1, 2, 4}) {
    const Prepared other = arm(modes);
    State state = other.scene.initial;
    state.time = 0.3;
    other.model().prescribe(state);
    OutputReader reader(outputs, other.model(), *other.equations, {});
    const std::vector<double> read = reader.read(state);
    std::vector<double> efforts(other.model().layout().speeds);
    Work work = other.equations->make_work();
    ASSERT_TRUE(other.equations->motion_efforts(state.time, state.y, efforts, work).ok());
    const double effort = efforts[other.model().layout().hinges[1].speed];
    EXPECT_GT(std::abs(effort), 1e-3) << "at modes there is none";
    EXPECT_EQ(read[0], effort) << modes;
    EXPECT_EQ(read[1], 0.7) << modes;
  }
}

Prepared blade() { return prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spin-up.yaml"), plugins()); }

TEST(Accuracy, IsOfEachOutputsOwnRange) {
  const Prepared scene = blade();
  const Outputs outputs(scene.model());
  EXPECT_EQ(outputs.names(), (std::vector<std::string>{"blade.tip", "blade.tip.deflection", "axle.motion_effort"}));
  const Distances ranges = {16.0, 0.5, 20.0};
  const Distances limits = Accuracy::parse("1%").limits(outputs, scales(outputs, ranges, 100.0));
  for (std::size_t i = 0; i < ranges.size(); ++i) EXPECT_DOUBLE_EQ(limits[i], 0.01 * ranges[i]);
}

/// 8 m of blade: a deflection of a tenth of a millimetre does not rule.
TEST(Accuracy, OfWhatHardlyMovesIsOfAFloorThatTheSceneGives) {
  const Prepared scene = blade();
  const Outputs outputs(scene.model());
  const Distances counted = scales(outputs, {1e-5, 1e-4, 1e-3}, 100.0);
  EXPECT_DOUBLE_EQ(counted[0], 8e-3);
  EXPECT_DOUBLE_EQ(counted[1], 8e-3);
  EXPECT_DOUBLE_EQ(counted[2], 0.1) << "of 100 J over a radian";
}

/// A blade whose axle is driven: its moment is what inverse dynamics says, and an output as the tip is.
TEST(Outputs, HaveTheEffortsThatMotionsNeed) {
  const Prepared scene = blade();
  const Outputs outputs(scene.model(), {"axle.motion_effort"});
  OutputReader reader(outputs, scene.model(), *scene.equations);
  State state = scene.scene.initial;
  state.time = 5;
  scene.model().prescribe(state);
  std::vector<double> efforts(scene.model().layout().speeds);
  Work work = scene.equations->make_work();
  ASSERT_TRUE(scene.equations->motion_efforts(5, state.y, efforts, work).ok());
  const std::vector<double> read = reader.read(state);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0], efforts[scene.model().layout().hinge("axle")->speed]);
  EXPECT_GT(read[0], 0.1);
}

/// The name that result tables have is the name of a measure, and has what it has been over the run.
TEST(Outputs, HaveTheRatesOfHinges) {
  const Prepared scene = blade();
  const Outputs outputs(scene.model(), {"axle.rate", "axle.rate.max"});
  ASSERT_EQ(outputs.list().size(), 2U);
  EXPECT_EQ(outputs.list()[0].label, "axle.rate");
  EXPECT_EQ(outputs.list()[0].unit, "rad/s");
  EXPECT_EQ(outputs.list()[1].label, "axle.rate.max");
  OutputReader reader(outputs, scene.model(), *scene.equations);
  State state = scene.scene.initial;
  double greatest = 0;
  for (const double t : {0.0, 5.0, 15.0, 10.0}) {
    state.time = t;
    scene.model().prescribe(state);
    const double rate = state.y[scene.model().layout().positions + scene.model().layout().hinge("axle")->speed];
    greatest = std::max(greatest, rate);
    const std::vector<double> read = reader.read(state);
    EXPECT_EQ(read[outputs.list()[0].at], rate);
    EXPECT_EQ(read[outputs.list()[1].at], greatest);
  }
  EXPECT_EQ(greatest, 4) << "that of the spin-up, rad/s";
  EXPECT_THROW(Outputs(scene.model(), {"axle.rates"}), InputError);
}

/// Of one component what the scene shows; of a whole output its orientation as an angle, and floors by its other
/// numbers.
TEST(Outputs, AreTheScenesSensorsByName) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spin-up.yaml");
  values.set_text("outputs={foot: {type: reaction, hinge: axle}, end: {type: frame, of: blade.tip}}");
  const Prepared scene = prepare(values, plugins());
  const Outputs outputs(scene.model(), {"foot.mz", "end", "axle.motion_effort"}, scene.scene.outputs);
  ASSERT_EQ(outputs.list()[0].label, "foot.mz");
  EXPECT_EQ(outputs.list()[0].unit, "N m");
  EXPECT_EQ(outputs.list()[4].label, "end.orientation");
  EXPECT_EQ(outputs.list()[4].unit, "rad");
  OutputReader reader(outputs, scene.model(), *scene.equations, scene.scene.outputs);
  State state = scene.scene.initial;
  state.time = 5;
  scene.model().prescribe(state);
  const std::vector<double> read = reader.read(state);
  // What turns the axle is what the axle carries about itself.
  EXPECT_NEAR(std::abs(read[outputs.list()[0].at]), std::abs(read.back()), 1e-9 * std::abs(read.back()));
  Distances distances = outputs.none();
  outputs.raise(read, reader.read(scene.scene.initial), distances);
  EXPECT_NEAR(distances[4], std::abs(state.y[0]), 1e-6) << "the angle that the axle has turned";
  // z of the place moves a millionth of what x does: it counts as a thousandth of that.
  Distances ranges = outputs.none();
  ranges[1] = 8, ranges[2] = 8, ranges[3] = 8e-6;
  EXPECT_DOUBLE_EQ(scales(outputs, ranges, 0)[3], 8e-3);
  EXPECT_THROW(Outputs(scene.model(), {"foot.mw"}, scene.scene.outputs), InputError);
}

/// A pendulum's own run at a tight tolerance.
Yardstick yardstick_of(Evaluator& evaluator) {
  ReferenceGoal goal;
  goal.first = {"", "", 0, "dop853", 1e-8, {}, {}};
  const ReferenceFound found = find_reference([&](const Point& p) -> const ModelAt& { return evaluator.model(p); },
                                              evaluator.registry(), evaluator.outputs(), goal, {});
  EXPECT_TRUE(found.reference) << found.trouble;
  return {*found.reference, Accuracy::parse("1%").limits(evaluator.outputs(), found.reference->scales)};
}

Prepared wave(double phase) {
  return prepare(SceneValues::parse(R"(format: withy/1
time: {end: 0.75, output: 0.001}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
outputs: {wave: {type: expression, value: sin(6.283185307179586 * t - )" +
                                        std::to_string(phase) + R"(), unit: N}}
)",
                                    "text"),
                 plugins());
}

/// What a sine has been over three quarters of its period is a measure, as its value is. Errors of it are those at the
/// end: between two sines, one behind the other, the extremes are as far apart as the waves are when the first has one,
/// and the same in the end.
TEST(Outputs, AreWhatSensorsHaveBeenOverARun) {
  const Prepared scene = wave(0), late = wave(0.1);
  const std::vector<std::string> names = {"wave.min", "wave.max", "wave.mean", "wave.rms", "wave.integral", "wave"};
  const Outputs outputs(scene.model(), names, scene.scene.outputs);
  ASSERT_EQ(outputs.list().size(), 6U);
  EXPECT_EQ(outputs.list()[1].label, "wave.max");
  EXPECT_EQ(outputs.list()[1].unit, "N");
  EXPECT_EQ(outputs.list()[4].unit, "N s");
  OutputReader reader(outputs, scene.model(), *scene.equations, scene.scene.outputs);
  OutputReader behind(outputs, late.model(), *late.equations, late.scene.outputs);
  State state = scene.scene.initial;
  Distances apart = outputs.none(), ranges = outputs.none();
  std::vector<double> first, read;
  for (int k = 0; k <= 750; ++k) {
    state.time = 1e-3 * k;
    read = reader.read(state);
    if (k == 0) first = read;
    outputs.raise(read, behind.read(state), apart);
    outputs.raise_ranges(read, first, ranges);
  }
  const double pi = 3.141592653589793;
  const std::vector<double> expected = {-1, 1, 1 / (2 * pi * 0.75), std::sqrt(0.5), 1 / (2 * pi), -1};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(read[outputs.list()[i].at], expected[i], 1e-5) << names[i];
    EXPECT_NEAR(ranges[i], i == 4 ? 0.75 : 1, 1e-9) << names[i];
  }
  EXPECT_NEAR(apart[0], 1 - std::cos(0.1), 1e-5);  // the late one has not been at its least yet
  EXPECT_NEAR(apart[1], 0, 1e-5);                  // 0.1 and more apart while the first was there and the other not
  EXPECT_NEAR(apart[5], 2 * std::sin(0.05), 1e-5);

  EXPECT_THROW(Outputs(scene.model(), {"wave.most"}, scene.scene.outputs), InputError);
}

TEST(Probe, PassesOnlyWithTheReferencesOwnErrorOnTop) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  Yardstick yardstick = yardstick_of(evaluator);
  const Point point{"quadratic", "", 0, "dopri5", 1e-6, {}, {}};
  EXPECT_TRUE(evaluator.run(point, yardstick).passed());
  yardstick.reference.own = yardstick.limits;  // all of the accuracy
  EXPECT_EQ(evaluator.run(point, yardstick).outcome, Probe::Outcome::inaccurate);
}

/// What the reference may be off by in one output takes nothing from another.
TEST(Probe, TheReferencesOwnErrorIsOnTopOutputByOutput) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  Yardstick yardstick = yardstick_of(evaluator);
  ASSERT_GE(yardstick.limits.size(), 2U);
  yardstick.limits.assign(yardstick.limits.size(), 1);
  yardstick.reference.own = outputs.none();
  yardstick.reference.own[0] = 0.75;
  Distances off = outputs.none();
  off[1] = 0.75;
  EXPECT_DOUBLE_EQ(yardstick.use_with_own(off), 0.75);
  off[0] = 0.5;
  EXPECT_DOUBLE_EQ(yardstick.use_with_own(off), 1.25);
  EXPECT_DOUBLE_EQ(yardstick.use(off), 0.75);
}

/// Some formulations are long about telling their own.
TEST(Probe, ModelsHaveTheFastestModeOfTheSameModesInQuadratic) {
  const Prepared scene =
      prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml"), plugins());
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const double fastest = evaluator.model({"quadratic", "", 2, "", 0, {}, {}}).fastest;
  EXPECT_GT(fastest, 0);
  for (const char* formulation : {"ruthless", "symmetric", "consistent", "exact"})
    EXPECT_EQ(evaluator.model({formulation, "", 2, "", 0, {}, {}}).fastest, fastest) << formulation;
}

TEST(Probe, IsCutWhereItsAllowanceIsUsedUp) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const Yardstick yardstick = yardstick_of(evaluator);
  Point point{"quadratic", "", 0, "dopri5", 1e-6, {}, {}};
  EXPECT_EQ(evaluator.run(point, yardstick, {1, 0}).outcome, Probe::Outcome::too_costly);
  point.integrator = "no-such";
  EXPECT_THROW(static_cast<void>(evaluator.run(point, yardstick)), std::runtime_error);
}

/// An evaluation has less of the outputs to bear where steps are shorter, and what is cut is timed too briefly.
TEST(Probe, CostsWhatWholeRunsOfTheSamePointCost) {
  const Prepared scene = pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const Yardstick yardstick = yardstick_of(evaluator);
  const Point point{"quadratic", "", 0, "dopri5", 1e-3, {}, {}};
  const Probe whole = evaluator.run(point, yardstick);
  ASSERT_EQ(whole.walk.end, Walk::End::reached);
  Point tighter = point;
  for (tighter.tolerance = 1e-4; tighter.tolerance > 1e-9; tighter.tolerance *= 0.1)
    static_cast<void>(evaluator.run(tighter, yardstick));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(evaluator.run(point, yardstick, {-1}).walk.end, Walk::End::cut);
  EXPECT_DOUBLE_EQ(evaluator.cost(whole), whole.walk.seconds);
}

TradeResult result(double error, double cost, double own = 0) {
  TradeResult r;
  r.status = "completed";
  r.relative_error = error;
  r.cpu_seconds = cost;
  r.reference_error = own;
  return r;
}

TEST(ParetoFront, HasWhatNothingBeats) {
  EXPECT_EQ(pareto_front({result(0.1, 1), result(0.01, 2), result(0.1, 2)}), (std::vector<bool>{true, true, false}));
  // Below what the reference is known to, the cheaper wins.
  EXPECT_EQ(pareto_front({result(1e-4, 1, 1e-3), result(1e-6, 2, 1e-3)}), (std::vector<bool>{true, false}));
  TradeResult failed = result(0, 0);
  failed.status = "singular";
  EXPECT_EQ(pareto_front({failed, result(0.1, 1)}), (std::vector<bool>{false, true}));
}

}  // namespace
}  // namespace withy::study
