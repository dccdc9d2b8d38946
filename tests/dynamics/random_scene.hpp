/// \file
/// Seeded random trees of rigid bodies and beams, as scene text, and random states of them.
#pragma once

#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy::test {

struct SceneWish {
  int bodies = 5;
  bool planar = false;      ///< everything in the x-y plane
  bool any_root = false;    ///< beams may be held at their tip
  bool any_family = false;  ///< beams may bend in any mode family, those whose root moves too
  bool floating = true;     ///< a free hinge to the world is possible
  int modes = 0;            ///< in bending_y of every beam, half of them in bending_z and torsion; 0: one to three
  bool aligned = false;     ///< hinges are along x and z, frames are not turned
  bool rotary = false;      ///< sections have inertia in bending
  bool stretching =
      false;             ///< beams have extension and shear, and inertia in bending, without which shear undoes a turn
  bool varying = false;  ///< beams vary along their length, and have modes of their own: strains with kinks
  bool geared = true;    ///< some hinges of one rate have a reflected inertia
};

/// Text of a random scene; the same seed gives the same text.
class RandomScene {
 public:
  RandomScene(unsigned seed, SceneWish wish) : random_(seed), gears_(seed), wish_(wish) {
    text_ << "format: withy/1\ntime: {end: 1.0}\ngravity: [" << number(-9, 9) << ", " << number(-9, 9) << ", "
          << (wish.planar ? 0.0 : number(-9, 9)) << "]\n";
    std::ostringstream hinges;
    text_ << "bodies:\n";
    for (int b = 0; b < wish.bodies; ++b) add(b, hinges);
    text_ << "hinges:\n" << hinges.str();
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

  /// Moderate deflections (large ones where beams vary) and rates about the initial state; quaternions of unit length.
  State state(const Model& model, State s) {
    const Layout& layout = model.layout();
    for (std::size_t i = 0; i < layout.speeds; ++i) s.y[layout.positions + i] = number(-1, 1);
    for (const Slot& h : layout.hinges) {
      for (std::size_t i = 0; i < h.positions; ++i) s.y[h.position + i] = number(-1, 1);
    }
    const double bent = wish_.varying ? 0.2 : 0.02;  // what kinks do is of second order
    for (const Slot& b : layout.bodies) {
      for (std::size_t i = 0; i < b.positions; ++i) s.y[b.position + i] = number(-bent, bent);
    }
    for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
      const Slot& slot = layout.hinges[h];
      model.hinges()[h].hinge->normalize(std::span(s.y).subspan(slot.position, slot.positions));
    }
    return s;
  }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool chance(double p) { return number(0, 1) < p; }

  std::string family() {
    if (wish_.varying) return ", family: vibration-modes";
    if (!wish_.any_family) return "";
    const char* families[] = {"clamped-free",
                              "clamped-clamped",
                              "clamped-pinned",
                              "pinned-pinned",
                              "pinned-free",
                              "free-free",
                              "craig-bampton",
                              "orthogonal-polynomials",
                              "{name: clamped-loaded, tip_mass: 0.7}"};
    return std::string(", family: ") + families[whole(0, 8)];
  }
  /// A property of a beam: a number, or a table over its length.
  std::string along(double low, double high, double length) {
    std::ostringstream s;
    if (!wish_.varying) {
      s << number(low, high);
      return s.str();
    }
    s.precision(17);
    s << "[";
    for (const double part : {0.0, 0.3, 0.7, 1.0})
      s << (part > 0 ? ", [" : "[") << part * length << ", " << number(low, high) << "]";
    s << "]";
    return s.str();
  }
  [[nodiscard]] std::string rotary() const { return wish_.rotary || wish_.stretching ? ", rotary_inertia: 0.002" : ""; }
  std::string direction() {
    if (wish_.planar) return "[0, 0, 1]";
    if (wish_.aligned) return chance(0.5) ? "[1, 0, 0]" : "[0, 0, 1]";  // the second axis is y
    std::ostringstream s;
    s << "[" << number(0.1, 1) << ", " << number(-1, 1) << ", " << number(-1, 1) << "]";
    return s.str();
  }
  std::string pose() {
    std::ostringstream s;
    s.precision(17);
    double w = number(0.3, 1), x = number(-1, 1), y = number(-1, 1), z = number(-1, 1);
    if (wish_.planar || wish_.aligned) x = y = 0;
    if (wish_.aligned) z = 0;
    const double norm = std::sqrt(w * w + x * x + y * y + z * z);
    s << "position: [" << number(-0.3, 0.3) << ", " << number(-0.3, 0.3) << ", " << number(-0.3, 0.3)
      << "], orientation: [" << w / norm << ", " << x / norm << ", " << y / norm << ", " << z / norm << "]";
    return s.str();
  }

  /// Of a hinge of one rate.
  std::string gear() {
    std::ostringstream s;
    if (wish_.geared && std::uniform_int_distribution<int>(0, 1)(gears_) == 1)
      s << ", reflected_inertia: " << std::uniform_real_distribution<double>(0.05, 2)(gears_);
    return s.str();
  }

  void stretch(bool in_space) {
    const auto strain = [this](const char* name, double low, double high) {
      text_ << "    " << name << ": {stiffness: " << number(low, high) << ", modes: " << whole(1, 2)
            << ", family: orthogonal-polynomials}\n";
    };
    strain("extension", 300, 900);
    strain("shear_y", 100, 300);
    if (in_space) strain("shear_z", 100, 300);
  }

  void add(int b, std::ostringstream& hinges) {
    const bool beam = b > 0 && chance(0.6);
    const std::string name = "b" + std::to_string(b);
    text_ << "  " << name << ":\n";
    if (beam) {
      const int half = wish_.modes / 2;
      std::ostringstream written;  // tables end where the beam does, to the digit
      written << number(0.5, 2);
      const double length = std::stod(written.str());
      text_ << "    type: beam\n    length: " << length << "\n    mass_per_length: " << along(0.5, 2, length) << "\n"
            << "    damping_ratio: 0.01\n    bending_y: {stiffness: " << along(20, 90, length)
            << ", modes: " << (wish_.modes > 0 ? wish_.modes : whole(1, 3)) << family() << rotary() << "}\n";
      const bool bends_in_space = !wish_.planar && chance(0.7);
      if (bends_in_space) {
        text_ << "    bending_z: {stiffness: " << along(20, 90, length)
              << ", modes: " << (half > 0 ? half : whole(1, 2)) << family() << rotary() << "}\n";
      }
      // Always, so that no hinge can spin a beam about an axis without inertia.
      if (!wish_.planar) {
        text_ << "    torsion: {stiffness: " << along(20, 90, length)
              << ", inertia: 0.003, modes: " << (half > 0 ? half : whole(0, 2))
              << (wish_.varying                     ? family()
                  : wish_.any_family && chance(0.5) ? ", family: free-free"
                                                    : "")
              << "}\n";
      }
      if (wish_.stretching) stretch(bends_in_space);
      text_ << "    frames: {a: {at: tip, " << pose() << "}, m: {at: 0.31, " << pose() << "}, r: {at: root, " << pose()
            << "}}\n";
    } else {
      const double i = number(0.1, 0.3);
      text_ << "    type: rigid\n    mass: " << number(0.5, 3) << "\n    center_of_mass: [" << number(-0.2, 0.2) << ", "
            << number(-0.2, 0.2) << ", " << number(-0.2, 0.2) << "]\n    inertia: [" << i << ", " << 1.2 * i << ", "
            << 1.3 * i << ", 0.01, -0.02, 0.015]\n    frames: {a: {" << pose() << "}, m: {" << pose() << "}}\n";
    }
    hinges << "  h" << b << ": {";
    int parent = -1;
    if (b > 0) parent = whole(0, b - 1);
    const char* places[] = {"a", "m"};
    if (parent < 0) {
      hinges << "parent: world, ";
    } else {
      hinges << "parent: b" << parent << "." << places[whole(0, 1)] << ", ";
    }
    hinges << "child: " << name;
    if (beam && chance(0.4)) hinges << (wish_.any_root && chance(0.7) ? ".a" : ".r");
    hinges << ", offset: {" << pose() << "}, ";
    const int kind = parent < 0 && wish_.floating && !wish_.planar ? 8 : whole(0, wish_.planar ? 2 : 7);
    if (kind == 8) hinges << "type: free}\n";
    if (kind == 0) hinges << "type: weld}\n";
    if (kind == 1) hinges << "type: revolute, axis: " << direction() << gear() << "}\n";
    if (kind == 2 && wish_.planar) hinges << "type: prismatic, axis: [0.6, 0.8, 0]" << gear() << "}\n";
    if (kind == 2 && !wish_.planar) hinges << "type: prismatic, axis: " << direction() << gear() << "}\n";
    if (kind == 3) hinges << "type: spherical}\n";
    if (kind == 4) hinges << "type: universal, first_axis: " << direction() << ", second_axis: [0, 1, 0]}\n";
    if (kind == 5) hinges << "type: cylindrical, axis: " << direction() << "}\n";
    if (kind == 6) hinges << "type: planar, normal: " << direction() << ", along: [0, 1, 0]}\n";
    if (kind == 7)
      hinges << "type: screw, axis: " << direction() << ", pitch: " << number(-0.5, 0.5) << gear() << "}\n";
  }

  std::mt19937 random_;
  std::mt19937 gears_;  ///< of its own, so that these trees are those without gears but for them
  SceneWish wish_;
  std::ostringstream text_;
};

}  // namespace withy::test
