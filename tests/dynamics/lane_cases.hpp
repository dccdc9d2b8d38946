/// \file
/// Cases that differ in numbers only, for lanes.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "random_case.hpp"
#include "withy/core/equations/lane_equations.hpp"

namespace withy::test {

/// A chain of rigid links and beams on revolute and prismatic hinges under loads and, where asked, driven at its root.
/// Text of one seed and another differs in numbers only.
inline std::string lane_chain(unsigned seed, bool planar, const std::string& beam, bool driven) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return std::to_string(std::uniform_real_distribution<double>(low, high)(random));
  };
  const auto axis = [&] {
    return planar ? "[0, 0, 1]" : "[" + number(0.2, 1) + ", " + number(-1, 1) + ", " + number(-1, 1) + "]";
  };
  std::string bodies, hinges;
  for (int b = 0; b < 6; ++b) {
    const std::string name = "b" + std::to_string(b);
    if (b % 2 == 1 && !beam.empty()) {
      bodies += "  " + name + ": {type: beam, length: " + number(0.5, 2) + ", mass_per_length: " + number(0.5, 2) +
                ", damping_ratio: 0.01, bending_y: {stiffness: " + number(20, 90) + ", " + beam + "}" +
                (planar ? "" : ", bending_z: {stiffness: " + number(20, 90) + ", " + beam + "}") +
                ", frames: {a: {at: tip}}}\n";
    } else {
      bodies += "  " + name + ": {type: rigid, mass: " + number(0.5, 3) + ", center_of_mass: [" + number(-0.2, 0.2) +
                ", " + number(-0.2, 0.2) + ", 0], inertia: [0.2, 0.25, " + number(0.2, 0.3) +
                ", 0, 0, 0], frames: {a: {position: [" + number(0.1, 0.3) + ", " + number(0.1, 0.3) + ", 0]}}}\n";
    }
    const std::string parent = b == 0 ? "world" : "b" + std::to_string(b - 1) + ".a";
    hinges += "  h" + std::to_string(b) +
              ": {type: " + (b == 4 ? "prismatic, axis: [0.6, 0.8, 0]" : "revolute, axis: " + axis()) +
              ", parent: " + parent + ", child: " + name + "}\n";
  }
  return "format: withy/1\ntime: {end: 1.0}\ngravity: [" + number(-9, 9) + ", -9.81, 0]\nbodies:\n" + bodies +
         "hinges:\n" + hinges +
         "loads:\n  motor: {type: hinge-effort, hinge: h2, law: sine, amplitude: " + number(1, 9) +
         ", period: 0.7}\n  spring: {type: hinge-spring, hinge: h3, stiffness: " + number(1, 9) + "}\n" +
         (driven ? "motions:\n  turn: {type: spin-up, hinge: h0, rate: " + number(1, 2) + ", duration: 0.6}\n" : "");
}

/// Which case is in each lane; −1: nobody.
using Places = std::vector<int>;
/// Case i in lane i + shift, cyclically.
inline Places in_order(std::size_t shift = 0) {
  Places places(lane_count());
  for (std::size_t i = 0; i < places.size(); ++i) places[(i + shift) % places.size()] = static_cast<int>(i);
  return places;
}
inline Places only(std::size_t k, std::size_t lane) {
  Places places(lane_count(), -1);
  places[lane % places.size()] = static_cast<int>(k);
  return places;
}

/// A case for each lane with a state of its own, and what their evaluation gives.
struct LaneCases {
  std::vector<std::unique_ptr<Case>> cases;
  std::unique_ptr<LaneEquations> lanes;
  std::vector<std::vector<double>> rates{lane_count()};
  std::vector<Work> work;
  std::vector<LaneCall> calls{lane_count()};

  LaneCases(const std::string& formulation, const std::function<std::string(unsigned)>& text) {
    for (unsigned k = 0; k < lane_count(); ++k) {
      cases.push_back(std::make_unique<Case>(text(k), formulation));
      Case& c = *cases.back();
      RandomScene random(100 + k, {});
      c.state = random.state(*c.scene.model, c.scene.initial);
      rates[k].resize(c.equations->size());
      work.push_back(c.equations->make_work());
      work.back().poison();
    }
    lanes = lane_equations(*cases[0]->equations);
  }
  [[nodiscard]] const EquationsOfMotion& equations(std::size_t k) const { return *cases[k]->equations; }

  void evaluate(const Places& of) {
    std::vector<LaneCall*> asked(of.size());
    for (std::size_t lane = 0; lane < of.size(); ++lane) {
      if (of[lane] < 0) continue;
      const auto k = static_cast<std::size_t>(of[lane]);
      lanes->put(lane, equations(k));
      rates[k].assign(rates[k].size(), std::numeric_limits<double>::quiet_NaN());
      calls[lane] = {0.3, cases[k]->state.y, rates[k], &work[k], {}};
      asked[lane] = &calls[lane];
    }
    lanes->derivatives(asked);
  }
};

inline void expect_bits(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i])) << what << ", element " << i;
}

struct LaneKind {
  std::string formulation, beam;
  bool planar = false, driven = false;
  [[nodiscard]] std::string text() const {
    return formulation + (planar ? ", in a plane, " : ", in space, ") + (beam.empty() ? "rigid" : beam) +
           (driven ? ", driven" : "");
  }
};

inline std::vector<LaneKind> lane_kinds() {
  std::vector<LaneKind> all;
  for (const std::string formulation : {"ruthless", "quadratic"}) {
    for (const std::string beam :
         {"", "modes: 1", "modes: 2", "modes: 3", "modes: 2, family: free-free", "modes: 4", "modes: 5"}) {
      for (const bool planar : {true, false}) {
        if ((beam.ends_with('4') || beam.ends_with('5')) && !planar) continue;
        all.push_back({formulation, beam, planar, beam.ends_with("2")});
      }
    }
  }
  return all;
}

}  // namespace withy::test
