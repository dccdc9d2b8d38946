// Models of MJCF have the accelerations that mechanics gives them, by hand; orientations in every form are the same.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <sstream>

#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

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

}  // namespace
}  // namespace withy::exchange
