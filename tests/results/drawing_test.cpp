/// \file
/// Slender bodies as lines: their points against frames that the engine has there.
#include "withy/results/report/drawing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "withy/core/kinematics/observation.hpp"
#include "withy/core/model/model.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy {
namespace {

/// Three beams of which two are equal and so one object, one whose root its modes move, and a rigid one.
constexpr const char* arms =
    "format: withy/1\ntime: {end: 1}\nbodies:\n"
    "  one: {type: beam, length: 1.5, mass_per_length: 1, bending_y: {stiffness: 9, modes: 2}, "
    "bending_z: {stiffness: 5, modes: 1}, frames: {middle: {at: 0.75}}}\n"
    "  rod: {type: beam, length: 0.7, mass_per_length: 2, frames: {middle: {at: 0.35}}}\n"
    "  two: {type: beam, length: 1.5, mass_per_length: 1, bending_y: {stiffness: 9, modes: 2}, "
    "bending_z: {stiffness: 5, modes: 1}, frames: {middle: {at: 0.75}}}\n"
    "  loose: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 9, modes: 2, family: free-free}, "
    "formulation: quadratic, frames: {middle: {at: 0.5}}}\n"
    "hinges:\n  a: {type: revolute, axis: [0, 0.6, 0.8], parent: world, child: one}\n"
    "  b: {type: spherical, parent: one.tip, child: rod}\n"
    "  c: {type: revolute, axis: [1, 0, 0], parent: rod.tip, child: two, offset: {position: [0, 0.1, 0]}}\n"
    "  d: {type: free, parent: world, child: loose}\n";

TEST(Drawing, LinesGoThroughTheFramesOfTheirBodiesInEveryFormulation) {
  Registry registry;
  enroll_static_plugins(registry);
  for (const char* formulation : {"quadratic", "exact", "linear", "ruthless", "consistent"}) {
    const Scene scene =
        parse_scene(arms, "arms.yaml", registry, {.formulation = formulation, .integrator = {}, .overrides = {}});
    std::vector<double> y = scene.initial.y;
    for (const Slot& slot : scene.model->layout().bodies)
      for (std::size_t k = 0; k < slot.positions; ++k)
        y[slot.position + k] = 0.1 * std::cos(static_cast<double>(slot.position + k));
    y[scene.model->layout().hinge("a")->position] = 0.4;
    Drawing drawing(scene.model, scene.formulation->terms());
    const auto lines = drawing.lines(y);
    const auto seen = observed_model(*scene.model, scene.formulation->terms())->make_observation();
    seen->observe(y);
    const std::vector<BodyNode>& bodies = scene.model->bodies();
    ASSERT_EQ(lines.size(), bodies.size());
    const auto from = [&](std::size_t b, const char* frame, const Vector3& point) {
      const WorldPose at = seen->frame_pose(static_cast<int>(b), bodies[b].frame(frame));
      return (Eigen::Map<const Vector3>(at.position.data()) - point).norm();
    };
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      constexpr double rounding = 1e-13;  // of places a few metres away
      EXPECT_LT(from(b, "root", lines[b].front()), rounding) << formulation << ' ' << bodies[b].name;
      EXPECT_LT(from(b, "middle", lines[b][lines[b].size() / 2]), rounding) << formulation << ' ' << bodies[b].name;
      EXPECT_LT(from(b, "tip", lines[b].back()), rounding) << formulation << ' ' << bodies[b].name;
    }
  }
}

}  // namespace
}  // namespace withy
