/// \file
/// A body that a beam carries between its ends: how modes of the whole beam converge, and what cutting it there does.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "blade.hpp"

namespace withy::test {
namespace {

/// The lowest frequency [rad/s] of a clamped beam with a heavy body at its middle.
double lowest(const std::string& pieces, int modes, const std::string& family) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
bodies:
  beam: {type: beam, length: 1, mass_per_length: 1, )" +
                      pieces + "bending_y: {stiffness: 1, modes: " + std::to_string(modes) + ", family: " + family +
                      R"(}, frames: {mid: {at: 0.5}}}
  lump: {type: rigid, mass: 5, inertia: [0.5, 0.5, 0.5, 0, 0, 0]}
hinges:
  root: {type: weld, parent: world, child: beam}
  on: {type: weld, parent: beam.mid, child: lump}
)",
                  "quadratic");
  std::vector<double> all;
  for (const Mode& mode : steady_modes(c, {})) all.push_back(mode.frequency());
  return *std::min_element(all.begin(), all.end());
}

TEST(CarriedBetweenTheEnds, ModesOfTheWholeBeamConvergeWithTheirNumberAlone) {
  const double exact = lowest("segments: 2, ", 8, "orthogonal-polynomials");
  for (const std::string family : {"clamped-free", "orthogonal-polynomials", "craig-bampton"}) {
    const double ten = lowest("", 10, family) / exact - 1, twenty = lowest("", 20, family) / exact - 1;
    EXPECT_GT(twenty, 1e-3) << family;
    EXPECT_NEAR(ten / twenty, 2, 0.2) << family;
  }
}

TEST(CarriedBetweenTheEnds, ABeamThatIsCutThereNeedsTwoModesAPiece) {
  const double exact = lowest("segments: 2, ", 8, "orthogonal-polynomials");
  for (const std::string family : {"orthogonal-polynomials", "craig-bampton"})
    EXPECT_NEAR(lowest("segments: 2, ", 2, family), exact, 3e-5 * exact) << family;
}

}  // namespace
}  // namespace withy::test
