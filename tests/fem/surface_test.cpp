/// \file
/// How reduced meshes are drawn: outer faces, and the second-order displacements of every node.
#include "withy/fem/surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>

#include "reduced_case.hpp"
#include "withy/scene/mesh_file.hpp"

namespace withy::fem {
namespace {

using testing::HasSubstr;

/// What closed faces enclose, by the divergence theorem over fans of triangles; faces that look inwards count against
/// it. Every edge must be gone along once in each direction.
double enclosed(const OuterFaces& outer, const Matrix3X& X) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (const auto& face : outer.faces) {
    const auto at = [&](std::size_t i) -> Vector3 { return X.col(outer.rows[face[i]]); };
    for (std::size_t i = 0; i < face.size(); ++i) ++edges[{face[i], face[(i + 1) % face.size()]}];
    for (std::size_t i = 2; i < face.size(); ++i) sum += at(0).dot(at(i - 1).cross(at(i))) / 6;
  }
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  return sum;
}

TEST(OuterFaces, encloseTheBar) {
  const Case c(cantilever, 2);
  const OuterFaces outer = outer_faces(c.mesh, c.matrices);
  EXPECT_EQ(outer.faces.size(), 2U * (2 * 1 + 4 * 2 + 4 * 1)) << "4 by 2 by 1 bricks";
  EXPECT_NEAR(enclosed(outer, c.body.X), 1 * 0.02 * 0.01, 1e-15);
}

TEST(OuterFaces, ofEveryKindOfElementLookOutwards) {
  const Mesh all = read_mesh(data / "elements.inp");
  const Matrices matrices = combined(read_calculix(data / "elements.sti", data / "elements.dof"),
                                     read_calculix(data / "elements.mas", data / "elements.dof"), all);
  for (const auto& [number, element] : all.elements) {
    Mesh mesh = all;
    mesh.elements = {{number, element}};
    const OuterFaces outer = outer_faces(mesh, matrices);
    EXPECT_EQ(outer.faces.size(), element.type[3] == '4' || element.type == "C3D10"   ? 4U
                                  : element.type == "C3D6" || element.type == "C3D15" ? 5U
                                                                                      : 6U)
        << element.type;
    EXPECT_GT(enclosed(outer, matrices.X), 0) << element.type;
  }
}

TEST(OuterFaces, thatAreNotKnownAreSaid) {
  const Case c(data / "brick", 0);
  Mesh mesh = c.mesh;
  mesh.other_elements.insert("S4R");
  EXPECT_THAT(refusal([&] { (void)outer_faces(mesh, c.matrices); }), HasSubstr("elements of type S4R"));
  mesh = c.mesh;
  mesh.elements.clear();
  EXPECT_THAT(refusal([&] { (void)outer_faces(mesh, c.matrices); }), HasSubstr("no elements"));
}

/// The whole field against what unit loads make of it, which are computed the other way round: the stress of each load
/// works on the modes. Forces M e_c and M X_i e_c give the integrals; forces at the tip and at a free node their own Γ.
TEST(SecondOrderDisplacements, doTheWorkOfUnitLoads) {
  Case c(cantilever, 4);
  c.options.stations = {{"MIDDLE", {31}}};
  c.body = reduce(c.matrices, c.options);
  add_second_order(c.mesh, c.matrices, c.options, c.body);
  const Eigen::MatrixXd gamma = second_order_displacements(c.mesh, c.matrices, c.options, c.body);
  const Eigen::Index n = c.body.modes.cols();
  const Eigen::VectorXd mass = c.body.node_mass * Eigen::VectorXd::Ones(c.body.X.cols());
  const Eigen::MatrixXd weighted = c.body.node_mass * c.body.X.transpose();
  const auto axis = [](const Eigen::VectorXd& field, Eigen::Index c3) -> Eigen::VectorXd {
    return field.reshaped(3, field.size() / 3).row(c3).transpose();
  };
  const std::size_t at_station = inertial_loads + 6;
  const auto row = std::lower_bound(c.matrices.nodes.begin(), c.matrices.nodes.end(), 31) - c.matrices.nodes.begin();
  std::vector<double> most(3), miss(3);
  const auto compare = [&](std::size_t kind, double ours, double loads) {
    most[kind] = std::max(most[kind], std::abs(loads));
    miss[kind] = std::max(miss[kind], std::abs(ours - loads));
  };
  Eigen::Index pair = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = k; l < n; ++l, ++pair) {
      for (Eigen::Index c3 = 0; c3 < 3; ++c3) {
        const auto load = [&](std::size_t at) { return c.body.second_order[at](k, l); };
        const auto c3s = static_cast<std::size_t>(c3);
        const Eigen::VectorXd own = axis(gamma.col(pair), c3);
        compare(0, mass.dot(own), load(c3s));
        for (std::size_t i = 0; i < 3; ++i)
          compare(1, weighted.col(static_cast<Eigen::Index>(i)).dot(own), load(3 + 3 * i + c3s));
        compare(2, own[row], load(at_station + c3s));
      }
    }
  }
  for (std::size_t kind = 0; kind < 3; ++kind) {
    EXPECT_GT(most[kind], 0) << kind;
    EXPECT_LT(miss[kind], 1e-7 * most[kind]) << kind << ": the stresses balance the loads within 9e-8";
  }
}

/// What is written is read back, vertex for vertex and mode for mode, to its seven digits.
TEST(SurfaceFile, isReadBack) {
  const Case c(cantilever, 2);
  Reduction body = c.body;
  add_second_order(c.mesh, c.matrices, c.options, body);
  const Eigen::MatrixXd gamma = second_order_displacements(c.mesh, c.matrices, c.options, body);
  const OuterFaces outer = outer_faces(c.mesh, c.matrices);
  const Folder folder;
  const ModeSurface read = read_mode_surface(folder.with("bar.vtk", surface_text(body, outer, gamma)));
  ASSERT_EQ(read.mesh.vertices.size(), outer.rows.size());
  EXPECT_EQ(read.mesh.triangles.size(), 2 * outer.faces.size());
  ASSERT_EQ(read.first.cols(), body.modes.cols());
  ASSERT_EQ(read.second.cols(), gamma.cols());
  for (std::size_t v = 0; v < outer.rows.size(); ++v) {
    const auto own = 3 * static_cast<Eigen::Index>(v), whole = 3 * outer.rows[v];
    EXPECT_LT((read.mesh.vertices[v] - body.X.col(outer.rows[v])).norm(), 1e-7);
    const Eigen::MatrixXd modes = body.modes.middleRows(whole, 3), second = gamma.middleRows(whole, 3);
    EXPECT_LT((read.first.middleRows(own, 3).cast<double>() - modes).norm(), 1e-6 * body.modes.norm());
    EXPECT_LT((read.second.middleRows(own, 3).cast<double>() - second).norm(), 1e-6 * gamma.norm());
  }
}

}  // namespace
}  // namespace withy::fem
