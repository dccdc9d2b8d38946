/// \file
/// Bodies as surfaces: their vertices against frames that the engine puts on the bodies.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "scratch.hpp"
#include "withy/core/kinematics/observation.hpp"
#include "withy/core/model/model.hpp"
#include "withy/fem/import.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/output_file.hpp"
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
    std::vector<float> numbers, remainders;
    drawing.append(y, numbers, remainders);
    EXPECT_EQ(numbers.size(), drawing.size());
    const std::size_t last = scene.model->bodies().size() - 1;
    const auto number = [&](std::size_t i) { return static_cast<double>(numbers[7 * last + i]); };
    const Matrix3 R = Eigen::Quaterniond(number(3), number(4), number(5), number(6)).toRotationMatrix();
    const Eigen::MatrixXf& shapes = drawing.shapes(last).shapes();
    const Eigen::VectorXf moved = shapes * Eigen::Map<const Eigen::VectorXf>(&numbers[7 * last + 7], shapes.cols());
    const auto at_rest = drawing.part(last).at("points").get<std::vector<double>>();
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

/// The deck of scenes/meshes/cantilever without its elements and with others, in a folder of its own; what `withy
/// import` makes of it, and a scene with that.
class ImportedDeck {
 public:
  /// \param elements a line each, of a brick's nodes
  ImportedDeck(const std::function<std::string(const fem::Element&, long)>& elements, bool bricks,
               std::vector<long> nodes)
      : nodes_(std::move(nodes)) {
    const std::string job = WITHY_SCENES "/meshes/cantilever";
    const fem::Mesh mesh = fem::read_mesh(job + ".inp");
    std::string deck = bricks ? "*INCLUDE, INPUT=" + job + ".inp\n" : nodes_text(mesh);
    for (const auto& [number, brick] : mesh.elements) deck += elements(brick, 1000 * number);
    fem::ImportJob what{.job = job,
                        .mesh = (folder_ / "deck.inp").string(),
                        .stiffness = "",
                        .mass_matrix = "",
                        .root = "ROOT",
                        .interfaces = {"TIP"},
                        .stations = {},
                        .modes = 4};
    write_file(what.mesh, deck);
    for (const long node : nodes_) what.stations.push_back("n" + std::to_string(node) + "=" + std::to_string(node));
    imported = fem::import(what);
    write_file(folder_ / "boom.SID_FEM", sid::write(imported.data));
    write_file(folder_ / "boom.vtk", imported.drawn.text);
  }
  /// Distance between each node's frame and the vertex that is there at rest, the greatest [m].
  [[nodiscard]] double apart(const std::string& formulation, Registry& registry) const {
    std::string frames;
    for (const long node : nodes_) frames += fmt::format("{0}f{1}: {{at: n{1}}}", frames.empty() ? "" : ", ", node);
    const std::string text = "bodies: {boom: {type: modal, file: boom.SID_FEM, visual: {mesh: boom.vtk}, frames: {" +
                             frames +
                             "}}}\nhinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: boom}}\n";
    const std::string file = (folder_ / "boom.yaml").string();
    const DrawnBody rest(text, file, formulation, 0, 0, registry), drawn(text, file, formulation, 0.1, 0.7, registry);
    double most = 0;
    for (const long node : nodes_) {
      const std::string name = "f" + std::to_string(node);
      const auto vertex = std::find_if(rest.vertices.begin(), rest.vertices.end(),
                                       [&](const Vector3& v) { return (v - rest.frame(name)).norm() < 1e-6; });
      if (vertex == rest.vertices.end()) return std::numeric_limits<double>::infinity();
      const Vector3& moved = drawn.vertices[static_cast<std::size_t>(vertex - rest.vertices.begin())];
      EXPECT_GT((moved - *vertex).norm(), 0.01) << "it moves";
      most = std::max(most, (moved - drawn.frame(name)).norm());
    }
    return most;
  }
  fem::Imported imported;

 private:
  static std::string nodes_text(const fem::Mesh& mesh) {
    std::string text = "*NODE\n";
    for (const auto& [number, X] : mesh.nodes)
      text += fmt::format("{}, {:.17g}, {:.17g}, {:.17g}\n", number, X.x(), X.y(), X.z());
    for (const char* set : {"ROOT", "TIP"}) {
      text += fmt::format("*NSET, NSET={}\n", set);
      for (const long node : mesh.sets.at(set)) text += fmt::format("{}\n", node);
    }
    return text;
  }
  std::vector<long> nodes_;
  test::Scratch folder_;
};

std::string element_line(const char* type, long number, const fem::Element& brick,
                         std::initializer_list<std::size_t> at) {
  std::vector<long> nodes;
  for (const std::size_t i : at) nodes.push_back(brick.nodes[i]);
  return fmt::format("*ELEMENT, TYPE={}\n{}, {}\n", type, number, fmt::join(nodes, ", "));
}

/// Nodes halfway along the bar, on its outside: a corner and a middle of an edge on top, and one between top and
/// bottom.
std::vector<long> watched_nodes() {
  const fem::Mesh mesh = fem::read_mesh(WITHY_SCENES "/meshes/cantilever.inp");
  const auto brick = std::next(mesh.elements.begin(), 3);
  return {brick->second.nodes[5], brick->second.nodes[12], brick->second.nodes[18]};
}

TEST(Surfaces, OfShellsGoThroughTheirNodesInEveryFormulation) {
  Registry registry;
  enroll_static_plugins(registry);
  const ImportedDeck deck(
      [](const fem::Element& brick, long number) {
        return element_line("S8R", number, brick, {4, 5, 6, 7, 12, 13, 14, 15}) +
               element_line("S4", number + 1, brick, {16, 17, 18, 19}) +
               element_line("S3R", number + 2, brick, {0, 1, 5});
      },
      false, watched_nodes());
  EXPECT_EQ(deck.imported.drawn.faces, 3U * 8) << "three shells a brick";
  EXPECT_EQ(deck.imported.drawn.lacking, "without the second order, for the geometric stiffness is not known");
  EXPECT_NE(deck.imported.second_order.lacking.find("elements of type S8R, whose stresses are not known"),
            std::string::npos);
  for (const char* formulation : formulations) EXPECT_LT(deck.apart(formulation, registry), 2e-6) << formulation;
}

TEST(Surfaces, OfSolidsWithASkinHaveTheirSecondOrder) {
  Registry registry;
  enroll_static_plugins(registry);
  const ImportedDeck deck(
      [](const fem::Element& brick, long number) {
        return element_line("SFM3D8", number, brick, {4, 5, 6, 7, 12, 13, 14, 15});
      },
      true, watched_nodes());
  EXPECT_EQ(deck.imported.drawn.lacking, "");
  EXPECT_EQ(deck.imported.drawn.faces, 28U) << "the skin is among the bricks' outer faces";
  for (const char* formulation : formulations) EXPECT_LT(deck.apart(formulation, registry), 2e-6) << formulation;
}

}  // namespace
}  // namespace withy
