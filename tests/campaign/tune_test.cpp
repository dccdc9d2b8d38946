// Fits to measured data: they find what made the data, know how well they do, and name what the data cannot tell.
#include "withy/campaign/tune.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "withy/campaign/tune_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/tests/campaign/tune_fixture.hpp"

namespace withy::campaign {
namespace {

using test::block;
using test::three;
using test::Truth;
using test::TuneFolder;
using testing::HasSubstr;
using State = FittedValue::State;

TEST(Tune, FindsWhatMadeTheDataAndItsCovarianceIsThatOfManyFits) {
  const TuneFolder folder;
  const Truth truth;
  const std::vector<double> wanted = {truth.stiffness, truth.damping, 1e3 * truth.start};
  constexpr int fits = 20;
  double distances = 0;
  std::vector<double> squares(3, 0.0);
  for (int seed = 0; seed < fits; ++seed) {
    folder.measure(truth, 1e-3, static_cast<std::uint64_t>(seed));
    const TuneResult result = folder.tuned(three);
    ASSERT_TRUE(result.converged()) << result.trouble;
    EXPECT_EQ(result.data.ignored, std::vector<std::string>{"operator"});
    EXPECT_NEAR(result.columns[0].after, 1e-3, 2.5e-4);
    EXPECT_FALSE(result.columns[0].correlation);
    Eigen::Vector3d error;
    for (int i = 0; i < 3; ++i) {
      const FittedValue& p = result.parameters[static_cast<std::size_t>(i)];
      ASSERT_TRUE(p.deviation);
      error[i] = (p.value - wanted[static_cast<std::size_t>(i)]) / *p.deviation;
      squares[static_cast<std::size_t>(i)] += error[i] * error[i];
    }
    if (seed == 0) {
      EXPECT_LT(error.cwiseAbs().maxCoeff(), 3.0);
    }
    Eigen::Matrix3d correlation;
    for (int i = 0; i < 9; ++i)
      correlation(i / 3, i % 3) = result.correlation[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)];
    distances += error.dot(correlation.inverse() * error);
  }
  // χ² of 20 and of 60 degrees of freedom are beyond these once in a thousand times.
  for (const double s : squares) {
    EXPECT_GT(s, 5.9);
    EXPECT_LT(s, 45.4);
  }
  EXPECT_GT(distances, 31.7);
  EXPECT_LT(distances, 99.7);
}

// Of x = t²/2m, pushed by 1 N, the derivative by the mass is −t²/2m²; the residuals have nine degrees of freedom left.
// Steps of a hundredth, as of a coarse integration, would leave errors of their square.
TEST(Tune, ADeviationIsThatOfLinearLeastSquaresAtTheValueFound) {
  const TuneFolder folder;
  std::string text = "t[s],slide\n";
  std::vector<double> times, measured;
  for (int i = 1; i <= 10; ++i) {
    times.push_back(0.1 * i);
    measured.push_back(times.back() * times.back() / 4.2 + (i % 2 == 0 ? 1e-3 : -1e-3));
    text += fmt::format("{},{}\n", times.back(), measured.back());
  }
  folder.write("data.csv", text);
  TuneQuestion question;
  question.parameters = {"bodies.block.mass"};
  const TuneResult result = folder.tuned(question, R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-4, atol: 1e-6}
time: {end: 1, output: 0.1}
bodies: {block: {type: rigid, mass: 2}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {push: {type: hinge-effort, hinge: slide, value: 1}}
)");
  ASSERT_TRUE(result.converged()) << result.trouble;
  const double mass = result.parameters[0].value;
  double squares = 0, slopes = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double square = times[i] * times[i];
    squares += std::pow(square / (2 * mass) - measured[i], 2);
    slopes += std::pow(square / (2 * mass * mass), 2);
  }
  ASSERT_TRUE(result.parameters[0].deviation);
  EXPECT_NEAR(*result.parameters[0].deviation / std::sqrt(squares / 9 / slopes), 1, 2e-6);
}

// x = t²/2m, told in millimetres.
TEST(Tune, OutputsInUnitsOfTheirOwnAreComparedInThese) {
  const TuneFolder folder;
  for (const auto& [unit, scale] : {std::pair("mm", 1e3), std::pair("m", 1.0), std::pair("cm", 1e2)}) {
    std::string text = fmt::format("t[s],place[{}]\n", unit);
    for (int i = 1; i <= 10; ++i) text += fmt::format("{},{}\n", 0.1 * i, scale * 0.01 * i * i / 5);
    folder.write("data.csv", text);
    TuneQuestion question;
    question.parameters = {"bodies.block.mass"};
    const TuneResult result = folder.tuned(question, R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
time: {end: 1, output: 0.1}
bodies: {block: {type: rigid, mass: 2}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {push: {type: hinge-effort, hinge: slide, value: 1}}
outputs: {of: {type: hinge, hinge: slide}, place: {type: expression, value: 1000 * of.position, unit: mm}}
)");
    ASSERT_TRUE(result.converged()) << result.trouble;
    EXPECT_NEAR(result.parameters[0].value, 2.5, 1e-6) << unit;
  }
}

TEST(Tune, KeepsUnitsAndTheSameBitsWhateverTheJobs) {
  const TuneFolder folder;
  folder.measure({}, 1e-3, 3);
  TuneQuestion question;
  question.parameters = three;
  question.jobs = 1;
  const TuneResult one = folder.tuned(question);
  question.jobs = 3;
  EXPECT_EQ(json_text(tune_json(one)), json_text(tune_json(folder.tuned(question))));
  EXPECT_EQ(one.parameters[0].tuned.unit, "N/m") << "the spring's hinge slides";
  EXPECT_EQ(one.parameters[2].tuned.unit, "mm");
  EXPECT_EQ(one.parameters[2].tuned.start, 20);
}

// A pendulum tells m l / (J + m l²) alone, J about its centre: a per cent of m is J / (J − m l²) per cent of l,
// whatever the search began with and however long was measured: the errors of derivatives differ by the steps of the
// runs. More of a negative place is further from 0.
TEST(Tune, TellsSamenessInPerCentsOfTheValuesFound) {
  const TuneFolder folder;
  const double m = 1.2, l = 0.53, J = 0.8, g = 9.81;
  const double stiffness = m * g * l / (J + m * l * l);
  for (const auto& [start, milliseconds] : {std::pair(-0.4, 3000), {-0.6, 3000}, {-0.4, 2800}, {-0.6, 2500}}) {
    double x = 0.5, v = 0;
    std::string text = "t[s],h[rad]\n";
    for (int i = 0; i < milliseconds; ++i) {  // steps of 1 ms: to a millionth
      if (i % 50 == 0) text += fmt::format("{},{}\n", 0.001 * i, x);
      const double before = -stiffness * std::sin(x);
      x += 0.001 * v + 0.5e-6 * before;
      v += 0.0005 * (before - stiffness * std::sin(x));
    }
    folder.write("data.csv", text);
    const std::string scene = fmt::format(
        "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {{end: 3, output: 0.05}}\n"
        "integrator: {{name: dopri5, rtol: 1e-8, atol: 1e-10}}\n"
        "bodies: {{b: {{type: rigid, mass: {}, center_of_mass: [0, {}, 0], inertia: [1, 1, {}, 0, 0, 0]}}}}\n"
        "hinges: {{h: {{type: revolute, axis: [0, 0, 1], parent: world, child: b}}}}\n"
        "initial: {{hinges: {{h: {{position: 0.5}}}}}}\n",
        m, start, J);
    TuneQuestion question;
    question.parameters = {"bodies.b.center_of_mass.1", "bodies.b.mass"};
    const TuneResult result = folder.tuned(question, scene);
    ASSERT_TRUE(result.converged()) << result.trouble;
    const FittedValue &place = result.parameters[0], &mass = result.parameters[1];
    EXPECT_NEAR(place.value, -l, 1e-4);
    ASSERT_EQ(mass.same_as.size(), 1);
    const double expected = J / (J - m * l * l);
    EXPECT_NEAR(mass.same_as[0].second, expected, 0.01 * expected) << start;
    EXPECT_THAT(tune_text(result, "b"), HasSubstr("% more of bodies.b.center_of_mass.1"));
  }
}

// A value is at a bound where it is near beside the bounds' distance, however narrow they are; and hardly determined
// beside itself, whatever the scene begins with.
TEST(Tune, JudgesValuesByTheirBoundsAndByThemselves) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 8);
  const TuneResult wide = folder.tuned({"loads.spring.stiffness=40..80", "loads.spring.damping"});
  const double found = wide.parameters[0].value;
  TuneQuestion question;
  question.parameters = {fmt::format("loads.spring.stiffness={}..{}", found - 0.02, found + 0.02),
                         "loads.spring.damping"};
  const TuneResult narrow =
      folder.tuned(question, std::string(block).replace(std::string(block).find("stiffness: 50"), 13,
                                                        fmt::format("stiffness: {}", found - 0.01)));
  ASSERT_EQ(narrow.parameters[0].state, State::fitted);
  EXPECT_NEAR(narrow.parameters[0].value, found, 1e-3);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(*narrow.parameters[i].deviation, *wide.parameters[i].deviation, 0.01 * *wide.parameters[i].deviation);
  question.parameters = {"initial.hinges.slide.rate.0"};
  const std::string from_little =
      std::string(block).replace(std::string(block).find("rate: [0.3]"), 11, "rate: [1e-6]");
  EXPECT_THAT(tune_text(folder.tuned(question, from_little), "block"), testing::Not(HasSubstr("Hardly determined")));
}

// At rest in its place a block has no stiffness that is seen; from another start it has.
TEST(Tune, StartsLookForWhatTheSceneHides) {
  const TuneFolder folder;
  folder.measure({.damping = 0.8}, 1e-5, 2);
  std::string at_rest = block;
  at_rest.replace(at_rest.find("stiffness: 50"), 13, "stiffness: 56");
  at_rest.replace(at_rest.find("[\"20 mm\"], rate: [0.3]"), 22, "[0], rate: [0]");
  TuneQuestion question;
  question.parameters = {"loads.spring.stiffness=54..62", "initial.hinges.slide.position.0=-0.01..0.05",
                         "initial.hinges.slide.rate.0=-0.1..0.5"};
  question.starts = 4;
  const TuneResult result = folder.tuned(question, at_rest);
  EXPECT_EQ(result.agreeing, 4u);
  EXPECT_NEAR(result.parameters[0].value, 58, 0.01);
  for (const SearchEnd& end : result.starts) EXPECT_NE(end.to[0], 56) << "none keeps what the scene begins with";
}

TEST(Tune, NamesWhatTheDataCannotTellApart) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 1);
  const TuneResult result = folder.tuned({"loads.spring.stiffness", "loads.spring.damping", "bodies.block.mass",
                                          "bodies.block.inertia.2", "initial.hinges.slide.rate.0"});
  ASSERT_TRUE(result.converged()) << result.trouble;
  const FittedValue &mass = result.parameters[2], &inertia = result.parameters[3];
  ASSERT_EQ(mass.state, State::undetermined);
  EXPECT_EQ(mass.value, 2);
  ASSERT_EQ(mass.same_as.size(), 2);
  EXPECT_EQ(mass.same_as[0].first, 0);
  EXPECT_NEAR(mass.same_as[0].second, -1, 0.01);
  EXPECT_EQ(mass.same_as[1].first, 1);
  EXPECT_NEAR(mass.same_as[1].second, -1, 0.01);
  EXPECT_EQ(inertia.state, State::undetermined);
  EXPECT_TRUE(inertia.same_as.empty());
  EXPECT_EQ(result.parameters[4].state, State::fitted);
  const std::string text = tune_text(result, "block");
  EXPECT_THAT(text, HasSubstr("Not determined: bodies.block.mass. To these data 1 % more of it does the same as 1 % "
                              "less of loads.spring.stiffness and 1 % less of loads.spring.damping"));
  EXPECT_THAT(text, HasSubstr("bodies.block.inertia.2. To these data it has no effect"));
}

TEST(Tune, SaysThatAModelLacksSomething) {
  const TuneFolder folder;
  folder.measure({}, 1e-5, 1);
  const TuneResult result = folder.tuned({"loads.spring.stiffness"});
  ASSERT_TRUE(result.columns[0].correlation);
  EXPECT_GT(*result.columns[0].correlation, 0.8);
}

/// The residual of a scene that has the values that an interrupted search tells.
double residual_at_nearest(const TuneFolder& folder, const TuneResult& result) {
  SceneValues values = folder.prepared().values;
  std::string told = "came";
  for (const std::string& setting : result.nearest->settings) {
    const std::size_t at = setting.find('=');
    values.set(setting.substr(0, at), Value(setting.substr(at + 1)), "the test");
    told += " --set '" + setting + "'";
  }
  EXPECT_THAT(interrupted_text(result), HasSubstr(told));
  TuneQuestion question;
  question.parameters = three;
  question.data = (folder / "data.csv").string();
  return tune(study::prepare(std::move(values), test::plugins()), test::plugins(), question).before;
}

// Whoever interrupts a long search goes on from where it was: with the values told the scene has the residual told,
// up to their nine digits. Of many starts most runs are those that are drawn.
TEST(Tune, AnInterruptedSearchTellsTheNearestRun) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 3);
  for (const std::size_t starts : {1, 1000}) {
    TuneQuestion question;
    question.parameters = three;
    question.jobs = 1;
    question.starts = starts;
    int asked = 0;
    question.control.interrupted = [&] { return ++asked > 20000; };
    const TuneResult result = folder.tuned(question);
    ASSERT_TRUE(result.interrupted && result.nearest) << asked;
    EXPECT_LT(result.nearest->residual, 0.5 * result.before);
    EXPECT_NEAR(residual_at_nearest(folder, result), result.nearest->residual, 1e-6 * result.nearest->residual);
  }
}

TEST(Tune, AnInterruptedSearchTellsTheScenesRunWhereNoOtherHasEnded) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 3);
  TuneQuestion question;
  question.parameters = three;
  question.jobs = 1;
  for (int most = 0; most < 10000; ++most) {
    int asked = 0;
    question.control.interrupted = [&] { return ++asked > most; };
    const TuneResult result = folder.tuned(question);
    ASSERT_TRUE(result.interrupted);
    ASSERT_EQ(result.nearest.has_value(), result.before > 0);
    if (!result.nearest) continue;
    EXPECT_EQ(result.nearest->residual, result.before);
    return;
  }
  ADD_FAILURE() << "the run did not end";
}

TEST(Tune, StopsAtBoundsAndFindsTheLowestOfManyMinima) {
  const TuneFolder folder;
  folder.measure({}, 1e-3, 1);
  const TuneResult bounded = folder.tuned({"loads.spring.stiffness=40..52 N/m", "loads.spring.damping"});
  EXPECT_EQ(bounded.parameters[0].state, State::at_bound);
  EXPECT_NEAR(bounded.parameters[0].value, 52, 0.1);
  EXPECT_FALSE(bounded.parameters[0].deviation);
  EXPECT_TRUE(bounded.parameters[1].deviation);

  Truth far;
  far.stiffness = 200;
  far.damping = 0.8;  // the scene's
  folder.measure(far, 1e-3, 1);
  TuneQuestion question;
  question.parameters = {"loads.spring.stiffness=30..500", "initial.hinges.slide.position.0"};
  const TuneResult alone = folder.tuned(question);
  EXPECT_GT(std::abs(alone.parameters[0].value - 200), 20);
  question.starts = 6;
  const TuneResult many = folder.tuned(question);
  EXPECT_NEAR(many.parameters[0].value, 200, 4 * many.parameters[0].deviation.value());
  EXPECT_GT(many.agreeing, 0);
  EXPECT_LT(many.agreeing, 6);
}

// With data of its own equations a fit leaves rounding, which differs from start to start.
TEST(Tune, StartsThatAgreeAreNoOtherMinima) {
  TuneResult result;
  result.data.times = {0, 1};
  result.starts = {{{}, {}, 1e-12, true, true, "a"}, {{}, {}, 2e-12, true, true, "b"}};
  result.agreeing = 2;
  EXPECT_THAT(tune_text(result, "block"), HasSubstr("2 of 2 starts came to this minimum.\n"));
  result.starts.push_back({{}, {}, 3e-6, true, false, "c"});
  EXPECT_THAT(tune_text(result, "block"), HasSubstr("minimum; the next lowest has a residual 3e+06 times as large"));
  result.starts.front().residual = 0;
  EXPECT_THAT(tune_text(result, "block"), HasSubstr("minimum; the next lowest has a residual of 3e-06."));
}

TEST(Tune, GoesRoundRunsThatFail) {
  const TuneFolder folder;
  folder.measure({}, 1e-3, 2);
  TuneQuestion question;
  question.parameters = {"loads.spring.stiffness=1..400", "initial.hinges.slide.rate.0=-3..3"};
  question.starts = 6;
  // Runs that swing far end before the data does.
  const std::string stops = std::string(block) + "events: {far: {hinge: slide, value: 0.09, stop: true}}\n";
  const TuneResult result = folder.tuned(question, stops);
  ASSERT_TRUE(result.converged()) << result.trouble;
  EXPECT_GT(result.failed, 0);
  EXPECT_THAT(result.last_failure, HasSubstr("an event of the scene ends it there"));
  EXPECT_NEAR(result.parameters[0].value, 58, 4 * result.parameters[0].deviation.value());
  // Where no run begins there is no fit, and the reason is said.
  question.starts = 1;
  const std::string never = std::string(block) + "events: {far: {hinge: slide, value: 0.021, stop: true}}\n";
  EXPECT_THAT(folder.tuned(question, never).trouble, HasSubstr("an event of the scene ends it there"));
}
}  // namespace
}  // namespace withy::campaign
