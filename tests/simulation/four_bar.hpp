/// \file
/// A four-bar linkage, its motion in the one coordinate that it has, and what tests of closed loops do with it.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "made_scene.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {

inline const ClosedLoops& loops_of(const EquationsOfMotion& equations) {
  return dynamic_cast<const ClosedLoops&>(equations);
}

/// Samples 20 instants.
inline RunSummary run(const Made& made, double end, const std::function<void(const State&)>& output = {},
                      RunOptions options = {}) {
  options.end = end;
  options.output = end / 20;
  return simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options, output);
}

inline std::vector<double> read_sensors(const Made& made, const State& state) {
  SensorReader reader(made.scene.outputs, *made.equations);
  std::vector<double> values(reader.columns().size());
  EXPECT_TRUE(reader.read(state, values));
  return values;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no '" + from + "'");
  return text.replace(at, from.size(), to);
}

/// Four-bar linkage in the plane. `coupler` stands for the coupler's own lines.
inline std::string four_bar(const std::string& coupler, const std::string& integrator) {
  return R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1}
integrator: )" +
         integrator + R"(
bodies:
  crank: {type: rigid, mass: 1.2, center_of_mass: [0.15, 0.02, 0], inertia: [0.0005, 0.009, 0.009, 0, 0, 0], frames: {pin: {position: [0.3, 0, 0]}}}
  coupler: )" +
         coupler + R"(
  rocker: {type: rigid, mass: 2.0, center_of_mass: [0.4, 0, 0], inertia: [0.001, 0.11, 0.11, 0, 0, 0], frames: {pin: {position: [0.8, 0, 0]}}}
hinges:
  motor: {type: revolute, axis: [0, 0, 1], parent: world, child: crank}
  elbow: {type: revolute, axis: [0, 0, 1], parent: crank.pin, child: coupler}
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rocker, offset: {position: [0.9, 0, 0]}}
constraints:
  loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: coupler.tip, b: rocker.pin}
loads:
  torque: {type: hinge-effort, hinge: motor, law: constant, value: 1.5}
initial:
  hinges: {motor: {position: ["90 deg"], rate: [6]}}
  guess: {hinges: {elbow: {position: ["-60 deg"]}, pivot: {position: ["80 deg"]}}}
)";
}
constexpr const char* rigid_coupler =
    "{type: rigid, mass: 0.54, center_of_mass: [0.5, 0, 0], inertia: [0.0001, 0.045, 0.045, 0, 0, 0], frames: {tip: "
    "{position: [1.0, 0, 0]}}}";
constexpr const char* beam_coupler =
    "{type: beam, length: 1.0, mass_per_length: 0.54, bending_y: {stiffness: 20.0, modes: 2, family: pinned-pinned}}";

/// That linkage in the angle of its crank alone: crank r, coupler c, rocker s, their pivots d apart.
class Linkage {
  static constexpr double r = 0.3, c = 1.0, s = 0.8, d = 0.9;

 public:
  struct Place {
    double coupler, rocker;  ///< angles in the world
  };
  static Place place(double theta) {
    // The circle about the crank's pin and that about the rocker's pivot.
    const double x = d - r * std::cos(theta), y = -r * std::sin(theta), l = std::hypot(x, y);
    const double at = std::acos((c * c + l * l - s * s) / (2 * c * l));
    const double coupler = std::atan2(y, x) + at;
    const double px = r * std::cos(theta) + c * std::cos(coupler), py = r * std::sin(theta) + c * std::sin(coupler);
    return {coupler, std::atan2(py, px - d)};
  }
  /// Twice the kinetic energy at unit rate, and the potential energy.
  static double inertia(double theta) {
    const Place p = place(theta);
    // r e'(θ) + c e'(φ) φ' = s e'(ψ) ψ'
    const double phi = r * std::sin(p.rocker - theta) / (c * std::sin(p.coupler - p.rocker));
    const double psi = r * std::sin(p.coupler - theta) / (s * std::sin(p.coupler - p.rocker));
    const double vx = -r * std::sin(theta) - 0.5 * std::sin(p.coupler) * phi;
    const double vy = r * std::cos(theta) + 0.5 * std::cos(p.coupler) * phi;
    return 0.009 + 1.2 * (0.15 * 0.15 + 0.02 * 0.02) + 0.54 * (vx * vx + vy * vy) + 0.045 * phi * phi +
           (0.11 + 2.0 * 0.4 * 0.4) * psi * psi;
  }
  static double weight(double theta) {
    const Place p = place(theta);
    return 9.81 * (1.2 * (0.15 * std::sin(theta) + 0.02 * std::cos(theta)) +
                   0.54 * (r * std::sin(theta) + 0.5 * std::sin(p.coupler)) + 2.0 * 0.4 * std::sin(p.rocker));
  }
  /// I θ̈ + ½ I' θ̇² + V' = τ, by the classical Runge–Kutta method with steps far below its error.
  static std::pair<double, double> at(double time) {
    constexpr int steps = 4000;
    const double h = time / steps;
    double x = M_PI / 2, u = 6;
    const auto slope = [](double (*f)(double), double at) {
      constexpr double e = 2e-3;
      return (8 * (f(at + e) - f(at - e)) - (f(at + 2 * e) - f(at - 2 * e))) / (12 * e);
    };
    const auto acceleration = [&](double at, double rate) {
      return (1.5 - slope(&weight, at) - 0.5 * slope(&inertia, at) * rate * rate) / inertia(at);
    };
    for (int i = 0; i < steps; ++i) {
      const double a1 = acceleration(x, u), u2 = u + h / 2 * a1, a2 = acceleration(x + h / 2 * u, u2);
      const double u3 = u + h / 2 * a2, a3 = acceleration(x + h / 2 * u2, u3);
      const double u4 = u + h * a3, a4 = acceleration(x + h * u3, u4);
      x += h / 6 * (u + 2 * u2 + 2 * u3 + u4);
      u += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return {x, u};
  }
};

}  // namespace withy::test
