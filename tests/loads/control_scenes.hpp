/// \file
/// Scenes of loops with controllers, and what their motion is known to be.
#pragma once

#include <Eigen/Core>
#include <string>

#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {

constexpr double turntable_inertia = 0.2;  ///< [kg m²], about its axle

inline const std::string pid_turntable =
    turntable +
    "loads: {servo: {type: pid, hinge: axle, proportional: 5, integral: 4, derivative: 1, "
    "filter: 0.05, reference: 0.5}}\n";

/// A mass on a spring whose accelerometer feeds a force back through a lag: m ẍ = −k x − (g/T) z, ż = −z/T + ẍ.
constexpr double m_felt = 2, k_felt = 30, g_felt = 1.5, T_felt = 0.1;
inline const std::string felt = R"(format: withy/1
time: {end: 2, output: 0.01}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
initial: {hinges: {slide: {position: [0.3]}}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  command: {type: input, hinge: slide}
)";
inline const std::string felt_lag =
    felt + "  servo: {type: transfer-function, of: imu.x, to: command, numerator: [-1.5], denominator: [0.1, 1]}\n";

/// Of x, ẋ, z.
inline Eigen::Matrix3d felt_matrix() {
  Eigen::Matrix3d A;
  A << 0, 1, 0, -k_felt / m_felt, 0, -g_felt / T_felt / m_felt, 0, 0, -1 / T_felt;
  A.row(2) += A.row(1);  // ż sees ẍ
  return A;
}

}  // namespace withy::test
