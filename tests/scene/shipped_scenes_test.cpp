// What a user runs first is read without a word, and is the system its comments speak of.
#include <filesystem>
#include <fstream>

#include "scene_fixture.hpp"
#include "withy/core/plugin/formulation.hpp"

namespace withy::test {
namespace {

class ShippedScenes : public SceneTest {
 protected:
  Scene read(const std::string& path, const SceneOptions& options = {}) {
    return read_scene(WITHY_SOURCE_DIRECTORY "/" + path, registry, options);
  }
};

TEST_F(ShippedScenes, AreReadAndCompile) {
  std::size_t scenes = 0;
  for (const std::string folder : {"scenes", "scenes/gallery"}) {
    for (const auto& entry : std::filesystem::directory_iterator(WITHY_SOURCE_DIRECTORY "/" + folder)) {
      if (entry.path().extension() != ".yaml") continue;
      ++scenes;
      const std::string name = entry.path().stem();
      const Scene scene = read(folder + "/" + name + ".yaml");
      EXPECT_GT(end_of_run(scene), 0) << name;
      EXPECT_FALSE(scene.name.empty()) << name;
      EXPECT_NE(scene.formulation->compile(scene.model), nullptr) << name;
    }
  }
  EXPECT_GE(scenes, 20U);
}

/// The expressions differ (reference scenes give no damping or loads), the masses and stiffnesses must not.
TEST_F(ShippedScenes, HaveTheBodiesOfTheReferenceScenes) {
  const std::pair<const char*, const char*> pairs[] = {
      {"scenes/two-link-slew.yaml", "tests/reference/arm-2.yaml"},
      {"scenes/beam-on-base.yaml", "tests/reference/beam-on-base.yaml"},
      {"scenes/spacecraft.yaml", "tests/reference/spacecraft.yaml"}};
  for (const auto& [shipped_path, reference_path] : pairs) {
    const Scene shipped = read(shipped_path);
    const Scene reference = read(reference_path);
    ASSERT_EQ(shipped.model->layout().speed_names, reference.model->layout().speed_names);
    EXPECT_EQ(shipped.model->gravity(), reference.model->gravity());
    for (std::size_t b = 0; b < shipped.model->bodies().size(); ++b) {
      const ModalShape& mine = shipped.model->bodies()[b].body->shape();
      const ModalShape& theirs = reference.model->bodies()[b].body->shape();
      ASSERT_EQ(mine.particles.size(), theirs.particles.size());
      for (std::size_t i = 0; i < mine.particles.size(); ++i) {
        EXPECT_EQ(mine.particles[i].mass, theirs.particles[i].mass);
        EXPECT_EQ(mine.particles[i].at.X, theirs.particles[i].at.X);
      }
      ASSERT_EQ(mine.sections.size(), theirs.sections.size());
      for (std::size_t i = 0; i < mine.sections.size(); ++i) {
        EXPECT_EQ(mine.sections[i].inertia, theirs.sections[i].inertia);
      }
      EXPECT_EQ(mine.stiffness, theirs.stiffness);
      const HingeNode& hinge = shipped.model->hinges()[b];
      EXPECT_EQ(hinge.offset.p, reference.model->hinges()[b].offset.p);
      EXPECT_EQ(hinge.offset.R, reference.model->hinges()[b].offset.R);
    }
  }
}

/// First row of tests/reference/{driven-arm,two-link-slew}.quadratic.csv: tip_x, tip_y at t = 0.
TEST_F(ShippedScenes, PutTheTipOfTheArmWhereTheReferenceTrajectoriesBegin) {
  struct Tip {
    const char* path;
    double x, y;
  };
  for (const Tip& tip :
       {Tip{"scenes/driven-arm.yaml", 1.905, 0}, Tip{"scenes/two-link-slew.yaml", 0.375320279, 0.691479721}}) {
    const Scene scene = read(tip.path);
    const int body = scene.model->body("payload");
    const int frame = scene.model->bodies()[static_cast<std::size_t>(body)].frame("tip");
    ASSERT_GE(frame, 0);
    const auto pose = scene.formulation->compile(scene.model)->frame_pose(scene.initial.y, body, frame);
    EXPECT_NEAR(pose.position[0], tip.x, 1e-9);  // the file has nine digits
    EXPECT_NEAR(pose.position[1], tip.y, 1e-9);
  }
}

TEST_F(ShippedScenes, GiveTheirBodiesTheFramesThatResultsSpeakOf) {
  const Scene scene = read("scenes/beam-on-base.yaml");
  const BodyNode& boom = scene.model->bodies()[static_cast<std::size_t>(scene.model->body("boom"))];
  EXPECT_EQ(boom.frame("root"), 0);
  EXPECT_GE(boom.frame("tip"), 0);  // no hinge hangs there
}

TEST_F(ShippedScenes, LetABodyHaveItsOwnFormulation) {
  const SceneOptions options{"", "", {"bodies.link2.formulation=ruthless"}};
  const Scene scene = read("scenes/two-link-slew.yaml", options);
  const auto& bodies = scene.model->bodies();
  EXPECT_EQ(bodies[static_cast<std::size_t>(scene.model->body("link2"))].terms.value().truncation,
            Truncation::ruthless);
  EXPECT_FALSE(bodies[static_cast<std::size_t>(scene.model->body("link1"))].terms.has_value());
}

TEST_F(ShippedScenes, ReadTheSameFromJson) {
  const std::string json =
      R"({"format": "withy/1", "time": {"end": 1}, "bodies": {"a": {"type": "rigid", "mass": "2 lb"}},
    "hinges": {"h": {"type": "free", "parent": "world", "child": "a"}}})";
  const Scene scene = parse_scene(json, "scene.json", registry);
  EXPECT_EQ(scene.model->bodies()[0].body->shape().particles[0].mass, 2 * 0.45359237);
}

}  // namespace
}  // namespace withy::test
