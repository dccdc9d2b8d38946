// Effective masses of modes.
#include "withy/study/effective_mass.hpp"

#include <gtest/gtest.h>

#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

/// 61.31, 18.83 and 6.47 % in the first three modes of a clamped beam, as textbooks have it; all of it where the base
/// is free.
TEST(EffectiveMass, OfABeamIsTheTextbooksAndInAllTheMassThatIsFree) {
  const std::string beam =
      "bodies: {boom: {type: beam, length: 2, mass_per_length: 3, bending_y: {stiffness: 40, modes: 8, family: "
      "clamped-free}}}\n";
  const EffectiveMasses clamped =
      effective_masses(at_start(scene_of(beam + "hinges: {root: {type: weld, parent: world, child: boom}}\n")));
  EXPECT_NEAR(clamped.total, 6, 1e-12);
  const Eigen::VectorXd y = clamped.masses().row(1) / clamped.total;
  EXPECT_NEAR(y[0], 0.6131, 1e-4);
  EXPECT_NEAR(y[1], 0.1883, 1e-4);
  EXPECT_NEAR(y[2], 0.0647, 1e-4);
  EXPECT_LT(clamped.sum()[1], clamped.total);
  EXPECT_EQ(clamped.sum()[2], 0) << "nothing bends that way";
  const EffectiveMasses sliding = effective_masses(
      at_start(scene_of(beam + "hinges: {root: {type: prismatic, axis: [0, 1, 0], parent: world, child: boom}}\n"
                               "loads: {base: {type: hinge-spring, hinge: root, stiffness: 100}}\n")));
  EXPECT_NEAR(sliding.sum()[1], sliding.total, 1e-10);
  EXPECT_GT(sliding.frequencies[0], 0);
}

}  // namespace
}  // namespace withy::study
