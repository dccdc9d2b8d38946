/// \file
/// A scene as a value: operations on values mean what the same words in a file or after `--set` mean.
#include "withy/scene/scene_values.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "scene_fixture.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/names.hpp"

namespace withy::test {
namespace {

class SceneValuesTest : public SceneTest {
 protected:
  SceneValues values = SceneValues::parse(good_scene, "s.yaml");

  std::string problem() {
    try {
      make_scene(values, registry);
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(SceneValuesTest, CopiesVaryOnTheirOwn) {
  SceneValues other = values;
  other.set("time.end", Value(2.5), "other").choose_formulation("ruthless", "other");
  EXPECT_EQ(make_scene(values, registry).end, 1.0);
  EXPECT_EQ(make_scene(values, registry).formulation_name, "quadratic");
  EXPECT_EQ(make_scene(other, registry).end, 2.5);
  EXPECT_EQ(make_scene(other, registry).formulation_name, "ruthless");
}

TEST_F(SceneValuesTest, TypedValuesAreThoseOfTheText) {
  SceneValues text = values;
  text.set_text("bodies.hub.mass=0.1").set_text("gravity.1=-1.62").set_text("limits.deflection=0.2");
  values.set("bodies.hub.mass", Value(0.1), "v").set("gravity.1", Value(-1.62), "v");
  values.set("limits.deflection", Value(0.2), "v");
  const Scene a = make_scene(text, registry), b = make_scene(values, registry);
  EXPECT_EQ(a.source.at("bodies").at("hub").number_at("mass"), b.source.at("bodies").at("hub").number_at("mass"));
  EXPECT_EQ(a.model->gravity(), b.model->gravity());
  EXPECT_EQ(a.deflection_limit, b.deflection_limit);
}

TEST_F(SceneValuesTest, ProblemsOfAllOperationsAreReportedAtOnceInTheWordsOfTheFile) {
  values.set("bodies.hub.mass", Value(-1.0), "variation 1").set("bodies.hubb.mass", Value(1.0), "variation 2");
  values.set_text("tme.end=1").body_formulation("boom", "quadratik", "variation 3");
  EXPECT_EQ(problem(),
            "variation 3: /bodies/boom/formulation: no formulation plugin \"quadratik\"; did you mean "
            "'quadratic'?; available: " +
                listed(registry.ids<Formulation>()) +
                "\n--set 'tme.end=1': /tme: unknown key \"tme\"; did you mean 'time'?\n"
                "variation 2: /bodies: no \"hubb\" here to change; did you mean 'hub'?\n"
                "variation 1: /bodies/hub/mass: got -1; need finite >= 0 [kg]");
}

TEST_F(SceneValuesTest, NumbersThatAreNoneAreRefused) {
  values.set("time.end", Value(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(problem(), "nan: /time/end: got nan; need finite >= 0 [s]");
}

TEST_F(SceneValuesTest, ChoicesByIdKeepOptionsOfTheSamePlugin) {
  values.choose_integrator(Value::map({{"name", Value(std::string("dopri5"))}, {"rtol", Value(1e-9)}}), "v");
  values.choose_integrator("dopri5", "v");
  EXPECT_EQ(make_scene(values, registry).source.at("integrator").number_at("rtol"), 1e-9);
  values.choose_integrator("dop853", "v");
  EXPECT_EQ(make_scene(values, registry).integrator_name, "dop853");
  EXPECT_EQ(make_scene(values, registry).source.at("integrator").number_at("rtol"), 1e-6);
}

TEST_F(SceneValuesTest, InitialStatesKeepTheirBits) {
  Scene scene = make_scene(values, registry);
  for (double& y : scene.initial.y) y = 0.1 + y / 3;
  scene.initial.time = 0.7;
  values.initial(*scene.model, scene.initial, "state");
  const Scene again = make_scene(values, registry);
  EXPECT_EQ(again.initial.y, scene.initial.y);
  EXPECT_EQ(again.initial.time, scene.initial.time);
}

TEST_F(SceneValuesTest, FindsWhatIsThere) {
  EXPECT_EQ(values.find("bodies.boom.bending_y.modes")->number(), 2);
  EXPECT_EQ(values.find("gravity.1")->number(), -9.81);
  EXPECT_EQ(values.find("gravity.3"), nullptr);
  EXPECT_EQ(values.find("bodies.mast"), nullptr);
  EXPECT_EQ(values.find(""), nullptr);
}

TEST_F(SceneValuesTest, MalformedPathsAreRefused) {
  for (const char* path : {"", ".", "time..end", ".time", "time."}) {
    SceneValues bad = values;
    bad.set(path, Value(1.0), "bad");
    ASSERT_EQ(bad.problems().errors().size(), 1u) << path;
    EXPECT_THAT(bad.problems().errors()[0].message, testing::StartsWith("need a path of keys"));
  }
}

}  // namespace
}  // namespace withy::test
