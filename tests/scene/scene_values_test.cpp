/// \file
/// A scene as a value: operations on values mean what the same words in a file or after `--set` mean.
#include "withy/scene/scene_values.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "scene_fixture.hpp"
#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/one_line.hpp"
#include "withy/scene/same_content.hpp"

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

TEST_F(SceneValuesTest, CopiesOfAValueShareUntilOneIsChanged) {
  Value inner = Value::map({{"x", Value(1.0)}, {"list", Value::list({Value(2.0), Value(3.0)})}});
  Value first = Value::map({{"inner", inner}, {"other", inner}});
  Value second = first;
  EXPECT_TRUE(second.shares(first));
  Value& changed = second.members()[0].second;
  changed.set("x", Value(5.0));
  changed.members()[1].second.items().pop_back();
  EXPECT_FALSE(second.shares(first));
  EXPECT_EQ(second.at("inner").number_at("x"), 5.0);
  EXPECT_EQ(second.at("inner").at("list").numbers(), std::vector{2.0});
  // What was not changed is still one, and what has shared it is as it was.
  EXPECT_TRUE(second.at("other").shares(first.at("other")));
  EXPECT_TRUE(first.at("inner").shares(inner));
  EXPECT_EQ(inner.number_at("x"), 1.0);
  EXPECT_EQ(inner.at("list").numbers(), (std::vector{2.0, 3.0}));
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

TEST_F(SceneValuesTest, ModesAreFoundByTheRolesOfParameters) {
  const Scene scene = make_scene(values, registry);
  ASSERT_EQ(scene.modes.size(), 1u);
  EXPECT_EQ(scene.modes[0].body, "boom");
  ASSERT_EQ(scene.modes[0].counts.size(), 1u);
  const ModeCount& count = scene.modes[0].counts[0];
  EXPECT_EQ(count.path, "bending_y.modes");
  EXPECT_EQ(count.strain, "bending_y");
  EXPECT_EQ(count.modes, 2u);
  EXPECT_EQ(count.most, 1000u);
  EXPECT_EQ(count.family_path, "bending_y.family");
  EXPECT_EQ(count.family_id(), "clamped-free");
}

/// Studies vary the family of bending by its path, and tell the others too.
TEST_F(SceneValuesTest, FamiliesOfAllStrainsAreFound) {
  values.set("bodies.boom.torsion.stiffness", Value(50.0), "the test");
  values.set("bodies.boom.torsion.inertia", Value(0.01), "the test");
  values.set("bodies.boom.torsion.family", Value(std::string("craig-bampton")), "the test");
  values.set("bodies.boom.extension.stiffness", Value(1e4), "the test");
  const Scene scene = make_scene(values, registry);
  const std::vector<ModeCount>& counts = scene.modes.at(0).counts;
  ASSERT_EQ(counts.size(), 3u);
  EXPECT_EQ(counts[0].family_path, "bending_y.family");
  EXPECT_EQ(counts[1].strain, "torsion");
  EXPECT_EQ(counts[1].family_id(), "craig-bampton");
  EXPECT_EQ(counts[1].family_path, "");
  EXPECT_EQ(counts[2].family_id(), "clamped-free") << "as nothing else is said";
}

TEST_F(SceneValuesTest, FormulationsStandInTheirRanks) {
  const std::vector<std::string> studied = studied_formulations(registry);
  const auto place = [&](const char* id) { return std::find(studied.begin(), studied.end(), id) - studied.begin(); };
  EXPECT_LT(place("ruthless"), place("linear"));
  EXPECT_LT(place("linear"), place("consistent"));
  EXPECT_LT(place("consistent"), place("quadratic"));
  EXPECT_LT(place("quadratic"), place("exact"));
  for (const char* aside : {"auto", "inconsistent", "rate-linear"})
    EXPECT_EQ(std::count(studied.begin(), studied.end(), aside), 0) << aside;
  std::vector<std::string> rungs;
  for (const RankedFormulation& rung : formulation_rungs(registry)) rungs.push_back(rung.id);
  EXPECT_EQ(rungs, (std::vector<std::string>{"ruthless", "quadratic", "exact"}));
}

// Of a thousand wrong names nobody reads what each may have meant; each is reported.
TEST_F(SceneValuesTest, SuggestionsEndWhereMillionsOfNamesWouldBeCompared) {
  constexpr int bodies = 300;
  std::string text = "format: withy/1\nbodies:\n";
  for (int i = 0; i < bodies; ++i) text += "  body" + std::to_string(i) + ": {type: rigid, mass: 1}\n";
  text += "hinges:\n";
  for (int i = 0; i < bodies; ++i)
    text += "  h" + std::to_string(i) + ": {type: weld, parent: world, child: bady" + std::to_string(i) + "}\n";
  values = SceneValues::parse(text, "s.yaml");
  const std::string all = problem();
  const auto count = [&](const std::string& what) {
    int n = 0;
    for (std::size_t at = all.find(what); at != std::string::npos; at = all.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("no body \"bady"), bodies);
  EXPECT_EQ(count("did you mean"), 100);
}

// Hinges in any order make one model: parents before children, else as they are given.
TEST_F(SceneValuesTest, HingesAreOrderedParentsFirstWhateverTheirOrder) {
  values = SceneValues::parse(R"(format: withy/1
bodies: {a: {type: rigid, mass: 1}, b: {type: rigid, mass: 1}, c: {type: rigid, mass: 1}, d: {type: rigid, mass: 1}}
hinges:
  hc: {type: free, parent: b, child: c}
  hb: {type: free, parent: a, child: b}
  hd: {type: free, parent: world, child: d}
  ha: {type: free, parent: world, child: a}
)",
                              "s.yaml");
  const Scene scene = make_scene(values, registry);
  std::vector<std::string> order;
  for (const HingeNode& hinge : scene.model->hinges()) order.push_back(hinge.name);
  EXPECT_EQ(order, (std::vector<std::string>{"hd", "ha", "hb", "hc"}));
  for (const std::string& name : order)
    EXPECT_EQ(scene.model->hinges()[static_cast<std::size_t>(scene.model->hinge(name))].name, name);
}

TEST_F(SceneValuesTest, ContentIsTheSameWhateverTheOrderAndPlaces) {
  const auto root = [](const std::string& text) { return SceneValues::parse(text, "t").root(); };
  EXPECT_TRUE(same_content(root("{a: 1, b: [x, 2]}"), root("b: [x, 2]\na: 1.0")));
  for (const char* other : {"{a: 1, b: [2, x]}", "{a: 1, b: [x, 2], c: 1}", "{a: 1, c: [x, 2]}", "{a: '1', b: [x, 2]}",
                            "{a: 1.0000000000000002, b: [x, 2]}"})
    EXPECT_FALSE(same_content(root("{a: 1, b: [x, 2]}"), root(other))) << other;
}

/// Bodies whose plugins are given the same are one object, with its modes and integrals; frames and names are their
/// own.
TEST(EqualBodies, AreOneObjectAndTheirProblemsEachTheirOwn) {
  Registry registry;
  enroll_static_plugins(registry);
  const std::string text = R"(format: withy/1
time: {end: 1}
bodies:
  a: {type: beam, length: 0.9, mass_per_length: 1.3, bending_y: {stiffness: 112, modes: 2}}
  b: {type: beam, length: "90 cm", mass_per_length: 1.3, bending_y: {stiffness: 112, modes: 2}, frames: {eye: {at: 0.5}}}
  c: {type: beam, length: 0.9, mass_per_length: 1.3, bending_y: {stiffness: 112.00000000000001, modes: 2}}
hinges:
  a: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  b: {type: revolute, axis: [0, 0, 1], parent: a.tip, child: b}
  c: {type: revolute, axis: [0, 1, 0], parent: b.eye, child: c}
)";
  const Scene scene = parse_scene(text, "s.yaml", registry);
  const Model& model = *scene.model;
  const auto body = [&](const char* name) { return model.bodies()[static_cast<std::size_t>(model.body(name))].body; };
  const auto hinge = [&](const char* name) {
    return model.hinges()[static_cast<std::size_t>(model.hinge(name))].hinge;
  };
  EXPECT_EQ(body("a"), body("b"));
  EXPECT_NE(body("a"), body("c"));
  EXPECT_EQ(hinge("a"), hinge("b"));
  EXPECT_NE(hinge("a"), hinge("c"));
  EXPECT_TRUE(model.find_frame("b.eye"));
  EXPECT_FALSE(model.find_frame("a.eye"));

  // A plugin's own complaint comes once for each body that gives cause for it.
  std::string bad = replaced(text, "stiffness: 112,", "stiffness: [[0, 112], [0.5, 112]],");
  bad = replaced(bad, "stiffness: 112,", "stiffness: [[0, 112], [0.5, 112]],");
  const std::string found = problems(bad, registry);
  EXPECT_THAT(found, testing::HasSubstr("/bodies/a/bending_y/stiffness"));
  EXPECT_THAT(found, testing::HasSubstr("/bodies/b/bending_y/stiffness"));
}

/// Outputs that a scene does not define are what their names say, in every way that they come in; a scene so written is
/// one again.
TEST_F(SceneValuesTest, AnOutputIsWhatItsNameSays) {
  const std::vector<std::pair<std::string, std::string>> said = {
      {"shoulder.effort", "{type: effort, hinge: shoulder}"},
      {"shoulder.effort@motor", "{type: effort, hinge: shoulder, of: motor}"},
      {"shoulder.motion", "{type: hinge, hinge: shoulder}"},
      {"shoulder.acceleration", "{type: hinge, hinge: shoulder, show: acceleration}"},
      {"root.reaction", "{type: reaction, hinge: root}"},
      {"boom.tip.acceleration", "{type: frame, of: boom.tip, show: acceleration}"},
      {"boom.tip.velocity@hub.out", "{type: frame, of: boom.tip, in: hub.out, show: velocity}"},
      {"boom.tip.distance@hub", "{type: distance, to: boom.tip, from: hub}"},
      {"hub.distance@boom.tip", "{type: distance, to: hub, from: boom.tip}"},
      {"boom.motion", "{type: frame, of: boom}"},
      {"hub.out.gyro", "{type: gyro, of: hub.out}"},
      {"boom.section@0.25", "{type: section, of: boom, at: 0.25}"},
      {"boom.section@25e-2", "{type: section, of: boom, at: 0.25}"},
      {"boom.energy", "{type: energy, of: boom}"},
      {"motor.power", "{type: power, of: motor}"},
      {"momentum", "{type: momentum}"}};
  std::string list, defined;
  for (const auto& [name, definition] : said) {
    SceneValues asked = values, stated = values;
    asked.set_text("outputs=" + name);
    stated.set_text("outputs.o=" + definition);
    const Scene a = make_scene(asked, registry), b = make_scene(stated, registry);
    ASSERT_EQ(a.outputs.size(), 1U) << name;
    EXPECT_EQ(a.outputs[0].name, name);
    EXPECT_TRUE(same_content(a.source.at("outputs").at(name), b.source.at("outputs").at("o"))) << name;
    EXPECT_EQ(a.settings, std::vector<std::string>{"outputs=" + name});
    list += (list.empty() ? "" : ",") + name + (name.ends_with("acceleration") ? ".max" : "");
  }
  values.set_text("outputs=[" + list + "]").set_text("outputs=motor.power");
  EXPECT_EQ(make_scene(values, registry).outputs.size(), said.size());
  EXPECT_EQ(make_scene(SceneValues::parse(in_one_line(values.root()), "again.yaml"), registry).outputs.size(),
            said.size());
  values.set_text("outputs.load={type: power, of: motor}").set_text("outputs=load");
  EXPECT_EQ(make_scene(values, registry).outputs.size(), said.size() + 1) << "it is defined";
}

TEST_F(SceneValuesTest, NamesOfOutputsThatSayNothingAreReported) {
  const auto of = [&](const std::string& outputs) {
    SceneValues asked = values;
    asked.set_text("outputs=" + outputs);
    std::swap(asked, values);
    const std::string text = problem();
    std::swap(asked, values);
    return text;
  };
  EXPECT_EQ(of("shoulder.efort"),
            "--set 'outputs=shoulder.efort': /outputs: got \"shoulder.efort\", which names no output; did you mean "
            "'shoulder.effort'?");
  EXPECT_THAT(of("sholder.effort"), testing::HasSubstr("/outputs/sholder.effort/hinge: no hinge \"sholder\"; did you"));
  EXPECT_THAT(of("[boom.tipp.gyro, boom.section@2, boom.section]"),
              testing::AllOf(testing::HasSubstr("/outputs/boom.tipp.gyro/of: no frame \"boom.tipp\"; did you mean"),
                             testing::HasSubstr("there is no section at 2 m"),
                             testing::HasSubstr("/outputs/boom.section/at: missing")));
  EXPECT_THAT(of("boom.tip.distance@hub.aut"), testing::HasSubstr("no frame \"hub.aut\"; did you mean"));
  EXPECT_THAT(of("{shoulder.effort: {type: effort, hinge: root}}"), testing::HasSubstr("got name \"shoulder.effort\""));
  EXPECT_THAT(of("hub.gyro@own"), testing::HasSubstr("names no output"));
  EXPECT_THAT(of("boom.section@0.1m"), testing::HasSubstr("has no place behind the @"));
}

}  // namespace
}  // namespace withy::test
