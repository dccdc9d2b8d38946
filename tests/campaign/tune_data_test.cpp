// The data of a fit and the scene that it writes: which columns are compared and by what they weigh, what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/campaign/tune.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/campaign/tune_fixture.hpp"

namespace withy::campaign {
namespace {

using test::block;
using test::noise;
using test::three;
using test::Truth;
using test::TuneFolder;
using testing::HasSubstr;

// The least squares that two deviations ask for, whichever is said first: with an angle's deviation for its rate too
// the fit would be another one.
TEST(TuneData, ADeviationIsThatOfTheResultOfItsName) {
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
TEST(TuneData, ColumnsThatDoNotChangeAreLeftOutUnlessAskedFor) {
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

// The moment about a hinge's own axis is 0: its digits are other ones in each run, and beside their range as a weight
// the data seemed to depend on nothing.
TEST(TuneData, ColumnsThatRoundingAloneChangesAreLeftOutUnlessTheyHaveADeviation) {
  const TuneFolder folder;
  SceneValues scene = SceneValues::read(WITHY_SOURCES "/scenes/gallery/four-bar.yaml");
  scene.set_text("time.end=0.3");
  const study::Prepared truth = study::prepare(scene, test::plugins());
  ResultColumns results(truth.model(), *truth.equations, truth.scene.outputs);
  TuneQuestion question;
  question.data = "own.csv";
  std::string text = csv_head(results.columns());
  study::RunSettings settings;
  settings.look_beyond = false;
  settings.output = [&](const State& state, std::size_t) { text += csv_line(results.row(state)); };
  study::run(truth, test::plugins(), settings);
  question.text = text;
  question.parameters = {"bodies.crank.mass"};
  scene.set_text("bodies.crank.mass=1.4");
  const study::Prepared other = study::prepare(scene, test::plugins());
  const TuneResult result = tune(other, test::plugins(), question);
  ASSERT_TRUE(result.converged()) << result.trouble;
  EXPECT_NEAR(result.parameters[0].value, 1.2, 1e-5);
  EXPECT_THAT(result.data.ignored, testing::Contains("base.mz (changes by rounding alone)"));
  EXPECT_THAT(result.data.ignored, testing::Not(testing::Contains(HasSubstr("base.fx"))));
  question.deviations = {"base.mz=0.1"};
  EXPECT_NEAR(tune(other, test::plugins(), question).parameters[0].value, 1.2, 1e-5);
  question.deviations.clear();
  question.outputs = {"motor", "base.mz"};
  try {
    tune(other, test::plugins(), question);
    ADD_FAILURE() << "nothing was refused";
  } catch (const study::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("own.csv:1:1: rounding alone changes base.mz"));
  }
}

TEST(TuneData, WritesItsSceneInPlaceOfAnOlderFileButOfNoneThatIsRead) {
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

TEST(TuneData, WritesASceneThatFits) {
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

TEST(TuneData, TellsAllThatIsWrongAtOnce) {
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
