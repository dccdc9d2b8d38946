/// \file
/// Loops that are closed where a run begins: at the pose that their hinge stands for, in scenes of any size.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <string>

#include "four_bar.hpp"

namespace withy::test {
namespace {

/// What a user is told of a scene that is refused; empty where it is good.
std::string refusal(const std::string& scene) {
  try {
    const Made unused(scene);
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

/// A box on a tree's hinge, held by a constraint whose F is turned.
std::string held_box(const std::string& carried_by, const std::string& held_by, const std::string& axis, double angle) {
  return R"(format: withy/1
time: {end: 1}
bodies:
  box: {type: rigid, mass: 2, inertia: [1, 2, 2.5, 0, 0, 0], center_of_mass: [0.1, 0, 0], frames: {f: {position: [0.2, 0, 0]}}}
hinges:
  carrier: {type: )" +
         carried_by + R"(, parent: world, child: box}
constraints:
  hold: {type: hinge, hinge: )" +
         held_by + R"(, a: world, b: box.f, offset: {position: [0.2, 0, 0], orientation: {axis: )" + axis +
         ", angle: \"" + std::to_string(angle) + " deg\"}}}\n";
}

// The equations of three directions have more solutions than the hinge's pose: half turns, and turns by 120° about the
// diagonals, from or to which Newton's method may go.
TEST(LoopAssembly, AHingeThatHoldsAllDirectionsIsClosedAtItsPoseWhereverItBegins) {
  struct Axis {
    const char* text;
    Vector3 axis;
  };
  for (const Axis& a :
       {Axis{"[1, 1, 1]", {1, 1, 1}}, Axis{"[1, -1, -1]", {1, -1, -1}}, Axis{"[1, 1, 0.9]", {1, 1, 0.9}},
        Axis{"[1, 0.2, 0.3]", {1, 0.2, 0.3}}, Axis{"[0, 0, 1]", {0, 0, 1}}}) {
    for (const double angle : {-120.0, -100.0, 40.0, 90.0, 119.0, 120.0, 170.0, 180.0}) {
      for (const char* hinge : {"weld", "prismatic, axis: [0.2, 1, 0.3]"}) {
        SCOPED_TRACE(std::string(hinge) + " about " + a.text + " by " + std::to_string(angle));
        const Made made(held_box("free", hinge, a.text, angle));
        const Slot& slot = *made.scene.model->layout().hinge("carrier");
        const double* x = &made.scene.initial.y[slot.position];
        const Eigen::Quaterniond is(x[0], x[1], x[2], x[3]);
        const Eigen::Quaterniond wanted(Eigen::AngleAxisd(angle * M_PI / 180, a.axis.normalized()));
        EXPECT_LT(is.angularDistance(wanted), 1e-7);
        Work work = made.equations->make_work();
        EXPECT_TRUE(loops_of(*made.equations).right_way_round(made.scene.initial.y, 0, work));
        if (std::string(hinge) == "weld") {
          EXPECT_LT((Vector3(x[4], x[5], x[6]) + is * Vector3(0.2, 0, 0) - Vector3(0.2, 0, 0)).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(LoopAssembly, AHingeThatCannotTurnToItsPoseIsRefused) {
  for (const double angle : {120.0, -120.0, 180.0}) {
    const std::string said = refusal(held_box("prismatic, axis: [1, 0, 0]", "weld", "[1, 1, 1]", angle));
    EXPECT_THAT(said, testing::HasSubstr("/constraints/hold: the loop c")) << angle;
  }
  EXPECT_THAT(refusal(held_box("prismatic, axis: [1, 0, 0]", "weld", "[1, 1, 1]", -120)),
              testing::HasSubstr("turned over by half or a third of a turn"));
}

}  // namespace
}  // namespace withy::test
