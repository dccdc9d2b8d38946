/// \file
/// How reduced meshes are drawn: outer faces, and the second-order displacements of every node.
#include "withy/fem/surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>

#include "reduced_case.hpp"
#include "withy/fem/element_faces.hpp"
#include "withy/scene/mesh_file.hpp"

namespace withy::fem {
namespace {

using testing::HasSubstr;

/// What closed polygons enclose, by the divergence theorem over fans of triangles; polygons that look inwards count
/// against it. Every edge must be gone along once in each direction.
double enclosed(const OuterFaces& outer, const Matrix3X& X) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (const auto& polygon : outer.polygons) {
    const auto at = [&](std::size_t i) -> Vector3 { return X.col(outer.rows[polygon[i]]); };
    for (std::size_t i = 0; i < polygon.size(); ++i) ++edges[{polygon[i], polygon[(i + 1) % polygon.size()]}];
    for (std::size_t i = 2; i < polygon.size(); ++i) sum += at(0).dot(at(i - 1).cross(at(i))) / 6;
  }
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  return sum;
}

TEST(OuterFaces, encloseTheBar) {
  const Case c(cantilever, 2);
  const OuterFaces bent = outer_faces(c.mesh, c.matrices);
  const OuterFaces straight = outer_faces(c.mesh, c.matrices, FaceEdges::straight);
  constexpr std::size_t faces = 2 * (2 * 1 + 4 * 2 + 4 * 1);  // 4 by 2 by 1 bricks
  EXPECT_EQ(bent.faces, faces);
  EXPECT_EQ(bent.triangles(), 6 * faces) << "of 8 nodes each";
  EXPECT_EQ(straight.faces, faces);
  EXPECT_EQ(straight.triangles(), 2 * faces);
  for (const OuterFaces& outer : {bent, straight}) EXPECT_NEAR(enclosed(outer, c.body.X), 1 * 0.02 * 0.01, 1e-15);
}

TEST(OuterFaces, ofEveryKindOfElementLookOutwards) {
  const Mesh all = read_mesh(data / "elements.inp");
  const Matrices matrices = combined(read_calculix(data / "elements.sti", data / "elements.dof"),
                                     read_calculix(data / "elements.mas", data / "elements.dof"), all);
  for (const auto& [number, element] : all.elements) {
    Mesh mesh = all;
    mesh.elements = {{number, element}};
    const OuterFaces outer = outer_faces(mesh, matrices);
    EXPECT_EQ(outer.faces, element.type[3] == '4' || element.type == "C3D10"   ? 4U
                           : element.type == "C3D6" || element.type == "C3D15" ? 5U
                                                                               : 6U)
        << element.type;
    EXPECT_GT(enclosed(outer, matrices.X), 0) << element.type;
  }
}

TEST(OuterFaces, thatAreNotKnownAreSaid) {
  const Case c(data / "brick", 0);
  Mesh mesh = c.mesh;
  mesh.other_elements.insert("B31");
  EXPECT_EQ(outer_faces(mesh, c.matrices).left_out, "B31");
  mesh.elements.clear();
  EXPECT_THAT(refusal([&] { (void)outer_faces(mesh, c.matrices); }), HasSubstr("elements of type B31"));
  mesh.other_elements.clear();
  EXPECT_THAT(refusal([&] { (void)outer_faces(mesh, c.matrices); }), HasSubstr("no elements"));
}

/// A mesh whose nodes are numbered from 1 and all have matrices, as far as faces look at these.
struct Sheet {
  Mesh mesh;
  Matrices matrices;

  explicit Sheet(const Matrix3X& X) {
    matrices.X = X;
    for (Eigen::Index a = 0; a < X.cols(); ++a) matrices.nodes.push_back(a + 1);
  }
  void add(const std::string& type, std::vector<long> nodes) {
    mesh.drawn_only.emplace(static_cast<long>(mesh.drawn_only.size()) + 1, Element{type, std::move(nodes)});
  }
  [[nodiscard]] double area(FaceEdges edges) const {
    const OuterFaces outer = outer_faces(mesh, matrices, edges);
    double sum = 0;
    for (const auto& polygon : outer.polygons)
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        const auto at = [&](std::size_t k) -> Vector3 { return matrices.X.col(outer.rows[polygon[k]]); };
        sum += 0.5 * (at(i - 1) - at(0)).cross(at(i) - at(0)).norm();
      }
    return sum;
  }
};

/// Nodes of shells on a quarter of a cylinder of radius and length 1, whose area is pi/2: corners and middles are on
/// it.
TEST(OuterFaces, ofShellsFollowTheMiddlesOfTheirEdges) {
  const auto at = [](double turned, double z) { return Vector3(std::cos(turned), std::sin(turned), z); };
  const double t = pi / 4;
  const std::vector<Vector3> corners = {at(0, 0), at(2 * t, 0), at(2 * t, 1), at(0, 1)};
  const std::vector<Vector3> middles = {at(t, 0), at(2 * t, 0.5), at(t, 1), at(0, 0.5)};
  Matrix3X X(3, 9);
  for (Eigen::Index i = 0; i < 4; ++i) {
    X.col(i) = corners[static_cast<std::size_t>(i)];
    X.col(4 + i) = middles[static_cast<std::size_t>(i)];
  }
  X.col(8) = at(t, 0.5);
  const double flat = std::sqrt(2.0), two_flats = 4 * std::sin(pi / 8);
  Sheet eight(X), nine(X), six(X), four(X);
  eight.add("S8R", {1, 2, 3, 4, 5, 6, 7, 8});
  nine.add("S9R5", {1, 2, 3, 4, 5, 6, 7, 8, 9});
  six.add("STRI65", {1, 2, 3, 5, 6, 9});
  six.add("S6", {1, 3, 4, 9, 7, 8});
  four.add("M3D4R", {1, 2, 3, 4});
  for (const Sheet* sheet : {&eight, &nine, &six, &four})
    EXPECT_NEAR(sheet->area(FaceEdges::straight), flat, 1e-12) << sheet->mesh.drawn_only.begin()->second.type;
  EXPECT_NEAR(four.area(FaceEdges::bent), flat, 1e-12);
  EXPECT_NEAR(nine.area(FaceEdges::bent), two_flats, 1e-12) << "of pi/2 = 1.571";
  EXPECT_NEAR(six.area(FaceEdges::bent), two_flats, 1e-12);
  EXPECT_GT(eight.area(FaceEdges::bent), 0.98 * two_flats) << "its middle, without a node, lies a little deeper";
  EXPECT_EQ(outer_faces(eight.mesh, eight.matrices).triangles(), 6U);
  EXPECT_EQ(outer_faces(nine.mesh, nine.matrices).triangles(), 8U);
  EXPECT_EQ(outer_faces(six.mesh, six.matrices).triangles(), 8U) << "four each";
}

TEST(OuterFaces, ofSkinsAreDrawnOnce) {
  Case c(cantilever, 2);
  const std::size_t faces = outer_faces(c.mesh, c.matrices).faces;
  const Element brick = c.mesh.elements.begin()->second;
  const auto nodes = [&](std::initializer_list<std::size_t> places) {
    std::vector<long> own;
    for (const std::size_t i : places) own.push_back(brick.nodes[i]);
    return own;
  };
  c.mesh.drawn_only.emplace(1001, Element{"SFM3D8", nodes({4, 5, 6, 7, 12, 13, 14, 15})});
  EXPECT_EQ(outer_faces(c.mesh, c.matrices).faces, faces) << "it lies on an outer face, or between two bricks";
  c.mesh.drawn_only.emplace(1002, Element{"S4", nodes({16, 17, 18, 19})});
  c.mesh.drawn_only.emplace(1003, Element{"S4R", nodes({17, 18, 19, 16})});
  EXPECT_EQ(outer_faces(c.mesh, c.matrices).faces, faces + 1) << "two of the same nodes within the brick";
}

TEST(ElementFaces, areKnownByTypes) {
  for (const char* type :
       {"C3D8R", "C3D8I", "C3D10M", "C3D20RH", "SC8R", "S3R", "S4R5", "S8R5", "M3D6", "SFM3D4R", "R3D3"})
    EXPECT_NE(element_faces(type), nullptr) << type;
  for (const char* type : {"B31", "C3D", "C3D27", "C3D15V", "SPRINGA", "MASS", "S", "S44", "T3D2", "DCOUP3D", ""})
    EXPECT_EQ(element_faces(type), nullptr) << type;
  EXPECT_EQ(element_faces("STRI65")->nodes, 6U);
  EXPECT_EQ(element_faces("C3D10M")->nodes, 10U);
}

TEST(OuterFaces, areAsManyAsScenesRead) { EXPECT_EQ(most_drawn_triangles, most_triangles); }

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
  EXPECT_EQ(read.mesh.triangles.size(), outer.triangles());
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
