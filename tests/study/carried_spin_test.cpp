// A disk that spins on a beam: what is said of equations without its gyroscopic moment, against frequencies with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "withy/study/indicators.hpp"
#include "withy/study/modes.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

/// A disk on the tip of a beam that bends alike in two directions.
std::string disk(double mass, double inertia, double rate, const std::string& formulation) {
  return fmt::format(R"(
formulation: {}
bodies:
  boom: {{type: beam, length: 1, mass_per_length: 1.0e-3, bending_y: {{stiffness: 10, modes: 3, family: orthogonal-polynomials}},
    bending_z: {{stiffness: 10, modes: 3, family: orthogonal-polynomials}}}}
  disk: {{type: rigid, mass: {}, inertia: [{}, {}, {}, 0, 0, 0]}}
hinges:
  root: {{type: weld, parent: world, child: boom}}
  axle: {{type: revolute, axis: [1, 0, 0], parent: boom.tip, child: disk}}
motions: {{spin: {{type: constant-rate, hinge: axle, rate: {}}}}}
)",
                     formulation, mass, 1.5 * inertia, inertia, inertia, rate);
}

/// The ratio that the indicator tells; 0 where there is none.
double told(const std::string& scene) {
  const Prepared prepared = scene_of(scene);
  for (const Indicator& i : indicators_at(prepared, prepared.scene.initial))
    if (i.text == "moment of what spins on 'boom' over what bends it") return i.value;
  return 0;
}

/// The two lowest frequencies [rad/s].
std::vector<double> lowest(const std::string& scene) {
  std::vector<double> all;
  for (const Mode& mode : modes_at(at_start(scene_of(scene)), true).modes) all.push_back(mode.frequency());
  std::sort(all.begin(), all.end());
  all.resize(2);
  return all;
}

TEST(CarriedSpin, IsTwiceTheErrorOfFrequenciesWithoutItsMomentOrLittleMore) {
  struct Case {
    double mass, inertia, least, most;  ///< and the error over the ratio
  };
  for (const Case& c : {Case{2, 1e-4, 0.36, 0.39}, Case{1e-3, 0.05, 0.45, 0.51}, Case{1, 0.2, 0.36, 0.51}}) {
    for (const double rate : {2.0, 20.0}) {
      const double ratio = told(disk(c.mass, c.inertia, rate, "ruthless"));
      // Beyond it the two frequencies part by more than in proportion.
      if (ratio > 0.2) continue;
      ASSERT_GT(ratio, 1e-6);
      const std::vector<double> without = lowest(disk(c.mass, c.inertia, rate, "ruthless")),
                                with = lowest(disk(c.mass, c.inertia, rate, "quadratic"));
      const double error = std::max(1 - with[0] / without[0], with[1] / without[1] - 1);
      EXPECT_GT(error, c.least * ratio) << c.mass << ' ' << rate;
      EXPECT_LT(error, c.most * ratio * (1 + ratio)) << c.mass << ' ' << rate;
    }
  }
}

TEST(CarriedSpin, IsOfEquationsWithoutProductsOfSpeedsAlone) {
  EXPECT_GT(told(disk(1, 0.2, 5, "rate-linear")), 0.01);
  for (const std::string formulation : {"linear", "symmetric", "consistent", "quadratic"})
    EXPECT_EQ(told(disk(1, 0.2, 5, formulation)), 0) << formulation;
}

/// A wheel whose axle is the one that the beam bends about has no moment across it.
TEST(CarriedSpin, InThePlaneOfBendingIsNone) {
  const std::string planar = R"(
formulation: ruthless
bodies:
  boom: {type: beam, length: 1, mass_per_length: 1.0e-3, bending_y: {stiffness: 10, modes: 3}}
  disk: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
hinges:
  root: {type: weld, parent: world, child: boom}
  axle: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: disk}
motions: {spin: {type: constant-rate, hinge: axle, rate: 500}}
)";
  EXPECT_EQ(told(planar), 0);
}

}  // namespace
}  // namespace withy::study
