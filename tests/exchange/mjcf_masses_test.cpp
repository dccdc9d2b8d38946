// What MuJoCo refuses of masses is refused here, at the element that says it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

using testing::HasSubstr;

ImportedScene model_with(const std::string& inside) {
  const Scratch file(".xml", "<mujoco><worldbody><body name='b'><joint/>\n" + inside + "</body></worldbody></mujoco>");
  return imported({file.file(), {}, false, 0, 0});
}

std::string problems_with(const std::string& inside) {
  try {
    static_cast<void>(model_with(inside));
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

/// The masses of several geoms add up: one below zero would go unseen beside a greater one.
TEST(MjcfMasses, AGeomOfNegativeMassOrDensityIsRefused) {
  const std::string ball = "<geom size='1' mass='2'/>";
  EXPECT_EQ(problems_with(ball), "");
  EXPECT_THAT(problems_with(ball + "<geom size='.1' mass='-1'/>"), HasSubstr("2:26: "));
  EXPECT_THAT(problems_with(ball + "<geom size='.1' mass='-1'/>"), HasSubstr("geom/@mass: got -1; need at least 0"));
  EXPECT_THAT(problems_with(ball + "<geom size='.1' density='-100'/>"),
              HasSubstr("geom/@density: got -100; need at least 0"));
  EXPECT_EQ(problems_with(ball + "<geom size='.1' mass='1' density='-100'/>"), "");  // the mass counts
}

TEST(MjcfMasses, AnInertialIsWholeAndSaysNothingTwice) {
  const auto inertial = [](const std::string& attributes) { return problems_with("<inertial " + attributes + "/>"); };
  EXPECT_EQ(inertial("mass='1' pos='0 0 0' diaginertia='1 1 1'"), "");
  EXPECT_EQ(inertial("mass='1' pos='0 0 0' quat='1 1 0 0' diaginertia='1 1 1'"), "");
  EXPECT_THAT(inertial("pos='0 0 0' diaginertia='1 1 1'"), HasSubstr("inertial/@mass: missing"));
  EXPECT_THAT(inertial("mass='1' diaginertia='1 1 1'"), HasSubstr("inertial/@pos: missing"));
  for (const char* other : {"diaginertia='1 1 1'", "quat='1 1 0 0'", "euler='1 2 3'"})
    EXPECT_THAT(inertial("mass='1' pos='0 0 0' fullinertia='1 2 2 0 0 0' " + std::string(other)),
                HasSubstr("inertial/@fullinertia: has axes of its own"))
        << other;
  EXPECT_THAT(problems_with("<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>"
                            "<inertial mass='2' pos='0 0 0' diaginertia='1 1 1'/>"),
              HasSubstr("a second <inertial>"));
}

TEST(MjcfMasses, APointOfMassIsTold) {
  const ImportedScene scene = model_with("<inertial mass='1' pos='1 0 0'/>");
  EXPECT_THAT(scene.remarks, testing::Contains("body \"b\": its <inertial> has no inertia; its mass sits at a point"));
}

TEST(MjcfMasses, EndsThatSayNothingAreRefused) {
  const auto geom = [](const std::string& attributes) { return problems_with("<geom " + attributes + "/>"); };
  for (const std::string form : {"capsule", "cylinder", "box", "ellipsoid"}) {
    EXPECT_THAT(geom("type='" + form + "' size='.1' fromto='1 1 1 1 1 1'"),
                HasSubstr("geom/@fromto: got two ends at 1 1 1; need a length"));
    EXPECT_THAT(geom("type='" + form + "' size='.1' mass='1' pos='1 0 0' fromto='0 0 0 1 1 1'"),
                HasSubstr("geom/@pos: the geom has a fromto"));
    EXPECT_EQ(geom("type='" + form + "' size='.1' pos='0 0 0' fromto='0 0 0 1 1 1'"), "");
  }
  EXPECT_THAT(geom("size='.1' fromto='0 0 0 1 1 1'"), HasSubstr("a sphere has no ends"));
}

/// In bodies, joints and defaults; as MuJoCo's schema refuses it.
TEST(MjcfMasses, AnAttributeThatMjcfDoesNotHaveIsTold) {
  const Scratch file(".xml", R"(<mujoco><default><joint dampin="3"/></default>
<worldbody><body name="b"><joint dampin="2"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 1 1" inerta="2 2 2"/></body></worldbody></mujoco>)");
  EXPECT_THAT(imported({file.file(), {}, false, 0, 0}).remarks,
              testing::ElementsAre("the attribute dampin of <joint> is left out, 2 times, first on line 1",
                                   "the attribute inerta of <inertial> is left out, on line 3"));
}

TEST(MjcfMasses, ABodyThatAUserMovesIsToldToStay) {
  const Scratch file(".xml",
                     "<mujoco><worldbody><body name='hand' mocap='true'><geom size='.1'/></body></worldbody></mujoco>");
  EXPECT_THAT(imported({file.file(), {}, false, 0, 0}).remarks,
              testing::Contains("body \"hand\": mocap is left out, it stays where it is"));
}

}  // namespace
}  // namespace withy::exchange
