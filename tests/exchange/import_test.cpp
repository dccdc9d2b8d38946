// What is wrong with a model is said with its place, all at once; damaged files are read or refused.
#include <gmock/gmock.h>

#include <random>

#include "withy/scene/scene_error.hpp"
#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

using testing::HasSubstr;

TEST(Import, ErrorsHaveTheirPlacesAndAllComeAtOnce) {
  const Scratch file(".urdf", "");
  const auto urdf = [&](const std::string& inside) {
    file.write("<robot name='r'>\n" + inside + "\n</robot>\n");
    return problems_of({file.file(), {}, false, 0, 0});
  };
  const std::string body =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>";
  const std::string two = "<link name='a'>" + body + "\n<link name='b'>" + body + "\n";
  const auto joint = [](const std::string& type, const std::string& rest) {
    return "<joint name='j' type='" + type + "'><parent link='a'/><child link='b'/>" + rest + "</joint>";
  };
  EXPECT_EQ(urdf(two + joint("revolute", "")), "");
  EXPECT_THAT(urdf(two + joint("revolut", "<axis xyz='0 0 0'/>")),
              HasSubstr(".urdf:4:1: /robot[r]/joint[j]/@type: got \"revolut\""));
  EXPECT_THAT(urdf(two + joint("revolute", "<axis xyz='0 0 0'/>")), HasSubstr("the direction 0 0 0"));
  EXPECT_THAT(urdf(two + joint("fixed", "<origin xyz='1 2'/>")), HasSubstr("got \"1 2\"; need 3 finite numbers"));
  EXPECT_THAT(urdf(two + joint("fixed", "<origin xyz='1 2 nan'/>")), HasSubstr("finite"));
  EXPECT_THAT(urdf(two), HasSubstr("several links have no joint that holds them"));
  EXPECT_THAT(
      urdf(two + joint("fixed", "") + "<joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint>"),
      HasSubstr("the joints make a circle"));
  EXPECT_THAT(urdf("<link name='alpha'>" + body +
                   "<joint name='j' type='fixed'><parent link='alpa'/><child link='alpha'/></joint>"),
              HasSubstr("did you mean 'alpha'?"));
  EXPECT_THAT(urdf("<link name='a'>" + body + "\n<link name='b'/>" + joint("continuous", "")),
              HasSubstr(".urdf:3:1: /robot[r]/link[b]: the link moves"));
  EXPECT_THAT(urdf("<link name='a'><inertial><mass value='-1'/><inertia ixx='1' iyy='1' izz='9'/></inertial></link>"),
              HasSubstr("the mass -1 kg"));
  EXPECT_THAT(urdf("<link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='9'/></inertial></link>"),
              HasSubstr("no distribution of mass"));
  // The nearest that a mass can have: second moments 5.5, 3.5, -2.5 become 5.5, 3.5, 0, so that 1, 3, 9
  // become 3.5, 5.5, 9.
  file.write(
      "<robot><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='3' izz='9'/></inertial></link></robot>");
  EXPECT_THAT(problems_of({file.file(), {}, false, 0, 0}), HasSubstr("principal moments 1, 3, 9"));
  EXPECT_THAT(imported({file.file(), {}, false, 0, 0, true}).text, HasSubstr("inertia: [3.5, 5.5, 9, 0, 0, 0]"));
  EXPECT_THAT(urdf("<link name='a'>"), HasSubstr("mismatched tag"));
  file.write("<!DOCTYPE r [<!ENTITY a 'aa'>]><robot/>");
  EXPECT_THAT(problems_of({file.file(), {}, false, 0, 0}), HasSubstr("a document type declaration"));
  file.write("<sdf/>");
  EXPECT_THAT(problems_of({file.file(), {}, false, 0, 0}), HasSubstr("need <robot> (URDF) or <mujoco> (MJCF)"));
  // Two at once.
  const std::string both = urdf(two + joint("revolute", "<origin xyz='x'/><axis xyz='0 0 0'/>"));
  EXPECT_THAT(both, HasSubstr("@xyz: got \"x\""));
  EXPECT_THAT(both, HasSubstr("the direction 0 0 0"));
}

/// A wheel may have an inertia and no mass; a mass may sit where a joint does not move it.
TEST(Import, APartThatMovesNeedsWhatItsJointMoves) {
  const Scratch file(".urdf", "");
  const auto robot = [&](const std::string& mass, const std::string& inertia, const std::string& type) {
    file.write("<robot name='r'>\n<link name='a'/>\n<link name='b'><inertial><mass value='" + mass +
               "'/><inertia ixx='" + inertia + "' iyy='" + inertia + "' izz='" + inertia +
               "'/></inertial></link>\n<joint name='j' type='" + type +
               "'><parent link='a'/><child link='b'/></joint></robot>");
    return problems_of({file.file(), {}, false, 0, 0});
  };
  EXPECT_EQ(robot("0", "2.5", "continuous"), "");
  EXPECT_EQ(robot("2", "0", "prismatic"), "");
  EXPECT_THAT(
      robot("0", "0", "continuous"),
      HasSubstr(".urdf:3:1: /robot[r]/link[b]: the link moves by the joint \"j\", and neither it nor what hangs "
                "on it has mass or inertia"));
  EXPECT_THAT(robot("2", "0", "continuous"),
              HasSubstr(".urdf:4:1: /robot[r]/joint[j]: the joint \"j\": the mass matrix is singular"));
  EXPECT_THAT(robot("0", "2.5", "prismatic"), HasSubstr("the joint \"j\": the mass matrix is singular"));
  EXPECT_EQ(robot("0", "0", "fixed"), "");
  robot("2", "1", "continuous");
  host::Equations f(scene_of({file.file(), {}, false, 0, 0}));
  EXPECT_EQ(f.size(), 2U);
}

/// Its wrist stands in one line in the state of the file alone: the scene is good elsewhere.
TEST(Import, JointsThatMoveNoMassTogetherAreRemarkedUpon) {
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child,
                        const std::string& axis) {
    return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
           "'/><axis xyz='" + axis + "'/></joint>\n";
  };
  const Scratch file(".urdf",
                     "<robot name='wrist'><link name='a'/><link name='b'/><link name='c'/><link name='d'><inertial>"
                     "<origin xyz='0.1 0 0.1'/><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1'/></inertial>"
                     "</link>" +
                         joint("roll", "a", "b", "0 0 1") + joint("pitch", "b", "c", "0 1 0") +
                         joint("turn", "c", "d", "0 0 1") + "</robot>");
  EXPECT_THAT(imported({file.file(), {}, false, 0, 0}).remarks,
              testing::ElementsAre(testing::AllOf(HasSubstr("no run begins in the state that the scene has"),
                                                  HasSubstr("'roll'"), HasSubstr("'turn'"))));
}

/// YAML reads a bare `null` as no name, and others as no text.
TEST(Import, NamesThatAreNoneInScenesAreChanged) {
  const Scratch file(".urdf",
                     "<robot name='null'><link name='a'/><link name='NULL'><inertial><mass value='1'/><inertia ixx='1' "
                     "iyy='1' izz='1'/></inertial></link><joint name='null' type='continuous'><parent link='a'/><child "
                     "link='NULL'/></joint></robot>");
  const ImportedScene scene = imported({file.file(), {}, false, 0, 0});
  EXPECT_THAT(scene.remarks,
              testing::ElementsAre("link \"NULL\" is called _NULL here", "joint \"null\" is called _null here"));
  for (const std::string word : {"true", "True", "TRUE", "false", "False", "FALSE"}) {
    const Scratch robot(".urdf", "<robot name='r'><link name='a'/><link name='" + word +
                                     "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial></link>"
                                     "<joint name='j' type='continuous'><parent link='a'/><child link='" +
                                     word + "'/></joint></robot>");
    EXPECT_THAT(imported({robot.file(), {}, false, 0, 0}).remarks,
                testing::ElementsAre("link \"" + word + "\" is called _" + word + " here"));
  }
}

TEST(Import, ErrorsOfWhatStandsBesideHaveTheirPlacesThere) {
  const Scratch beside(".yaml", "");
  const auto with = [&](const std::string& link) {
    beside.write("format: withy-flexible/1\nlinks:\n" + link);
    return problems_of({model_file("double-pendulum.urdf"), beside.file(), false, 0, 0});
  };
  EXPECT_EQ(with("  upper: {tip: elbow, bending_y: {stiffness: 60, modes: 2}}\n"), "");
  EXPECT_THAT(with("  uper: {tip: elbow}\n"),
              HasSubstr(".yaml:3:3: /links/uper: there is no link \"uper\"; did you mean 'upper'?"));
  EXPECT_THAT(with("  upper: {tip: elbw}\n"), HasSubstr("there are: elbow"));
  EXPECT_THAT(with("  upper:\n    tip: elbow\n    bending_y: {stiffness: -60, modes: 2}\n"), HasSubstr(".yaml:5:"));
  EXPECT_THAT(with("  upper:\n    tip: elbow\n    bending_x: {stiffness: 60, modes: 2}\n"),
              HasSubstr("did you mean 'bending_"));
  EXPECT_THAT(with("  upper: {tip: [0, 0, 0]}\n"), HasSubstr("no length"));
  EXPECT_THAT(with("  upper: {tip: elbow, y: [3, 0, 0]}\n"), HasSubstr("along the beam"));
  EXPECT_THAT(with("  upper: {tip: elbow, type: beam}\n"), HasSubstr("leave 'type' out"));
  const Scratch dat(".dat", text_of_file(model_file("tower.dat")));
  EXPECT_THAT(problems_of({dat.file(), {}, false, 0, 0}), HasSubstr("--length is missing"));
  std::string text = text_of_file(model_file("tower.dat"));
  dat.write(text.replace(text.find("4885.76"), 7, "4885,7x"));
  EXPECT_THAT(problems_of({dat.file(), {}, false, 87.6, 0}), HasSubstr(".dat:19:1: /: got \"7x\""));
}

/// Cut anywhere, or with a byte changed: a scene, or an error with a text.
TEST(Import, DamagedFilesAreReadOrRefused) {
  std::mt19937 random(11);
  for (const char* name : {"double-pendulum.urdf", "cart-pole.xml", "tower.dat"}) {
    const std::string whole = text_of_file(model_file(name));
    const Scratch file(std::filesystem::path(name).extension().string(), whole);
    const double length = std::string(name) == "tower.dat" ? 80 : 0;
    int refused = 0;
    for (int k = 0; k < 150; ++k) {
      std::string text = whole;
      if (k % 3 == 0) {
        text.resize(random() % text.size());
      } else {
        for (int n = k % 3; n > 0; --n) text[random() % text.size()] = static_cast<char>(random() % 128);
      }
      file.write(text);
      try {
        EXPECT_FALSE(imported({file.file(), {}, false, length, 0}).text.empty());
      } catch (const SceneError& e) {
        EXPECT_NE(std::string(e.what()), "");
        ++refused;
      }
    }
    EXPECT_GT(refused, 50) << name;
  }
}

}  // namespace
}  // namespace withy::exchange
