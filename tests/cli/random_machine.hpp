/// \file
/// Random scenes for the campaigns of docs/advise.md, and where their findings are kept.
#pragma once

#include <cmath>
#include <random>
#include <sstream>
#include <string>

namespace withy::test {

/// Small scenes of what flexible multibody dynamics is used for: driven arms, spinning blades, booms on a floating bus,
/// pendulums; in the plane and in space; from hardly bent to a tenth of the length.
class RandomMachine {
 public:
  explicit RandomMachine(unsigned seed) : random_(seed) {}

  std::string text() {
    const bool spatial = chance(0.35), damped = chance(0.4);
    const double end = number(0.6, 2.0);
    const int links = whole(1, spatial ? 1 : 2);
    out_ << "format: withy/1\nname: random machine\ntime: {end: " << end << ", output: 0.02}\n";
    if (chance(0.4)) out_ << "gravity: [0, " << number(-9.81, -0.5) << ", 0]\n";
    out_ << "bodies:\n  hub: {type: rigid, mass: " << number(1, 20) << ", inertia: [1, 1, " << number(0.05, 2)
         << ", 0, 0, 0], frames: {rim: {position: [" << number(0, 0.3) << ", 0, 0]}}}\n";
    std::ostringstream hinges, loads, motions;
    const int root = whole(0, 3);
    if (root == 0)
      motions << "  spin: {type: spin-up, hinge: base, rate: " << number(0.5, 5)
              << ", duration: " << number(0.5, 1.0) * end << "}\n";
    if (root == 1)
      hinges << "  base: {type: free, parent: world, child: hub}\n";
    else
      hinges << "  base: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n";
    if (root == 1)
      loads << "  jet: {type: torque, frame: hub, law: constant, value: [0, 0, " << number(0.5, 5) << "]}\n";
    if (root >= 2) effort(loads, "base", number(1, 20));
    std::string from = "hub.rim";
    for (int i = 0; i < links; ++i) {
      const std::string link = "link" + std::to_string(i), load = "load" + std::to_string(i);
      const double length = number(0.5, 3), density = number(0.3, 2), mass = chance(0.7) ? number(0.1, 3) : 1e-3;
      // First frequency between 3 and 40 rad/s, tip mass counted.
      const double w = std::exp(number(std::log(3.0), std::log(40.0)));
      const double stiffness = w * w * (mass + 0.24 * density * length) * length * length * length / 3;
      out_ << "  " << link << ": {type: beam, length: " << length << ", mass_per_length: " << density
           << ", bending_y: {stiffness: " << stiffness << ", modes: 2}";
      if (spatial) {
        out_ << ", bending_z: {stiffness: " << stiffness * number(0.5, 2)
             << ", modes: 2}, torsion: {stiffness: " << stiffness * number(0.5, 1)
             << ", inertia: " << 0.01 * density * length * length << ", modes: 1}";
      }
      out_ << (damped ? ", damping_ratio: 0.02" : "") << "}\n";
      out_ << "  " << load << ": {type: rigid, mass: " << mass << ", inertia: [" << 0.01 * mass << ", " << 0.01 * mass
           << ", " << 0.01 * mass << ", 0, 0, 0]}\n";
      if (i == 0) {
        hinges << "  root0: {type: weld, parent: hub.rim, child: link0}\n";
      } else {
        hinges << "  elbow: {type: revolute, axis: [0, 0, 1], parent: " << from << ", child: " << link << "}\n";
        effort(loads, "elbow", number(0.2, 4));
      }
      hinges << "  end" << i << ": {type: weld, parent: " << link << ".tip, child: " << load << "}\n";
      from = load;
    }
    if (spatial)
      loads << "  push: {type: force, frame: link0.tip, law: constant, value: [0, 0, " << number(0.05, 1) << "]}\n";
    out_ << "hinges:\n" << hinges.str();
    if (!loads.str().empty()) out_ << "loads:\n" << loads.str();
    if (!motions.str().empty()) out_ << "motions:\n" << motions.str();
    return out_.str();
  }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool chance(double p) { return number(0, 1) < p; }
  void effort(std::ostringstream& loads, const char* hinge, double amplitude) {
    loads << "  motor_" << hinge << ": {type: hinge-effort, hinge: " << hinge << ", law: sine, amplitude: " << amplitude
          << ", period: " << number(0.5, 3) << "}\n";
  }

  std::mt19937 random_;
  std::ostringstream out_;
};

}  // namespace withy::test
