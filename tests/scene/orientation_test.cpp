#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scene_fixture.hpp"
#include "withy/scene/scene_values.hpp"

namespace withy::test {
namespace {

class Orientations : public SceneTest {
 protected:
  /// A scene with a frame, an offset and the starts of a spherical and a free hinge.
  static std::string scene(const std::string& orientation, const std::string& pose) {
    return "format: withy/1\nbodies:\n  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0],\n"
           "      frames: {out: {orientation: " +
           orientation +
           "}}}\n  b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n"
           "  ball: {type: spherical, parent: world, child: a, offset: {orientation: " +
           orientation +
           "}}\n  bus: {type: free, parent: world, child: b}\ninitial:\n  hinges:\n    ball: {position: " +
           orientation + "}\n    bus: {position: " + pose + "}\n";
  }
  std::string problem(const std::string& text) {
    try {
      parse_scene(text, "s.yaml", registry);
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(Orientations, AreTheSameInEachForm) {
  struct Case {
    const char* quaternion;
    const char* map;
  };
  // A quarter about x, then one about the new y, is a third of a turn about the diagonal.
  for (const Case& c : {Case{"[0.7071067811865476, 0, 0, 0.7071067811865476]", "{axis: [0, 0, 3], angle: \"90 deg\"}"},
                        Case{"[0.7071067811865476, 0, 0, 0.7071067811865476]", "{xyz: [0, 0, \"90 deg\"]}"},
                        Case{"[0.5, 0.5, 0.5, 0.5]", "{xyz: [\"90 deg\", \"90 deg\", 0]}"},
                        Case{"[0.5, 0.5, 0.5, 0.5]", "{axis: [1, 1, 1], angle: 2.0943951023931953}"}}) {
    SCOPED_TRACE(c.map);
    const std::string quaternion = c.quaternion, map = c.map;
    const std::string numbers = quaternion.substr(0, quaternion.size() - 1) + ", 1, 2, 3]";
    const Scene as_map = parse_scene(scene(map, "{orientation: " + map + ", position: [1, 2, 3]}"), "s", registry);
    const Scene as_numbers = parse_scene(scene(quaternion, numbers), "s", registry);
    ASSERT_EQ(as_map.initial.y.size(), as_numbers.initial.y.size());
    for (std::size_t i = 0; i < as_map.initial.y.size(); ++i)
      EXPECT_NEAR(as_map.initial.y[i], as_numbers.initial.y[i], 1e-15) << i;
    const Model &a = *as_map.model, &b = *as_numbers.model;
    EXPECT_LT((a.hinges()[0].offset.R - b.hinges()[0].offset.R).norm(), 1e-15);
    const auto frame = static_cast<std::size_t>(a.bodies()[0].frame("out"));
    EXPECT_LT((a.bodies()[0].frames[frame].pose.R - b.bodies()[0].frames[frame].pose.R).norm(), 1e-15);
  }
}

TEST_F(Orientations, SayWhatIsWrongWithThem) {
  const auto with = [&](const std::string& map) { return problem(scene(map, "[1, 0, 0, 0, 0, 0, 0]")); };
  using testing::HasSubstr;
  EXPECT_THAT(with("{axis: [0, 0, 0], angle: 1}"), HasSubstr("got an axis of length 0; need a direction"));
  EXPECT_THAT(with("{axis: [0, 0, 1]}"), HasSubstr("/orientation/angle: missing"));
  EXPECT_THAT(with("{axes: [0, 0, 1], angle: 1}"), HasSubstr("unknown key \"axes\"; did you mean 'axis'?"));
  EXPECT_THAT(with("{xyz: [1, 2]}"), HasSubstr("/orientation/xyz: got a list of 2; need a list of 3"));
  EXPECT_THAT(with("{xyz: [1, 2, 3], angle: 1}"), HasSubstr("unknown key \"angle\""));
  EXPECT_THAT(with("up"), HasSubstr("a unit quaternion [w, x, y, z], {axis: [x, y, z], angle: a} or {xyz: [a, b, c]}"));
}

TEST_F(Orientations, AreVariedByTheirAngles) {
  SceneValues values = SceneValues::parse(scene("{xyz: [0, 0, 0.1]}", "{orientation: {xyz: [0.1, 0, 0]}}"), "s.yaml");
  values.set_text("initial.hinges.bus.position.orientation.xyz=[30 deg, 0, 0]");
  const Scene made = make_scene(values, registry);
  const Slot* bus = made.model->layout().hinge("bus");
  EXPECT_NEAR(made.initial.y[bus->position + 1], std::sin(std::numbers::pi / 12), 1e-15);
}

}  // namespace
}  // namespace withy::test
