/// \file
/// Bodies as surfaces: their vertices against frames that the engine puts on the bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/core/kinematics/observation.hpp"
#include "withy/core/model/model.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/report/drawing.hpp"
#include "withy/scene/scene.hpp"

namespace withy {
namespace {

/// A scene whose last body is the one that bends, in some state, drawn as a page has it.
struct DrawnBody {
  Scene scene;
  std::vector<double> y;
  std::vector<Vector3> vertices;  ///< world [m]

  DrawnBody(const std::string& text, const std::string& file, const std::string& formulation, double amplitude,
            double angle, Registry& registry)
      : scene(parse_scene("format: withy/1\ntime: {end: 1}\nformulation: " + formulation + "\n" + text, file, registry,
                          {})),
        y(scene.initial.y) {
    const Slot& modes = scene.model->layout().bodies[0];
    for (std::size_t k = 0; k < modes.positions; ++k)
      y[modes.position + k] = amplitude * std::cos(1.0 + static_cast<double>(k)) / static_cast<double>(1 + k * k);
    y[scene.model->layout().hinges[0].position] = angle;
    Drawing drawing(scene.model, scene.formulation->terms(), Looks(scene));
    std::vector<float> numbers;
    drawing.append(y, numbers);
    EXPECT_EQ(numbers.size(), drawing.size());
    const std::size_t last = scene.model->bodies().size() - 1;
    const auto number = [&](std::size_t i) { return static_cast<double>(numbers[7 * last + i]); };
    const Matrix3 R = Eigen::Quaterniond(number(3), number(4), number(5), number(6)).toRotationMatrix();
    const Eigen::MatrixXf& shapes = drawing.shapes(last).shapes();
    const Eigen::VectorXf moved = shapes * Eigen::Map<const Eigen::VectorXf>(&numbers[7 * last + 7], shapes.cols());
    const auto at_rest = drawing.parts()[last].at("points").get<std::vector<double>>();
    for (std::size_t i = 0; i < at_rest.size(); i += 3) {
      const Vector3 r =
          Eigen::Map<const Vector3>(&at_rest[i]) + moved.segment<3>(static_cast<Eigen::Index>(i)).cast<double>();
      vertices.push_back(Vector3(number(0), number(1), number(2)) + R * r);
    }
  }
  /// Where the engine has a frame of the body, in the world [m].
  [[nodiscard]] Vector3 frame(const std::string& name) const {
    const auto seen = observed_model(*scene.model, scene.formulation->terms())->make_observation();
    seen->observe(y);
    const std::vector<BodyNode>& bodies = scene.model->bodies();
    const WorldPose pose = seen->frame_pose(static_cast<int>(bodies.size()) - 1, bodies.back().frame(name));
    return Eigen::Map<const Vector3>(pose.position.data());
  }
};

constexpr const char* formulations[] = {"quadratic", "consistent", "ruthless", "linear", "inconsistent", "symmetric"};

TEST(Surfaces, OfAPlateGoThroughItsFramesInEveryFormulation) {
  Registry registry;
  enroll_static_plugins(registry);
  const std::string plate =
      "bodies: {hub: {type: rigid, mass: 5, inertia: [1, 1, 1, 0, 0, 0]}, panel: {type: plate, length: 1.2, width: "
      "0.8, mass_per_area: 2.7, stiffness: 5, modes: 4, frames: {\n"
      "  middle: {at: \"(0.6, -0.2)\"}, corner: {at: left}, end: {at: 1.2}, inside: {at: \"(0.3,0.1)\"}}}}\n"
      "hinges: {axle: {type: revolute, axis: [0.6, 0, 0.8], parent: world, child: hub},\n"
      "  mount: {type: weld, parent: hub, child: panel, offset: {position: [1, 2, 3]}}}\n";
  constexpr std::size_t columns = 9;  // 16 by 8 quadrilaterals
  const auto at = [](std::size_t row, std::size_t column) { return columns * row + column; };
  std::map<std::string, Vector3> corner;
  for (const char* formulation : formulations) {
    const DrawnBody drawn(plate, "plate.yaml", formulation, 0.2, 0.7, registry);
    ASSERT_EQ(drawn.vertices.size(), 17 * columns);
    for (const auto& [name, vertex] : {std::pair("middle", at(8, 6)), std::pair("corner", at(16, 0)),
                                       std::pair("end", at(16, 4)), std::pair("inside", at(4, 3))})
      EXPECT_LT((drawn.vertices[vertex] - drawn.frame(name)).norm(), 2e-6) << formulation << ' ' << name;
    corner[formulation] = drawn.vertices[at(16, 0)];
  }
  EXPECT_GT((corner["quadratic"] - corner["linear"]).norm(), 0.01) << "the second order is seen";
}

/// The tip's section is rigid and its centre the middle between two vertices, (1, 0, ±5 mm), which are mid-edges of no
/// element: to second order its frame is where their mean is.
TEST(Surfaces, OfAMeshGoThroughItsInterface) {
  Registry registry;
  enroll_static_plugins(registry);
  const std::string boom =
      "bodies: {boom: {type: modal, file: cantilever.SID_FEM, visual: {mesh: cantilever.vtk}, frames: {tip: {at: "
      "TIP}}}}\nhinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: boom}}\n";
  std::map<std::string, Vector3> tip;
  for (const char* formulation : formulations) {
    const DrawnBody drawn(boom, WITHY_SCENES "/boom.yaml", formulation, 0.1, 0.7, registry);
    const DrawnBody rest(boom, WITHY_SCENES "/boom.yaml", formulation, 0, 0, registry);
    Vector3 mean = Vector3::Zero();
    int count = 0;
    for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
      if ((rest.vertices[v].cwiseAbs() - Vector3(1, 0, 0.005)).norm() > 1e-6) continue;
      mean += 0.5 * drawn.vertices[v];
      ++count;
    }
    ASSERT_EQ(count, 2);
    EXPECT_LT((mean - drawn.frame("tip")).norm(), 2e-6) << formulation;
    tip[formulation] = mean;
  }
  EXPECT_GT((tip["quadratic"] - tip["linear"]).norm(), 0.005) << "the second order is seen";
}

}  // namespace
}  // namespace withy
