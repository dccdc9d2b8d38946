// Fits to measured data: they find what made the data, know how well they do, and name what the data cannot tell.
#include "withy/campaign/tune.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "withy/campaign/random.hpp"
#include "withy/campaign/tune_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/study/input_error.hpp"
#include "withy/tests/results/scratch.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::campaign {
namespace {

using testing::HasSubstr;
using State = FittedValue::State;

constexpr const char* block = R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
time: {end: 4, output: 0.02}
bodies:
  block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 50, damping: 0.8}   # as the maker says
initial: {hinges: {slide: {position: ["20 mm"], rate: [0.3]}}}
)";

/// What makes the data: m ẍ + c ẋ + k x = 0 in closed form.
struct Truth {
  double stiffness = 58, damping = 1.1, start = 0.025, rate = 0.3;
  double mass = 2;
  [[nodiscard]] double at(double t) const {
    const double decay = damping / (2 * mass), omega = std::sqrt(stiffness / mass - decay * decay);
    return std::exp(-decay * t) * (start * std::cos(omega * t) + (rate + decay * start) / omega * std::sin(omega * t));
  }
};

/// Normally distributed, by Box and Muller.
double noise(std::uint64_t seed, std::uint64_t i) {
  return std::sqrt(-2 * std::log(Key(seed)["a"][i].uniform())) *
         std::cos(2 * std::numbers::pi * Key(seed)["b"][i].uniform());
}

struct TuneFolder : test::Scratch {
  /// 160 rows at times that are no outputs of the scene; every seventh place was not measured.
  void measure(const Truth& truth, double deviation, std::uint64_t seed) const {
    std::string text = "t[ms],operator,slide[mm]\n";
    for (std::uint64_t i = 0; i < 160; ++i) {
      const double t = 0.0249 * static_cast<double>(i);
      const double x = truth.at(t) + deviation * noise(seed, i);
      text += i % 7 == 3 ? fmt::format("{},Ann,\n", 1e3 * t) : fmt::format("{},Ann,{}\n", 1e3 * t, 1e3 * x);
    }
    write("data.csv", text);
  }
  [[nodiscard]] study::Prepared prepared(const std::string& text = block) const {
    return study::prepare(SceneValues::parse(text, "block.yaml"), test::plugins());
  }
  [[nodiscard]] TuneResult tuned(TuneQuestion question, const std::string& text = block) const {
    question.data = (*this / "data.csv").string();
    return tune(prepared(text), test::plugins(), question);
  }
  [[nodiscard]] TuneResult tuned(const std::vector<std::string>& parameters) const {
    TuneQuestion question;
    question.parameters = parameters;
    return tuned(question);
  }
};

const std::vector<std::string> three = {"loads.spring.stiffness", "loads.spring.damping",
                                        "initial.hinges.slide.position.0"};

// The least squares that two deviations ask for, whichever is said first: with an angle's deviation for its rate too
// the fit would be another one.
TEST(Tune, ADeviationIsThatOfTheResultOfItsName) {
  const TuneFolder folder;
  const Truth truth;
  std::string text = "t[s],slide,slide.rate\n";
  for (std::uint64_t i = 0; i < 160; ++i) {
    const double t = 0.0249 * static_cast<double>(i), h = 1e-5;
    const double rate = (truth.at(t + h) - truth.at(t - h)) / (2 * h);
    text += fmt::format("{},{},{}\n", t, truth.at(t) + 1e-3 * noise(1, i), rate + 0.03 * noise(2, i));
  }
  folder.write("data.csv", text);
  const auto tuned = [&](std::vector<std::string> deviations, std::vector<std::string> outputs = {}) {
    TuneQuestion question;
    question.parameters = three;
    question.deviations = std::move(deviations);
    question.outputs = std::move(outputs);
    return folder.tuned(question);
  };
  const TuneResult result = tuned({"slide=1 mm", "slide.rate=0.03 m/s"});
  ASSERT_TRUE(result.converged()) << result.trouble;
  EXPECT_EQ(result.data.columns[0].deviation, 1e-3);
  EXPECT_EQ(result.data.columns[1].deviation, 0.03);
  const TuneResult turned = tuned({"slide.rate=0.03 m/s", "slide=1 mm"});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(turned.parameters[i].value, result.parameters[i].value);
  EXPECT_FALSE(tuned({"slide=1 mm"}).data.columns[1].deviation_given);
  EXPECT_EQ(tuned({}, {"slide"}).data.columns.size(), 1U);
}

// Tables of runs have columns that stay as they are, as momenta of what is held: they weigh nothing, and say so.
TEST(Tune, ColumnsThatDoNotChangeAreLeftOutUnlessAskedFor) {
  const TuneFolder folder;
  const Truth truth;
  std::string text = "t[s],slide,angular_momentum.z\n";
  for (std::uint64_t i = 0; i < 160; ++i)
    text += fmt::format("{},{},0\n", 0.0249 * static_cast<double>(i), truth.at(0.0249 * static_cast<double>(i)));
  folder.write("data.csv", text);
  TuneQuestion question;
  question.parameters = three;
  const TuneResult result = folder.tuned(question);
  ASSERT_TRUE(result.converged()) << result.trouble;
  EXPECT_NEAR(result.parameters[0].value, truth.stiffness, 1e-3);
  EXPECT_EQ(result.data.columns.size(), 1U);
  EXPECT_EQ(result.data.ignored, (std::vector<std::string>{"angular_momentum.z (does not change)"}));
  question.outputs = {"slide", "angular_momentum.z"};
  EXPECT_THROW(folder.tuned(question), std::runtime_error);
}

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

// Whoever interrupts a long search goes on from where it was: with the values told the scene has the residual told.
TEST(Tune, AnInterruptedSearchTellsTheNearestRun) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 3);
  TuneQuestion question;
  question.parameters = three;
  question.jobs = 1;
  int asked = 0;
  question.control.interrupted = [&] { return ++asked > 20000; };
  const TuneResult result = folder.tuned(question);
  ASSERT_TRUE(result.interrupted && result.nearest) << asked;
  EXPECT_LT(result.nearest->residual, 0.5 * result.before);
  SceneValues values = folder.prepared().values;
  std::string told = "came";
  for (const std::string& setting : result.nearest->settings) {
    const std::size_t at = setting.find('=');
    values.set(setting.substr(0, at), Value(setting.substr(at + 1)), "the test");
    told += " --set '" + setting + "'";
  }
  EXPECT_THAT(interrupted_text(result), HasSubstr(told));
  const study::Prepared there = study::prepare(std::move(values), test::plugins());
  question.data = (folder / "data.csv").string();
  question.control = {};
  // Values are told with nine digits.
  EXPECT_NEAR(tune(there, test::plugins(), question).before, result.nearest->residual, 1e-6 * result.nearest->residual);
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

TEST(Tune, WritesItsSceneInPlaceOfAnOlderFileButOfNoneThatIsRead) {
  const TuneFolder folder;
  folder.write("scene.yaml", block);
  folder.write("old.yaml", "mine");
  folder.write("data.csv", "t[s],slide\n");
  const auto name = [&](const char* file) { return (folder / file).string(); };
  SceneValues values = SceneValues::read(name("scene.yaml"));
  const study::Prepared prepared = study::prepare(values, test::plugins());
  const std::vector<study::Change> changes = {{"loads.spring.stiffness", Value(58.0)}};
  EXPECT_NO_THROW(check_written(prepared, name("old.yaml"), name("data.csv"), test::plugins()));
  write_changed(values, changes, name("old.yaml"), test::plugins());
  EXPECT_THAT(folder.read("old.yaml"), HasSubstr("stiffness: 58, damping: 0.8}   # as the maker says"));
  for (const char* read : {"scene.yaml", "data.csv"})
    EXPECT_THROW(check_written(prepared, name(read), name("data.csv"), test::plugins()), study::InputError) << read;
  EXPECT_THROW(write_changed(values, changes, name("scene.yaml"), test::plugins()), study::InputError);
  EXPECT_EQ(folder.read("scene.yaml"), block);
  // What the command line changes is told before anything is computed; outputs that it asks for change no scene.
  values.choose_formulation("linear", "the test");
  EXPECT_THROW(check_written(study::prepare(values, test::plugins()), name("old.yaml"), "", test::plugins()),
               study::InputError);
  SceneValues asked = SceneValues::read(name("scene.yaml"));
  asked.set_text("outputs=[slide.effort]");
  EXPECT_NO_THROW(check_written(study::prepare(asked, test::plugins()), name("old.yaml"), "", test::plugins()));
  EXPECT_NO_THROW(write_changed(asked, changes, name("old.yaml"), test::plugins()));
}

TEST(Tune, WritesASceneThatFits) {
  const TuneFolder folder;
  folder.measure({}, 1e-4, 2);
  const TuneResult result = folder.tuned(three);
  std::vector<TunedValue> all;
  for (const FittedValue& p : result.parameters) all.push_back(p.tuned);
  const std::string file = (folder / "new.yaml").string();
  write_changed(folder.prepared().values, changes_of(folder.prepared().values, all, result.values()), file,
                test::plugins());
  const std::string text = folder.read("new.yaml");
  EXPECT_THAT(text, HasSubstr("# as the maker says"));
  EXPECT_THAT(text, HasSubstr(fmt::format("{} mm", result.parameters[2].value)));
  // A fit of the new scene begins at its end.
  TuneQuestion question;
  question.parameters = three;
  const TuneResult again = folder.tuned(question, text);
  EXPECT_DOUBLE_EQ(again.before, result.after);
  EXPECT_NEAR(again.after, again.before, 1e-6 * again.before);
}

/// What is said of a question about data.
std::string refusal(const TuneFolder& folder, const TuneQuestion& question, const std::string& data) {
  folder.write("data.csv", data);
  try {
    static_cast<void>(folder.tuned(question));
  } catch (const study::InputError& e) {
    return e.what();
  }
  return "nothing was refused";
}

TEST(Tune, TellsAllThatIsWrongAtOnce) {
  const TuneFolder folder;
  const std::string data = "t[s],slide[kg],slyde.rate[m/s],note\n0,1,2,a\n0.1,x,2,b\n0.1,1,2,c\n0.2,1,2\n9,1,2,d\n";
  TuneQuestion question;
  question.parameters = {"loads.sprong.stiffness", "bodies.block.type", "loads.spring.damping=2..1",
                         "bodies.block.mass=3..5", "loads.spring.stiffness=1 kg.."};
  question.deviations = {"slide=-1 mm"};
  for (const std::string& text : {data, "\xEF\xBB\xBF" + data}) {  // with the byte-order mark of spreadsheets too
    const std::string what = refusal(folder, question, text);
    EXPECT_THAT(what, testing::Not(HasSubstr("need a column t")));
    for (const char* part :
         {"--parameters loads.sprong.stiffness: no \"sprong\" here to change; did you mean 'spring'?",
          "--parameters bodies.block.type: is no number", "--parameters loads.spring.damping: got bounds 2 and 1",
          "--parameters bodies.block.mass: the scene's 2 kg lies outside of the bounds 3 and 5",
          "--parameters loads.spring.stiffness: bound \"1 kg\": 'kg' is a wrong unit here",
          "data.csv:1:6: column \"slide\": 'kg' is a wrong unit here",
          "data.csv:1:16: no result \"slyde.rate\"; did you mean 'slide.rate'?",
          "data.csv:3:5: got \"x\"; need a number, or nothing", "data.csv:4:1: the time does not increase",
          "data.csv:5:1: got 3 cells; the head has 4", "data.csv:6:1: 9 s lies after the scene's end, 4 s",
          "--deviations \"slide=-1 mm\": need a number > 0"})
      EXPECT_THAT(what, HasSubstr(part));
  }
  EXPECT_THAT(refusal(folder, {}, "t[s];slide[m]\n0;1\n0,1;2\n"),
              HasSubstr("data.csv:1:1: got semicolons between the cells; need commas"));
}

}  // namespace
}  // namespace withy::campaign
