// Quaternions of URDF 1.1, limits of 1.2, and what a URDF has beside, told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string robot_of(const std::string& version, const std::string& inertial_turn, const std::string& joint_turn,
                     const std::string& more = "") {
  return "<robot name='r'" + (version.empty() ? "" : " version='" + version + "'") +
         ">\n<link name='a'/>\n<link name='b'><inertial>\n<origin xyz='0.1 0.2 0.3' " + inertial_turn +
         "/><mass value='2'/><inertia ixx='1' iyy='2' izz='2.5' ixy='0.1' ixz='0.2' iyz='-0.1'/></inertial></link>\n"
         "<joint name='j' type='continuous'><parent link='a'/><child link='b'/>\n<origin xyz='1 0 0' " +
         joint_turn + "/><axis xyz='1 2 0'/>" + more + "</joint></robot>";
}

ImportedScene scene_from(const std::string& urdf) {
  const Scratch file(".urdf", urdf);
  return imported({file.file(), {}, false, 0, 0});
}

std::string problems_from(const std::string& urdf) {
  const Scratch file(".urdf", urdf);
  return problems_of({file.file(), {}, false, 0, 0});
}

/// Of the one hinge, at a position and rate.
double turning(const std::string& urdf) {
  const Scratch file(".urdf", urdf);
  host::Equations f(scene_of({file.file(), {}, false, 0, 0}));
  std::vector<double> y = f.y0();
  put(f, y, "j", 0.4);
  put(f, y, "j.rate", 1.5);
  return accelerations(f, y).at("j.rate");
}

/// Roll, pitch and yaw of 90 degrees about x and then z are the quaternion x y z w = ½ ½ ½ ½; of any length.
TEST(UrdfVersions, AQuaternionTurnsAsTheAnglesThatAreTheSameTurn) {
  const std::string half = "1.5707963267948966", rpy = "rpy='" + half + " 0 " + half + "'";
  const double want = turning(robot_of("", rpy, rpy)), unturned = turning(robot_of("", "", ""));
  EXPECT_GT(std::abs(want - unturned), 0.1);
  for (const char* version : {"1.1", "1.2"}) {
    for (const std::string quaternion : {"quat_xyzw='0.5 0.5 0.5 0.5'", "quat_xyzw='-3 -3 -3 -3'"}) {
      EXPECT_NEAR(turning(robot_of(version, quaternion, quaternion)), want, 1e-12) << version;
      EXPECT_NEAR(turning(robot_of(version, quaternion, rpy)), want, 1e-12) << version;
    }
    EXPECT_THAT(scene_from(robot_of(version, "quat_xyzw='0 0 0 1'", "")).remarks, IsEmpty());
  }
}

TEST(UrdfVersions, WhatAQuaternionMayNotBeIsRefused) {
  EXPECT_THAT(problems_from(robot_of("1.1", "rpy='0 0 0' quat_xyzw='0 0 0 1'", "")),
              HasSubstr(".urdf:4:1: /robot[r]/link[b]/inertial/origin/@quat_xyzw: the element has rpy too"));
  EXPECT_THAT(problems_from(robot_of("1.1", "", "quat_xyzw='0 0 0 0'")), HasSubstr("got 0 0 0 0; need a quaternion"));
  EXPECT_THAT(problems_from(robot_of("1.1", "", "quat_xyzw='0 0 0'")), HasSubstr("need 4 finite numbers"));
}

/// Version 1.0 does not know it: that is what the file means, and is told.
TEST(UrdfVersions, AQuaternionOfAnEarlierVersionIsToldAndDoesNotTurn) {
  const double want = turning(robot_of("", "", "rpy='0 0 1'"));
  for (const char* version : {"", "1.0"}) {
    const std::string urdf = robot_of(version, "", "rpy='0 0 1' quat_xyzw='0.5 0.5 0.5 0.5'");
    EXPECT_EQ(turning(urdf), want) << version;
    EXPECT_THAT(scene_from(urdf).remarks, ElementsAre("quat_xyzw on line 6 is left out: URDF has it from version 1.1 "
                                                      "on, and the file's version is 1.0"));
  }
}

TEST(UrdfVersions, OthersThanThoseThatAreKnownAreRefused) {
  for (const char* version : {"7.3", "1", "2.0", "1.3", "1.0.0", "one"})
    EXPECT_THAT(problems_from(robot_of(version, "", "")),
                HasSubstr(".urdf:1:1: /robot[r]/@version: got \"" + std::string(version) + "\"; need 1.0, 1.1 or 1.2"));
}

/// A comment of the scene, also for joints without a range.
TEST(UrdfVersions, LimitsAndSafetyControllersAreToldInTheScene) {
  const std::string scene =
      scene_from(robot_of("1.2", "", "",
                          "<limit lower='1' upper='2' effort='3' velocity='4' acceleration='5' deceleration='inf' "
                          "jerk='7'/><safety_controller k_velocity='10'/>"))
          .text;
  EXPECT_THAT(scene, HasSubstr("effort of 3 N m at most is not enforced; velocity of 4 rad/s at most is not enforced; "
                               "acceleration of 5 rad/s^2 at most is not enforced; jerk of 7 rad/s^3 at most is not "
                               "enforced; its safety_controller is left out"));
  EXPECT_THAT(scene, testing::Not(HasSubstr("its range")));
}

/// A misspelled attribute is read as if it were not there.
TEST(UrdfVersions, WhatIsNotReadIsToldOnceForEachKind) {
  EXPECT_THAT(scene_from(R"(<robot name="r" xmlns:xacro="x">
<link name="a"/>
<link name="b"><inertial><origin xyz="1 0 0"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixu="0.2"/></inertial>
<contact/><visual><origin ryp="0 0 1"/></visual><collision/></link>
<link name="c"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
<inertial><mass value="5"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
<contact/></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 0 1" ryp="0 0 1"/></joint>
<joint name="k" type="continuous"><parent link="b"/><child link="c"/><calibration rising="0"/></joint>
<loop_joint name="l"/><gazebo/><ros2_control/><transmission/><material/><drake:joint/>
</robot>)")
                  .remarks,
              ElementsAre("the attribute ixu of <inertia> is left out, on line 3",
                          "<contact> in <link> is left out, 2 times, first on line 4",
                          "a second <inertial> in one <link> is left out, on line 6",
                          "the attribute ryp of <origin> is left out, on line 8",
                          "<loop_joint> in <robot> is left out, on line 10"));
}

}  // namespace
}  // namespace withy::exchange
