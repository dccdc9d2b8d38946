#include <gmock/gmock.h>

#include "scene_fixture.hpp"
#include "withy/core/plugin/formulation.hpp"

namespace withy::test {
namespace {

class Overrides : public SceneTest {
 protected:
  Scene read(std::vector<std::string> overrides) {
    return parse_scene(good_scene, "s.yaml", registry, {"", "", std::move(overrides)});
  }
  std::string problem(const std::string& override_text) {
    return problems(good_scene, registry, {"", "", {override_text}});
  }
};

TEST_F(Overrides, ReplaceValues) {
  const Scene s = read({"time.end=2.5", "bodies.hub.mass=3 lb", "gravity.1=-1.62", "bodies.boom.bending_y.modes=3"});
  EXPECT_EQ(s.end, 2.5);
  EXPECT_EQ(s.source.at("bodies").at("hub").number_at("mass"), 3 * 0.45359237);
  EXPECT_EQ(s.model->gravity().y(), -1.62);
  EXPECT_EQ(s.model->layout().speeds, 4u);
}

TEST_F(Overrides, AddWhatTheFormatKnowsAndTheFileLeavesOut) {
  const Scene s = read({"limits.deflection=0.2", "integrator.rtol=1e-9", "name=other",
                        "initial.hinges.shoulder.position=[30 deg]", "bodies.hub.frames.out.orientation=[0, 0, 0, 1]"});
  EXPECT_EQ(s.deflection_limit, 0.2);
  EXPECT_EQ(s.source.at("integrator").number_at("rtol"), 1e-9);
  EXPECT_EQ(s.source.at("integrator").text_at("name"), "dopri5");
  EXPECT_EQ(s.name, "other");
  EXPECT_NEAR(s.initial.y[0], 0.5235987755982988, 1e-16);  // π/6
}

TEST_F(Overrides, SetElementsOfVectorsThatTheFileLeavesOut) {
  const std::string weightless = replaced(good_scene, "gravity: [0, -9.81, 0]\n", "");
  const auto set = [&](std::vector<std::string> overrides) {
    return parse_scene(weightless, "s.yaml", registry, {"", "", std::move(overrides)});
  };
  EXPECT_EQ(set({"gravity.1=-1.62"}).model->gravity(), Eigen::Vector3d(0, -1.62, 0));
  EXPECT_EQ(set({"gravity.2=-3", "gravity.0=1 cm/s^2"}).model->gravity(), Eigen::Vector3d(0.01, 0, -3));
  EXPECT_EQ(
      set({"bodies.hub.center_of_mass.1=0.2"}).source.at("bodies").at("hub").at("center_of_mass").items()[1].number(),
      0.2);
  // Each is checked like any other; without a default, or in a file, it is the whole list that counts.
  EXPECT_THAT(problems(weightless, registry, {"", "", {"gravity.3=1"}}),
              "--set 'gravity.3=1': /gravity: got index \"3\"; need 0 to 2");
  EXPECT_THAT(problems(weightless, registry, {"", "", {"gravity.1=nan"}}),
              testing::StartsWith("--set 'gravity.1=nan': /gravity/1: got nan"));
  EXPECT_THAT(problems(replaced(good_scene, "axis: [0, 0, 1], ", ""), registry, {"", "", {"hinges.shoulder.axis.2=1"}}),
              testing::HasSubstr("/hinges/shoulder/axis: got a map"));
  EXPECT_THAT(problems(weightless + "gravity: {1: -9.81}\n", registry), testing::HasSubstr("/gravity: got a map"));
}

TEST_F(Overrides, TakeAwayWhatTheySetToNull) {
  ASSERT_EQ(read({}).model->loads().size(), 1U);
  EXPECT_EQ(read({"loads.motor=null"}).model->loads().size(), 0U);
  EXPECT_EQ(read({"loads=~"}).model->loads().size(), 0U);
  EXPECT_EQ(read({"gravity=null"}).model->gravity(), Eigen::Vector3d(0, 0, 0)) << "the default";
  EXPECT_EQ(read({"bodies.boom.damping_ratio=null"}).source.at("bodies").at("boom").number_at("damping_ratio"), 0);
  EXPECT_EQ(read({"time.end=null", "time.end=3"}).end, 3) << "in their order";
  EXPECT_THAT(problem("loads.moter=null"),
              "--set 'loads.moter=null': /loads: no \"moter\" here to take away; did you mean 'motor'?");
  EXPECT_THAT(problem("gravity.1=null"), testing::HasSubstr("an element of a list cannot be taken away"));
  EXPECT_THAT(problem("bodies.hub=null"), testing::HasSubstr("hub")) << "what named it is told";
  EXPECT_THAT(problem("bodies.boom.length=null"), testing::HasSubstr("missing"));
}

TEST_F(Overrides, TakeEffectInTheirOrder) { EXPECT_EQ(read({"time.end=2", "time.end=3"}).end, 3); }

TEST_F(Overrides, MayHaveBlanksAroundTheEquals) {
  EXPECT_EQ(read({"time.end = 2"}).end, 2);
  EXPECT_EQ(read({" formulation = ruthless "}).formulation_name, "ruthless");
  EXPECT_NE(problem(" = 2"), "");
}

TEST_F(Overrides, ReplaceWholeMaps) {
  const Scene s = read({"time={end: 4}", "formulation=ruthless"});
  EXPECT_EQ(s.end, 4);
  EXPECT_EQ(s.output, 0.01);
  EXPECT_EQ(s.formulation_name, "ruthless");
}

TEST_F(Overrides, AreNamedAsThePlaceOfTheirErrors) {
  EXPECT_EQ(problem("bodies.hub.mass=-1"),
            "--set 'bodies.hub.mass=-1': /bodies/hub/mass: got -1; need finite >= 0 [kg]");
  EXPECT_EQ(problem("bodies.hub.mas=1"),
            "--set 'bodies.hub.mas=1': /bodies/hub/mas: unknown key \"mas\"; did you mean 'mass'?");
  EXPECT_EQ(problem("tme.end=1"), "--set 'tme.end=1': /tme: unknown key \"tme\"; did you mean 'time'?");
  EXPECT_EQ(problem("time.ennd=1"), "--set 'time.ennd=1': /time/ennd: unknown key \"ennd\"; did you mean 'end'?");
  EXPECT_EQ(problem("bodies.boom.bending_y={modes: 1}"),
            "--set 'bodies.boom.bending_y={modes: 1}': /bodies/boom/bending_y/stiffness: missing: EI_z, for deflection "
            "along y; need finite > 0 [N m^2], or a list of rows [m, N m^2]");
  EXPECT_EQ(problem("time.end={a: 1, a: 2}"),
            "--set 'time.end={a: 1, a: 2}': /time/end/a: duplicate key 'a'\n"
            "--set 'time.end={a: 1, a: 2}': /time/end: got a map; need finite >= 0 [s]");
}

TEST_F(Overrides, AddWhatIsGivenAsAWhole) {
  const Scene s = read({"loads.push={type: force, frame: boom.tip, value: [0, 1, 0]}",
                        "bodies.hub.frames.rim={position: [0, 0.1, 0]}", "bodies.plumb={type: rigid, mass: 1}",
                        "hinges.hang={type: weld, parent: hub.rim, child: plumb}"});
  EXPECT_TRUE(s.source.at("loads").has("push"));
  EXPECT_TRUE(s.source.at("loads").has("motor"));
  EXPECT_GE(s.model->body("plumb"), 0);
  // Also where there is none of its kind.
  const std::string bare =
      "format: withy/1\nformulation: quadratic\nintegrator: dopri5\ntime: {end: 1}\n"
      "bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n";
  EXPECT_EQ(
      parse_scene(bare, "s.yaml", registry, {"", "", {"loads.push={type: force, frame: b.root, value: [0, 1, 0]}"}})
          .model->loads()
          .size(),
      1U);
  // What is added is checked as a file's is, and not taken for what it does not say it is.
  EXPECT_THAT(problem("loads.push={type: force, frame: boom.tipp, value: [0, 1, 0]}"),
              testing::HasSubstr("/loads/push/frame: no frame \"boom.tipp\"; did you mean 'boom.tip'?"));
  EXPECT_THAT(problem("loads.moter={period: 1}"),
              testing::HasSubstr("no \"moter\" here to change; did you mean 'motor'?; to add it, give all of it, as "
                                 "{type: …}"));
}

TEST_F(Overrides, MakeNothingNewOfAValueWithinIt) {
  EXPECT_EQ(problem("bodies.hubb.mass=1"),
            "--set 'bodies.hubb.mass=1': /bodies: no \"hubb\" here to change; did you mean 'hub'?");
  EXPECT_EQ(problem("loads.moter.period=1"),
            "--set 'loads.moter.period=1': /loads: no \"moter\" here to change; did you mean 'motor'?");
  EXPECT_EQ(problem("bodies.hub.frames.oot.position=[1, 0, 0]"),
            "--set 'bodies.hub.frames.oot.position=[1, 0, 0]': /bodies/hub/frames: no \"oot\" here to change; did you "
            "mean 'out'?");
}

TEST_F(Overrides, ThatAreMalformedAreRefused) {
  using testing::StartsWith;
  for (const char* text : {"time.end", "=1", ".=1", "time..end=1", "time.=1", ".time=1"}) {
    EXPECT_THAT(problem(text), StartsWith("--set '" + std::string(text) + "': need "));
  }
  EXPECT_THAT(problem("gravity.3=1"), StartsWith("--set 'gravity.3=1': /gravity: got index \"3\"; need 0 to 2"));
  EXPECT_THAT(problem("bodies.hub.mass.x=1"),
              StartsWith("--set 'bodies.hub.mass.x=1': /bodies/hub/mass: got 20; need"));
  EXPECT_THAT(problem("time.end="), StartsWith("--set 'time.end=': /time/end: empty"));
  EXPECT_THAT(problem("time.end=[1"), StartsWith("--set 'time.end=[1': /time/end: a list or map that is never closed"));
  EXPECT_THAT(problem("time.end=&a 1"), StartsWith("--set 'time.end=&a 1': /time/end: anchors"));
}

TEST_F(Overrides, OfPluginsKeepTheOptionsOfTheOneThatStays) {
  const std::string text = "integrator: {name: dopri5, rtol: 1e-5}\n" + std::string(good_scene);
  const Scene same = parse_scene(text, "s.yaml", registry, {"ruthless", "dopri5", {}});
  EXPECT_EQ(same.source.at("integrator").number_at("rtol"), 1e-5);
  EXPECT_EQ(same.formulation_name, "ruthless");
  const Scene other = parse_scene(text, "s.yaml", registry, {"", "rk4-adaptive", {}});
  EXPECT_EQ(other.integrator_name, "rk4-adaptive");
  EXPECT_NE(other.source.at("integrator").number_at("rtol"), 1e-5);
  EXPECT_THAT(problems(text, registry, {"ruthles", "", {}}),
              testing::StartsWith("--formulation 'ruthles': /formulation/name: no formulation plugin \"ruthles\"; did "
                                  "you mean 'ruthless'?"));
}

}  // namespace
}  // namespace withy::test
