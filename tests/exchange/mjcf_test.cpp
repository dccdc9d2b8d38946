// Models of MJCF have the accelerations that mechanics gives them, by hand; orientations in every form are the same.
#include "withy/exchange/mjcf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <tuple>

#include "withy/scene/scene_error.hpp"
#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ImportedScene model_of(const std::string& inside) {
  const Scratch file(".xml", "<mujoco>" + inside + "</mujoco>");
  return imported({file.file(), {}, false, 0, 0});
}

Tree tree_of(const std::string& inside, bool mend_inertias = false) {
  Diagnostics diagnostics;
  Tree tree = read_mjcf(read_xml("<mujoco>" + inside + "</mujoco>", "model.xml"), mend_inertias, diagnostics);
  EXPECT_TRUE(diagnostics.ok());
  return tree;
}

host::Equations equations_of(const std::string& inside) {
  return host::Equations(host::Scene::parse(plugins(), model_of(inside).text));
}

/// A pole on a cart: its centre of mass is a above its pivot, its moment of inertia about that I. And a plate in free
/// fall on three joints of one body: its centre of mass falls, it does not start to turn.
TEST(Mjcf, TheCartPoleAndTheFallingPlateMoveAsMechanicsSays) {
  const double g = 9.5, pi = std::numbers::pi, r = 0.03, length = 0.6;
  const double tube = 1000 * pi * r * r * length, ball = 1000 * 4.0 / 3 * pi * r * r * r, m = tube + ball;
  const double h = length / 2;
  const double I = tube * (3 * r * r + length * length) / 12 + ball * (0.4 * r * r + h * h + 0.75 * h * r);
  const double cart = 2000 * 0.2 * 0.4 * 0.1, a = h + 0.02;
  host::Equations f(scene_of({model_file("cart-pole.xml"), {}, false, 0, 0}));
  std::vector<double> y = f.y0();
  const double s = 0.7, swing = 0.5, u = -0.4, w = 1.3;
  put(f, y, "slide", s);
  put(f, y, "swing", swing);
  put(f, y, "slide.rate", u);
  put(f, y, "swing.rate", w);
  put(f, y, "turn", 0.9);
  put(f, y, "turn.rate", 2.5);
  put(f, y, "px", 0.2);
  const auto got = accelerations(f, y);
  // The cart's -y is the world's x; swinging is about the world's y, so that the pole leans to x.
  Eigen::Matrix2d M;
  M << cart + m, m * a * std::cos(swing), m * a * std::cos(swing), I + m * a * a;
  const double spring = -1.5 * (swing - 10 * pi / 180) - 0.05 * w;
  const Eigen::Vector2d want =
      M.ldlt().solve(Eigen::Vector2d(m * a * std::sin(swing) * w * w - 0.2 * u, m * g * a * std::sin(swing) + spring));
  EXPECT_NEAR(got.at("slide.rate"), want[0], 1e-12 * (1 + std::abs(want[0])));
  EXPECT_NEAR(got.at("swing.rate"), want[1], 1e-12 * (1 + std::abs(want[1])));
  // From the pivot of the plate to its centre of mass, turned by 0.9 rad about y.
  const Eigen::Vector3d arm =
      Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitY()) * Eigen::Vector3d(0.1 - 0.3, 0, 0.05 - 0.2);
  EXPECT_NEAR(got.at("turn.rate"), 0, 1e-12);
  EXPECT_NEAR(got.at("px.rate"), 2.5 * 2.5 * arm.x(), 1e-12);
  EXPECT_NEAR(got.at("pz.rate"), -g + 2.5 * 2.5 * arm.z(), 1e-12);
}

/// Whatever a model says that changes its motion, or was measured in it, and has no place in a scene is told.
TEST(Mjcf, WhatIsLeftOutIsTold) {
  const Scratch file(".xml", R"(<mujoco>
<option density="1.2" viscosity="0" timestep="0.002"/>
<worldbody><light pos="0 0 3"/><body name="arm" gravcomp="1"><joint name="j" axis="0 1 0"/><site name="s"/>
<inertial mass="1" pos="1 0 0" diaginertia="1 1 1"/></body></worldbody>
<sensor><gyro site="s"/></sensor>
<keyframe><key qpos="0.4"/><key qpos="0.8"/></keyframe>
</mujoco>)");
  EXPECT_EQ(imported({file.file(), {}, false, 0, 0}).remarks,
            (std::vector<std::string>{"<option>: density 1.2 of a medium, and its forces, are left out",
                                      "<sensor> with 1 element is left out", "<keyframe> with 2 elements is left out",
                                      "body \"arm\": gravcomp 1 is left out, its weight acts"}));
}

TEST(Mjcf, OrientationsInEveryFormAreTheSame) {
  const auto scene = [](const std::string& turned) {
    const Scratch file(
        ".xml",
        "<mujoco><compiler angle='radian' eulerseq='XYz'/><worldbody><body name='b' " + turned +
            "><joint name='j' axis='1 2 3'/><inertial mass='1' pos='.3 .1 -.2' fullinertia='.3 .4 .5 .01 .02 .03'/>"
            "</body></worldbody></mujoco>");
    host::Equations f(scene_of({file.file(), {}, false, 0, 0}));
    return accelerations(f, f.y0()).at("j.rate");
  };
  // Fixed x by 0.3, fixed y by 0.5, then own z by 0.7: R = Ry(0.5) Rx(0.3) Rz(0.7).
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::AngleAxisd about(R);
  const Eigen::Quaterniond q(R);
  std::ostringstream quat, axisangle, xyaxes;
  for (std::ostringstream* o : {&quat, &axisangle, &xyaxes}) o->precision(17);
  quat << "quat='" << 2 * q.w() << ' ' << 2 * q.x() << ' ' << 2 * q.y() << ' ' << 2 * q.z() << '\'';
  axisangle << "axisangle='" << about.axis().x() << ' ' << about.axis().y() << ' ' << about.axis().z() << ' '
            << about.angle() << '\'';
  xyaxes << "xyaxes='" << R(0, 0) << ' ' << R(1, 0) << ' ' << R(2, 0) << ' ' << R(0, 1) + R(0, 0) << ' '
         << R(1, 1) + R(1, 0) << ' ' << R(2, 1) + R(2, 0) << '\'';
  const double want = scene(quat.str());
  EXPECT_GT(std::abs(want - scene("")), 1e-3);
  EXPECT_NEAR(scene("euler='.3 .5 .7'"), want, 1e-12);
  EXPECT_NEAR(scene(axisangle.str()), want, 1e-12);
  EXPECT_NEAR(scene(xyaxes.str()), want, 1e-12);
  // Of any length, up to the ends of the range of numbers.
  const double turned = scene("axisangle='0 1 1 .5'"), crossed = scene("xyaxes='0 1 1 1 0 0'");
  EXPECT_GT(std::abs(turned - scene("")), 1e-3);
  for (const std::string l : {"1e200", "1e-200"}) {
    EXPECT_NEAR(scene("axisangle='0 " + l + ' ' + l + " .5'"), turned, 1e-12) << l;
    EXPECT_NEAR(scene("xyaxes='0 " + l + ' ' + l + ' ' + l + " 0 0'"), crossed, 1e-12) << l;
    EXPECT_NEAR(scene("quat='" + l + ' ' + l + " 0 0'"), scene("quat='1 1 0 0'"), 1e-12) << l;
  }
}

// By its ends a geom of any form has its length along z from one to the other and its first size across.
TEST(Mjcf, AGeomGivenByItsEndsHasTheMassOfTheSameOneGivenByItsFrame) {
  const auto scene = [](const std::string& geom) {
    const Scratch file(".xml",
                       "<mujoco><compiler angle='radian'/><worldbody><body name='b'><joint name='j' axis='1 2 3'/>"
                       "<geom pos='0.3 0 0.1' size='0.1'/><geom " +
                           geom + "/></body></worldbody></mujoco>");
    host::Equations f(scene_of({file.file(), {}, false, 0, 0}));
    return accelerations(f, f.y0()).at("j.rate");
  };
  for (const std::string form : {"box", "ellipsoid", "capsule", "cylinder"}) {
    const bool round = form == "capsule" || form == "cylinder";
    const double want =
        scene("type='" + form + "' pos='0.2 0.5 0.1' zaxis='0 1 0' size='0.05 " + (round ? "0.4" : "0.05 0.4") + "'");
    EXPECT_NEAR(scene("type='" + form + "' fromto='0.2 0.1 0.1 0.2 0.9 0.1' size='0.05'"), want, 1e-12) << form;
    EXPECT_NEAR(scene("type='" + form + "' fromto='0.2 0.1 0.1 0.2 0.9 0.1' size='0.05 0.07 0.07'"), want, 1e-12)
        << form;
  }
}

/// A pendulum of 2 kg at 0.5 m on a hinge along y: 0.6 kg m² about it.
TEST(Mjcf, WeightSpringsAndDampersThatTheModelSwitchesOffDoNotAct) {
  const double q = 0.4, w = 1.5;
  const auto acceleration = [&](const std::string& option) {
    host::Equations f = equations_of(option + R"(<worldbody><body name="b">
<joint name="j" axis="0 1 0" stiffness="3" damping="0.2"/><inertial mass="2" pos="0.5 0 0" diaginertia=".1 .1 .1"/>
</body></worldbody>)");
    std::vector<double> y = f.y0();
    put(f, y, "j", q);
    put(f, y, "j.rate", w);
    return accelerations(f, y).at("j.rate");
  };
  const double weight = 2 * 9.81 * 0.5 * std::cos(q), spring = -3 * q, damper = -0.2 * w;
  EXPECT_NEAR(acceleration(""), (weight + spring + damper) / 0.6, 1e-12);
  EXPECT_NEAR(acceleration("<option><flag gravity='disable'/></option>"), (spring + damper) / 0.6, 1e-12);
  EXPECT_NEAR(acceleration("<option gravity='0 0 -9.81'><flag spring='disable'/></option>"), (weight + damper) / 0.6,
              1e-12);
  EXPECT_NEAR(acceleration("<option><flag damper='disable' contact='disable'/></option>"), (weight + spring) / 0.6,
              1e-12);
  EXPECT_NEAR(acceleration("<option><flag gravity='disable' passive='disable'/></option>"), 0, 1e-12);
  EXPECT_NEAR(acceleration("<option><flag spring='disable'/></option><option><flag spring='enable'/></option>"),
              (weight + spring + damper) / 0.6, 1e-12);
  EXPECT_THAT(model_of(R"(<option><flag spring="disable"/></option><worldbody><body><joint name="j" stiffness="3"/>
<geom size="0.1"/></body></worldbody>)")
                  .remarks,
              ElementsAre("joint \"j\": stiffness 3 is switched off by <flag>"));
}

/// Two carts on one line, one on the other. What a joint feels while the other is free: the first alone, and what is
/// left of the second when the first gives way. Armature counts in that, and in the motion.
TEST(Mjcf, ASpringdamperIsAsStiffAsTheInertiaThatTheJointFeelsAsks) {
  const double m = 3, n = 2, armature = 0.7, T = 0.5, ratio = 0.3;
  const auto got = [&](const std::string& option) {
    host::Equations f = equations_of(option + R"(<default><joint type="slide" axis="1 0 0" springdamper="0.5 0.3"/>
<default class="plain"><joint springdamper="0 0"/></default></default>
<worldbody><body><joint name="a" armature="0.7" stiffness="99"/><inertial mass="3" pos="0 0 0" diaginertia="1 1 1"/>
<body><joint name="b"/><inertial mass="2" pos="0 0 0" diaginertia="1 1 1"/></body></body>
<body><joint name="c" class="plain" stiffness="8"/><inertial mass="4" pos="0 0 0" diaginertia="1 1 1"/></body>
</worldbody>)");
    std::vector<double> y = f.y0();
    put(f, y, "a", 0.2);
    put(f, y, "b", -0.1);
    put(f, y, "c", 0.5);
    put(f, y, "a.rate", 0.3);
    put(f, y, "b.rate", 0.4);
    return accelerations(f, y);
  };
  const double of_a = m + armature, of_b = n - n * n / (m + n + armature);
  Eigen::Matrix2d M;
  M << m + n + armature, n, n, n;
  const auto want = [&](double spring, double damper) -> Eigen::Vector2d {
    const double k = spring / (T * T * ratio * ratio), c = damper * 2 / T;
    return M.ldlt().solve(-Eigen::Vector2d(of_a * (k * 0.2 + c * 0.3), of_b * (k * -0.1 + c * 0.4)));
  };
  for (const auto& [option, spring, damper] :
       {std::tuple("", 1, 1), std::tuple("<option><flag spring='disable'/></option>", 0, 1),
        std::tuple("<option><flag damper='disable'/></option>", 1, 0)}) {
    const auto all = got(option);
    const Eigen::Vector2d ab = want(spring, damper);
    EXPECT_NEAR(all.at("a.rate"), ab[0], 1e-12 * ab.norm()) << option;
    EXPECT_NEAR(all.at("b.rate"), ab[1], 1e-12 * ab.norm()) << option;
    EXPECT_NEAR(all.at("c.rate"), -spring * 8 * 0.5 / 4, 1e-12) << option;
  }
}

// On a ball with armature, about the axis they share: 0.5 − 0.5²/(0.25 + 0.5 + 0.25).
TEST(Mjcf, AJointFeelsTheArmatureOfAJointOfSeveralMotionsToo) {
  EXPECT_THAT(model_of(R"(<worldbody><body><joint name="ball" type="ball" armature="0.25"/>
<inertial mass="1" pos="0 0 0" diaginertia="0.25 0.25 0.25"/>
<body><joint name="j" springdamper="0.5 0.3"/><inertial mass="1" pos="0 0 0" diaginertia="0.5 0.5 0.5"/></body></body>
</worldbody>)")
                  .remarks,
              testing::Contains(HasSubstr("for the inertia 0.25 that the joint feels")));
}

// Coordinates of a file begin at `ref` where the scene's are zero, and so does where its springs are slack.
TEST(Mjcf, ASpringIsSlackWhereTheFileSaysInTheCoordinateOfTheScene) {
  const Tree tree = tree_of(R"(<worldbody><body>
<joint name="slide" type="slide" stiffness="3" springref="0.5" ref="0.2"/><joint stiffness="3" springref="50" ref="20"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body></worldbody>)");
  EXPECT_NEAR(tree.joints[0].free_position, 0.3, 1e-15);
  EXPECT_NEAR(tree.joints[1].free_position, std::numbers::pi / 6, 1e-15);
}

// The pose of a body is that of its first joint; the others have the body's frame where that has brought it.
TEST(Mjcf, ABodyWithSeveralJointsIsPlacedOnce) {
  const Tree tree = tree_of(R"(<worldbody><body pos="1 2 3" quat="0 1 0 0">
<joint type="slide" axis="1 0 0" pos="0 0 0.5"/><joint axis="0 1 0" pos="0.1 0 0"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body></worldbody>)");
  ASSERT_EQ(tree.joints.size(), 2U);
  EXPECT_EQ(tree.joints[0].offset.p, Vector3(1, 2, 2.5)) << "half a turn about x";
  EXPECT_EQ(tree.joints[1].offset.p, Vector3(0.1, 0, 0));
  EXPECT_EQ(tree.joints[1].offset.R, Matrix3::Identity());
}

TEST(Mjcf, AChildclassIsThatOfBodiesWithinUntilOneHasAnother) {
  const std::string inertial = "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>";
  const Tree tree = tree_of(
      "<default><default class='soft'><joint damping='2'/></default><default class='hard'><joint "
      "damping='9'/></default>"
      "</default><worldbody><body childclass='soft'><joint/>" +
      inertial + "<body><joint/>" + inertial + "<body childclass='hard'><joint/>" + inertial +
      "</body></body></body><body><joint/>" + inertial + "</body></worldbody>");
  std::vector<double> damping;
  for (const Joint& joint : tree.joints) damping.push_back(joint.damping);
  EXPECT_THAT(damping, ElementsAre(2, 2, 9, 0));
}

// Of 1 + 2 n nᵀ the second moments are 3/2, 3/2 and −1/2 along n: without the last it is (1 + n nᵀ) 3/2.
TEST(Mjcf, AMendedInertiaKeepsItsPrincipalAxes) {
  const Vector3 n = Vector3(1, 2, -2) / 3;
  const Matrix3 given = Matrix3::Identity() + 2 * n * n.transpose();
  std::ostringstream inside;
  inside.precision(17);
  inside << "<worldbody><body><joint/><inertial mass='1' pos='0 0 0' fullinertia='" << given(0, 0) << ' ' << given(1, 1)
         << ' ' << given(2, 2) << ' ' << given(0, 1) << ' ' << given(0, 2) << ' ' << given(1, 2)
         << "'/></body></worldbody>";
  const Matrix3 mended = tree_of(inside.str(), true).links[0].inertia;
  EXPECT_LT((mended - 1.5 * (Matrix3::Identity() + n * n.transpose())).norm(), 1e-14);
}

/// In MuJoCo axisangle, euler, xyaxes and zaxis are one attribute, which counts before `quat`, wherever that stands.
TEST(Mjcf, OrientationsOfDefaultClassesGiveWayToThoseOfTheElement) {
  const auto scene = [](const std::string& defaults, const std::string& turned) {
    host::Equations f =
        equations_of("<default>" + defaults + "</default><worldbody><body><joint name='j' axis='0 1 1'/><geom " +
                     turned + " type='box' size='0.1 0.2 0.3' pos='0.1 0.1 -0.3'/></body></worldbody>");
    return accelerations(f, f.y0()).at("j.rate");
  };
  const std::string quat = "quat='0.9 0.3 0.1 0'", euler = "euler='10 20 30'", about = "axisangle='1 1 0 40'",
                    z = "zaxis='0 1 0.3'", xy = "xyaxes='1 1 0 0 1 1'";
  const auto geom = [](const std::string& turned) { return "<geom " + turned + "/>"; };
  for (const std::string& outer : {quat, euler, about, z, xy})
    for (const std::string& inner : {euler, about, z, xy}) {
      const double want = scene("", inner);
      EXPECT_NEAR(scene(geom(outer), inner), want, 1e-12) << outer << " and " << inner;
      const std::string nested = geom(outer) + "<default class='c'>" + geom(inner) + "</default>";
      EXPECT_NEAR(scene(nested, "class='c'"), want, 1e-12) << nested;
      EXPECT_NEAR(scene(geom(inner), quat), want, 1e-12) << inner << " and " << quat;
    }
  EXPECT_GT(std::abs(scene("", euler) - scene("", quat)), 1e-3);
  EXPECT_NEAR(scene(geom(quat), ""), scene("", quat), 1e-12);
}

/// What a joint feels of a geom at its place, by the acceleration that a spring gives.
double felt(const std::string& joint, const std::string& geom) {
  host::Equations f = equations_of("<option gravity='0 0 0'/><worldbody><body><joint name='j' stiffness='1' " + joint +
                                   "/><geom shellinertia='true' " + geom + "/></body></worldbody>");
  std::vector<double> y = f.y0();
  put(f, y, "j", 1);
  return -1 / accelerations(f, y).at("j.rate");
}

/// By hand, surface by surface, in kg/m²; of an ellipsoid that is not a sphere as MuJoCo 3 has it.
TEST(Mjcf, AShellHasItsMassOnItsSurface) {
  const double pi = std::numbers::pi, r = 0.2, h = 0.5, a = 0.2, b = 0.5, c = 0.3;
  const double ball = 4 * pi * r * r, side = 4 * pi * r * h, discs = 2 * pi * r * r;
  const double x = 8 * b * c, y = 8 * c * a, z = 8 * a * b;
  struct Case {
    std::string geom;
    double mass, about_x, about_z;
  };
  const std::array<Case, 5> cases = {{
      {"size='0.2'", ball, ball * r * r * 2 / 3, ball * r * r * 2 / 3},
      {"type='capsule' size='0.2 0.5'", ball + side,
       side * (r * r / 2 + h * h / 3) + ball * (r * r * 2 / 3 + h * h + h * r), side * r * r + ball * r * r * 2 / 3},
      {"type='cylinder' size='0.2 0.5'", side + discs, side * (r * r / 2 + h * h / 3) + discs * (r * r / 4 + h * h),
       side * r * r + discs * r * r / 2},
      {"type='box' size='0.2 0.5 0.3'", x + y + z,
       x * (b * b + c * c) / 3 + y * (b * b + c * c / 3) + z * (b * b / 3 + c * c),
       x * (a * a + b * b / 3) + y * (a * a / 3 + b * b) + z * (a * a + b * b) / 3},
      {"type='ellipsoid' size='0.2 0.5 0.3'", 1.3481498679416252, 0.13342369714, 0.11472351672},
  }};
  for (const Case& one : cases) {
    const double exact = one.geom.find("ellipsoid") == std::string::npos ? 1e-12 : 5e-6;
    for (const auto& [density, share] : {std::pair("density='3'", 3.0), std::pair("mass='7'", 7 / one.mass)}) {
      const std::string geom = one.geom + " " + density;
      EXPECT_NEAR(felt("type='slide'", geom) / (share * one.mass), 1, 1e-12) << geom;
      EXPECT_NEAR(felt("axis='1 0 0'", geom) / (share * one.about_x), 1, exact) << geom;
      EXPECT_NEAR(felt("axis='0 0 1'", geom) / (share * one.about_z), 1, exact) << geom;
    }
  }
}

TEST(Mjcf, LooksHaveNoMassAndAnInertialStandsWhereGeomsHaveNone) {
  const auto scene = [](const std::string& compiler, const std::string& inside) {
    host::Equations f =
        equations_of(compiler + "<worldbody><body><joint name='j' axis='0 1 1'/>" + inside + "</body></worldbody>");
    return accelerations(f, f.y0()).at("j.rate");
  };
  const std::string ball = "<geom size='0.1' pos='0.3 0 0'/>", from_geoms = "<compiler inertiafromgeom='true'/>",
                    inertial = "<inertial mass='2' pos='0.1 0.2 0' diaginertia='1 2 2'/>";
  const double want = scene("", ball), want_inertial = scene("", inertial);
  EXPECT_NEAR(scene("", ball + "<geom type='mesh' mesh='m' density='0'/><geom type='mesh' mesh='m' mass='0'/>"), want,
              1e-12);
  EXPECT_NEAR(scene("<default><default class='look'><geom density='0'/></default></default>",
                    ball + "<geom class='look' type='box' size='1 1 1'/>"),
              want, 1e-12);
  EXPECT_NEAR(scene(from_geoms, inertial + ball), want, 1e-12);
  EXPECT_NEAR(scene(from_geoms, inertial), want_inertial, 1e-12);
  EXPECT_NEAR(scene(from_geoms, inertial + "<geom type='mesh' mesh='m' density='0'/>"), want_inertial, 1e-12);
}

TEST(Mjcf, BodiesWithoutNamesOnOneLineHaveNamesOfTheirOwn) {
  const std::string part = "<body><joint axis='1 0 0'/><joint axis='0 1 0'/><geom size='0.1'/></body>";
  host::Equations f = equations_of("<worldbody><body name='body_1_1'><joint name='body_1_joint_2'/>" + part + part +
                                   "<geom size='0.1'/></body></worldbody>");
  EXPECT_EQ(accelerations(f, f.y0()).size(), 10u);
  const auto scene =
      model_of("<worldbody>\n<body name='body_3'><joint/><geom size='1'/></body>\n" + part + "\n</worldbody>");
  EXPECT_THAT(scene.text, HasSubstr("  body_3_at_1:"));
}

TEST(Mjcf, WhatAJointOrBodyLosesIsTold) {
  const ImportedScene scene = model_of(R"(<compiler angle="radian"/><worldbody><body name="b"><plugin plugin="p"/>
<joint name="j" type="ball" range="0 0.5" springdamper="0.5 0.3"/><geom size="0.1"/></body></worldbody>)");
  EXPECT_THAT(scene.remarks, ElementsAre("joint \"j\": springdamper 0.5 0.3 is left out",
                                         "<plugin> on line 1: its forces are left out"));
  EXPECT_THAT(scene.text, HasSubstr("its range 0 to 0.5 is not enforced: it limits the whole angle"));
}

// A scene's coordinate is zero where the file's is `ref`.
TEST(Mjcf, ARangeIsToldInTheCoordinateOfTheScene) {
  const ImportedScene scene = model_of(R"(<compiler angle="radian"/><worldbody><body name="b">
<joint name="j" axis="0 1 0" ref="0.5" range="-0.25 1.5"/><geom size="0.1"/></body></worldbody>)");
  EXPECT_THAT(scene.text, HasSubstr("its range -0.75 to 1 is not enforced: see hinge-limit"));
}

TEST(Mjcf, WhatItCannotReadIsRefusedWithItsPlace) {
  std::string problems;
  try {
    model_of(R"(<compiler angle="radians" inertiafromgeom="yes"/><option><flag gravity="off"/></option>
<default><include file="x.xml"/></default>
<worldbody><body euler="1 2 3" quat="1 0 0 0"><joint springdamper="0.5 0"/>
<geom type="box" size="1 1 1" mesh="m"/><geom size="1" shellinertia="maybe"/><geom type="box" size="1 0 1"/>
</body></worldbody>)");
  } catch (const SceneError& e) {
    problems = e.what();
  }
  for (const char* one :
       {"1:9: /mujoco/compiler/@angle: got \"radians\"; need radian or degree",
        "@inertiafromgeom: got \"yes\"; need auto, true or false", "flag/@gravity: got \"off\"; need enable or disable",
        "2:10: /mujoco/default/include: <include> is not followed",
        "3:12: /mujoco/worldbody/body: got the orientations euler, quat; need one of them",
        "@springdamper: got 0.5 0; need a time constant and a damping ratio above 0, or 0 0"})
    EXPECT_THAT(problems, HasSubstr(one));
  try {
    model_of(R"(<worldbody><body><joint/><geom type="box" size="1 1 1" mesh="m"/>
<geom size="1" shellinertia="maybe"/><geom type="box" size="1 0 1"/></body></worldbody>)");
  } catch (const SceneError& e) {
    problems = e.what();
  }
  for (const char* one : {"@mesh: the box is fitted to a mesh, which is not in this file",
                          "@shellinertia: got \"maybe\"; need true or false", "@size: need 3 sizes of a box above 0"})
    EXPECT_THAT(problems, HasSubstr(one));
}

}  // namespace
}  // namespace withy::exchange
