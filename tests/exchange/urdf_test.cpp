// Trees of URDF have the accelerations that mechanics gives them, by hand, and go to URDF and back.
#include "withy/exchange/urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <tuple>

#include "withy/core/model/model.hpp"
#include "withy/scene/scene_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

/// Lagrange's equations of two pendulums in a plane; c: from hinge to centre of mass, I about it. The files' frames are
/// turned, so that every convention of URDF counts: fixed-axis rpy, inertia in a frame of its own, axes of any length.
TEST(Urdf, TheDoublePendulumMovesAsLagrangesEquationsSay) {
  const double l = 0.9, m1 = 2, c1 = 0.4, m2 = 1.2, c2 = 0.35, I2 = 0.06, g = 9.81;
  const double I1 = 0.12 * std::pow(std::cos(0.5), 2) + 0.125 * std::pow(std::sin(0.5), 2);
  host::Equations f(scene_of({model_file("double-pendulum.urdf"), {}, false, 0, 0}));
  for (const auto& [a, b, u, w] : {std::array{0.3, -1.1, 0.7, 2.0}, std::array{-2.0, 0.4, -1.5, 0.3}}) {
    std::vector<double> y = f.y0();
    put(f, y, "shoulder", a);
    put(f, y, "elbow", b);
    put(f, y, "shoulder.rate", u);
    put(f, y, "elbow.rate", w);
    Eigen::Matrix2d M;
    M(0, 0) = I1 + m1 * c1 * c1 + I2 + m2 * (l * l + c2 * c2 + 2 * l * c2 * std::cos(b));
    M(0, 1) = M(1, 0) = I2 + m2 * (c2 * c2 + l * c2 * std::cos(b));
    M(1, 1) = I2 + m2 * c2 * c2;
    const double k = m2 * l * c2 * std::sin(b), outer = m2 * g * c2 * std::cos(a + b);
    const Eigen::Vector2d right(k * (2 * u * w + w * w) + (m1 * c1 + m2 * l) * g * std::cos(a) + outer - 0.3 * u,
                                -k * u * u + outer);
    const Eigen::Vector2d want = M.ldlt().solve(right);
    const auto got = accelerations(f, y);
    EXPECT_NEAR(got.at("shoulder.rate"), want[0], 1e-12 * (1 + std::abs(want[0])));
    EXPECT_NEAR(got.at("elbow.rate"), want[1], 1e-12 * (1 + std::abs(want[1])));
  }
}

/// Names of scenes have 64 letters; what the importer makes of a joint's name has them too.
TEST(Urdf, LongNamesGiveScenesThatAreRead) {
  const std::string stem(62, 'j');
  std::string text = "<robot name='r'><link name='a'/>";
  for (const char* end : {"1", "2", "3"})
    text += "<link name='b" + std::string(end) +
            "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' "
            "ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='" +
            stem + end + "' type='continuous'><parent link='a'/><child link='b" + end +
            "'/><dynamics damping='0.5'/></joint>";
  text +=
      "<link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
      "iyz='0'/></inertial></link><joint name='" +
      std::string(64, '7') + "' type='continuous'><parent link='a'/><child link='c'/></joint></robot>";
  const Scratch file("long.urdf", text);
  const std::string scene = imported({file.file(), "", false, 0, 0}).text;
  for (const char* end : {"_spring:", "_spring2:", "_spring3:"}) EXPECT_THAT(scene, testing::HasSubstr(end));
  EXPECT_EQ(host::Equations(scene_of({file.file(), "", false, 0, 0})).size(), 8U);
}

/// A link that a file beside makes a beam moves as the same arm written by hand, in axes of its own.
TEST(Urdf, AFlexibleLinkIsTheBeamThatTheFileBesideSays) {
  host::Equations f(scene_of({model_file("double-pendulum.urdf"), model_file("bending-arm.yaml"), false, 0, 0}));
  host::Equations by_hand(host::Scene::parse(plugins(), R"(format: withy/1
gravity: [0, -9.81, 0]
bodies:
  upper:
    type: beam
    length: 0.9
    mass_per_length: 2.2222222222222223
    bending_y: {stiffness: 60, modes: 2, family: clamped-free}
    damping_ratio: 0.01
  fore_arm: {type: rigid, mass: 1.2, center_of_mass: [0.35, 0, 0], inertia: [0.015, 0.05, 0.06, 0, 0, 0]}
hinges:
  shoulder: {type: revolute, axis: [0, 0, -1], parent: world, child: upper}
  elbow: {type: revolute, axis: [0, 0, -1], parent: upper.tip, child: fore_arm}
loads:
  damper: {type: hinge-spring, hinge: shoulder, stiffness: 0, damping: 0.3}
)"));
  std::map<std::string, double> numbers{
      {"shoulder", 0.4},      {"elbow", -0.8},      {"upper.bending_y[1]", 0.03},     {"upper.bending_y[2]", -0.004},
      {"shoulder.rate", 1.2}, {"elbow.rate", -2.0}, {"upper.bending_y[1].rate", 0.2}, {"upper.bending_y[2].rate", 0.1}};
  std::vector<double> y = f.y0(), z = by_hand.y0();
  for (const auto& [name, value] : numbers) {
    put(f, y, name, value);
    put(by_hand, z, name, value);
  }
  const auto got = accelerations(f, y), want = accelerations(by_hand, z);
  ASSERT_EQ(got.size(), want.size());
  for (const auto& [name, value] : want) EXPECT_NEAR(got.at(name), value, 1e-9 * (1 + std::abs(value))) << name;
}

/// Frames on both sides of hinges, offsets turned by 90 degrees about y (where angles of roll and yaw are not unique),
/// a floating base, hinges of two motions.
TEST(Urdf, ATreeThatGoesToUrdfAndBackHasTheSameAccelerations) {
  const host::Scene scene = host::Scene::parse(plugins(), R"(format: withy/1
name: "a <tree> & its \"names\""
bodies:
  base: {type: rigid, mass: 7, center_of_mass: [0.1, 0.2, -0.1], inertia: [0.5, 0.6, 0.7, 0.02, -0.03, 0.01], frames: {
    grip: {position: [0.1, -0.3, 0.2], orientation: {xyz: [0.3, -1.1, 2.0]}}, side: {position: [0, 0.5, 0]}}}
  arm: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0.05], inertia: [0.01, 0.2, 0.2, 0.001, 0, 0.002], frames: {
    held: {position: [-0.05, 0.02, 0.01], orientation: {xyz: [1, 0.5, -0.4]}}, end: {position: [0.6, 0, 0], orientation: {xyz: [0.7, "90 deg", 0.2]}}}}
  fork: {type: rigid, mass: 1.5, center_of_mass: [0, 0.1, 0.1], inertia: [0.03, 0.02, 0.03, 0, 0.004, 0]}
  rod: {type: rigid, mass: 0.8, center_of_mass: [0.2, 0, 0], inertia: [0.001, 0.02, 0.02, 0, 0, 0], frames: {held: {position: [0.1, 0, 0], orientation: {xyz: [0, "-90 deg", 0]}}}}
  slider: {type: rigid, mass: 0.6, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  float: {type: free, parent: world, child: base, offset: {position: [1, 2, 3], orientation: {xyz: [0.1, 0.2, 0.3]}}}
  shoulder: {type: revolute, axis: [1, 2, -1], parent: base.grip, child: arm.held, offset: {position: [0.02, 0, 0], orientation: {xyz: [0, 0.4, 0]}}}
  gimbal: {type: universal, first_axis: [0, 0, 1], second_axis: [1, 1, 0], parent: arm.end, child: fork}
  sleeve: {type: cylindrical, axis: [0, 1, 1], parent: fork, child: rod.held}
  rail: {type: prismatic, axis: [1, 0, 2], parent: rod, child: slider}
)");
  const auto prepared = scene.prepare();
  const Urdf urdf = write_urdf(prepared->model(), "a <tree>");
  const Scratch file(".urdf", urdf.text);
  host::Scene back = scene_of({file.file(), {}, false, 0, 0});
  back.set("gravity", "[0, 0, 0]");
  host::Equations there(scene), here(back);
  ASSERT_EQ(there.size(), here.size());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int state = 0; state < 5; ++state) {
    std::vector<double> y(there.size()), f(there.size()), f_back(there.size());
    for (double& x : y) x = number(random);
    there.normalize(y);
    ASSERT_TRUE(there.derivatives(0, y, f).ok());
    ASSERT_TRUE(here.derivatives(0, y, f_back).ok());
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f_back[i], f[i], 1e-12 * (1 + std::abs(f[i])))
          << here.states()[i].name << " for " << there.states()[i].name;
  }
  EXPECT_TRUE(urdf.remarks.empty());
}

// Where roll and yaw are about one axis rounding makes any angles of them: all three have to fit together.
TEST(Urdf, FramesAtAPitchOfNinetyDegreesAreWhereTheyWere) {
  for (const double pitch : {0.5, -0.5}) {
    for (const double roll : {0.0, 0.4, -2.0}) {
      const Eigen::Quaterniond q(Eigen::AngleAxisd(pitch * std::numbers::pi, Vector3::UnitY()) *
                                 Eigen::AngleAxisd(roll, Vector3::UnitX()));
      std::ostringstream text;
      text.precision(17);
      text << "format: withy/1\nbodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\nhinges: {h: {type: "
              "revolute, axis: [0, 0, 1], parent: world, child: a, offset: {orientation: ["
           << q.w() << ", " << q.x() << ", " << q.y() << ", " << q.z() << "]}}}\n";
      const auto prepared = host::Scene::parse(plugins(), text.str()).prepare();
      const std::string urdf = write_urdf(prepared->model(), "r").text;
      Diagnostics diagnostics;
      const Tree back = read_urdf(read_xml(urdf, "r.urdf"), false, false, diagnostics);
      ASSERT_EQ(back.joints.size(), 1U);
      EXPECT_LT((back.joints[0].offset.R - q.toRotationMatrix()).norm(), 1e-14) << pitch << ", " << roll;
    }
  }
}

TEST(Urdf, AJointWithTheNameOfAColumnOfAllResultsGetsAnother) {
  const Scratch file(".urdf",
                     "<robot name='r'><link name='base'/><link name='work'><inertial><mass value='1'/><inertia ixx='1' "
                     "iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='work' type='continuous'>"
                     "<parent link='base'/><child link='work'/><axis xyz='0 0 1'/></joint></robot>");
  const ImportedScene made = imported({file.file(), {}, false, 0, 0});
  EXPECT_THAT(made.remarks, testing::Contains("joint \"work\" is called _work here"));
  host::Equations f(host::Scene::parse(plugins(), made.text));
  EXPECT_EQ(f.states().at(0).name, "_work");
}

/// Names of scenes have other letters, and 64 at most.
TEST(Urdf, NamesThatBecomeAlikeGetNumbers) {
  const std::string stem(70, 'x');
  std::string text = "<robot name='r'><link name='base'/>";
  for (const std::string& name :
       {std::string("b\u00e9"), std::string("b\u00e8"), std::string("b___2"), stem + "1", stem + "2"})
    text += "<link name='" + name +
            "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial></link><joint name='" + name +
            "' type='continuous'><parent link='base'/><child link='" + name + "'/></joint>";
  const Scratch file(".urdf", text + "</robot>");
  const ImportedScene made = imported({file.file(), {}, false, 0, 0});
  EXPECT_THAT(made.remarks,
              testing::IsSupersetOf({"link \"b\u00e9\" is called b__ here", "link \"b\u00e8\" is called b___3 here",
                                     "joint \"b\u00e8\" is called b___3 here"}));
  EXPECT_THAT(made.remarks, testing::Contains(testing::EndsWith("is called " + std::string(62, 'x') + "_2 here")));
  EXPECT_EQ(host::Equations(host::Scene::parse(plugins(), made.text)).size(), 10U);
}

/// The circle has no root, but another link is one.
TEST(Urdf, JointsInACircleBesideTheRootAreRefused) {
  const auto joint = [](const std::string& parent, const std::string& child) {
    return "<joint name='" + parent + child + "' type='continuous'><parent link='" + parent + "'/><child link='" +
           child + "'/></joint>";
  };
  const std::string links = "<robot name='r'><link name='root'/><link name='a'/><link name='b'/>";
  for (const std::string& joints : {joint("a", "a") + joint("root", "b"), joint("a", "b") + joint("b", "a")}) {
    const Scratch file(".urdf", links + joints + "</robot>");
    EXPECT_THAT(problems_of({file.file(), {}, false, 0, 0}),
                testing::HasSubstr("the joints above this one make a circle; need a tree"));
  }
}

TEST(Urdf, WhatItCannotSayIsSaidWithTheName) {
  const auto written = [](const std::string& hinge) {
    return write_urdf(
        host::Scene::parse(plugins(),
                           "format: withy/1\nbodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
                           "hinges: {h: " +
                               hinge + "}\n")
            .prepare()
            ->model(),
        "r");
  };
  for (const char* hinge : {"{type: spherical, parent: world, child: b}",
                            "{type: screw, axis: [1, 0, 0], pitch: 0.1, parent: world, child: b}",
                            "{type: planar, parent: world, child: b}"})
    EXPECT_THROW(written(hinge), std::domain_error) << hinge;
  EXPECT_NO_THROW(written("{type: revolute, axis: [1, 0, 0], parent: world, child: b}"));
}

Urdf urdf_of(const std::string& scene) {
  return write_urdf(host::Scene::parse(plugins(), scene).prepare()->model(), "r");
}

/// Three rods in a row, closed by a constraint, with events and a hinge that is locked at first: loops and events are
/// no loads, and each is named.
TEST(Urdf, LoopsAndEventsThatAreLeftOutAreNamed) {
  const auto remarks = [](const std::string& more) {
    return urdf_of(R"(format: withy/1
bodies:
  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {end: {position: [1, 0, 0]}}}
  b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {end: {position: [1, 0, 0]}}}
hinges:
  first: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  second: {type: revolute, axis: [0, 0, 1], parent: a.end, child: b}
)" + more)
        .remarks;
  };
  EXPECT_THAT(remarks("constraints: {loop: {type: hinge, hinge: spherical, a: b.end, b: world, offset: {position: "
                      "[0, 0, 0]}}}\ninitial: {hinges: {second: {position: [180 deg]}}}\n"),
              testing::ElementsAre("constraint 'loop' is left out, and its loop is open: URDF has trees alone"));
  EXPECT_THAT(remarks("loads: {drag: {type: hinge-spring, hinge: first, damping: 1}}\n"
                      "events: {go: {at: 1, do: {unlock: second}}}\ninitial: {locked: [second]}\n"),
              testing::ElementsAre("1 of the scene's loads left out", "event 'go' is left out: URDF has none",
                                   "hinge 'second' is held at first; its joint is free to move"));
}

/// A weld that an event lets go of is free in the model, and held.
TEST(Urdf, AWeldThatAnEventLetsGoOfIsFixed) {
  const Urdf urdf = urdf_of(R"(format: withy/1
bodies: {lid: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {clasp: {type: weld, parent: world, child: lid}}
events: {open: {at: 1, do: {release: lid}}}
)");
  EXPECT_THAT(urdf.text, testing::HasSubstr("<joint name=\"clasp\" type=\"fixed\">"));
  EXPECT_THAT(urdf.remarks, testing::ElementsAre("event 'open' is left out: URDF has none"));
}

/// The link and the joints that a cylindrical hinge becomes have names of their own, whatever the scene's are.
TEST(Urdf, NamesOfTheTwoJointsOfAHingeAreTheirOwn) {
  const Urdf urdf = urdf_of(R"(format: withy/1
bodies:
  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  sleeve_between: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  sleeve: {type: cylindrical, axis: [0, 0, 1], parent: world, child: a}
  sleeve_0: {type: revolute, axis: [0, 1, 0], parent: a, child: sleeve_between}
  sleeve_1: {type: revolute, axis: [0, 1, 0], parent: sleeve_between, child: b}
)");
  const Scratch file(".urdf", urdf.text);
  const auto prepared = scene_of({file.file(), {}, false, 0, 0}).prepare();
  EXPECT_EQ(prepared->model().bodies().size(), 4U);
  EXPECT_EQ(prepared->equations->layout().speeds, 4U);
}

/// The end of a robot of two links, on a joint of this type.
std::string two_links(const std::string& root, const std::string& root_mass, const std::string& type,
                      const std::string& rest = "") {
  const auto mass = [](const std::string& kilograms) {
    return "<inertial><mass value='" + kilograms + "'/><inertia ixx='1' iyy='1' izz='1'/></inertial>";
  };
  return "<robot name='r'><link name='" + root + "'>" + (root_mass.empty() ? "" : mass(root_mass)) +
         "</link><link name='b'>" + mass("2") + "</link><joint name='j' type='" + type + "'><parent link='" + root +
         "'/><child link='b'/>" + rest + "</joint></robot>";
}

TEST(Urdf, DampingThatNoLoadTakesOverIsTold) {
  for (const char* type : {"planar", "floating"}) {
    const Scratch file(".urdf", two_links("a", "3", type, "<dynamics damping='4'/>"));
    EXPECT_THAT(imported({file.file(), {}, false, 0, 0}).remarks,
                testing::ElementsAre(testing::HasSubstr("joint \"j\": damping 4 is left out")))
        << type;
  }
  const Scratch file(".urdf", two_links("a", "3", "fixed", "<dynamics damping='4'/>"));
  EXPECT_THAT(imported({file.file(), {}, false, 0, 0}).remarks, testing::IsEmpty());
}

/// A massless root called "world" is the world, but one that is to float is a link, with all that is fixed to it.
TEST(Urdf, AFreeBaseFloatsAlsoWhereItIsCalledWorld) {
  for (const auto& [type, speeds, floating] : {std::tuple("fixed", 0, 6), std::tuple("floating", 6, 6)}) {
    const Scratch file(".urdf", two_links("world", "", type));
    const auto count = [&](bool free_base) {
      const auto prepared = scene_of({file.file(), {}, free_base, 0, 0}).prepare();
      return static_cast<int>(prepared->equations->layout().speeds);
    };
    EXPECT_EQ(count(false), speeds) << type;
    EXPECT_EQ(count(true), floating) << type;
  }
  const Scratch file(".urdf", two_links("world", "", "fixed"));
  host::Equations f(scene_of({file.file(), {}, true, 0, 0}));
  EXPECT_NEAR(accelerations(f, f.y0()).at("base_of_world.vz"), -9.81, 1e-12);
}

/// The base could turn one way and the link on it the other, and nothing that has mass would move.
TEST(Urdf, AFloatingBaseWithoutMassUnderOneJointIsRefused) {
  const auto refused = [](const std::string& text) {
    const Scratch file(".urdf", text);
    try {
      static_cast<void>(imported({file.file(), {}, true, 0, 0}));
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const char* root : {"base", "world"})
    EXPECT_THAT(refused(two_links(root, "", "continuous")),
                testing::HasSubstr("has no mass and no inertia, and only the joint \"j\" moves on it"));
  EXPECT_EQ(refused(two_links("base", "3", "continuous")), "");
  EXPECT_EQ(refused(two_links("base", "", "fixed")), "");
}

}  // namespace
}  // namespace withy::exchange
