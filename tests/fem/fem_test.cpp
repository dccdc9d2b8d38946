/// \file
/// Reduction of finite-element meshes: files, modes, mass properties. The meshes are described in
/// tests/reference/fem/README.md and scenes/meshes/README.md; what is expected are closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <sstream>

#include "reduced_case.hpp"
#include "withy/bodies/modal/sid_body.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/fem/import.hpp"
#include "withy/fem/summary.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::fem {
namespace {

using testing::HasSubstr;

/// Euler–Bernoulli: ω = β² √(EI/ρA)/L², for 1 m of steel, 20 mm in y by 10 mm in z. Demanded: 0.5 % of the first four;
/// the coarse mesh has the third of a plane 3 % too high.
TEST(Reduction, steel_cantilever_has_the_beams_frequencies) {
  const Case c(cantilever, 8);
  const double wave = std::sqrt(2.1e11 / 7850.0);
  const double radius_y = 0.02 / std::sqrt(12.0), radius_z = 0.01 / std::sqrt(12.0);
  const auto bending = [&](double beta, double radius) { return beta * beta * wave * radius / (2 * pi); };
  EXPECT_NEAR(c.body.frequency(0) / bending(1.8751041, radius_z), 1, 0.005);
  EXPECT_NEAR(c.body.frequency(1) / bending(1.8751041, radius_y), 1, 0.005);
  EXPECT_NEAR(c.body.frequency(2) / bending(4.6940911, radius_z), 1, 0.005);
  EXPECT_NEAR(c.body.frequency(3) / bending(4.6940911, radius_y), 1, 0.005);
}

/// Against the mesh's own eigenvalues, by a dense solver: Craig–Bampton gives them from above, and its eigenvectors are
/// orthonormal in M. The rigid tip section alone stiffens the mesh.
TEST(Reduction, frequencies_are_those_of_the_mesh_from_above) {
  const Case c(cantilever, 12);
  const auto size = static_cast<Eigen::Index>(c.body.free.size());
  const Eigen::MatrixXd K = c.matrices.K, M = c.matrices.M;
  Eigen::MatrixXd k(size, size), m(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      const auto a = c.body.free[static_cast<std::size_t>(i)], b = c.body.free[static_cast<std::size_t>(j)];
      k(i, j) = K(a, b);
      m(i, j) = M(a, b);
    }
  }
  // The greatest 1/ω²: the mass matrix of reduced elements is singular.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m, k);
  const Eigen::VectorXd exact = eigen.eigenvalues().reverse().cwiseInverse();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double ratio = c.body.omega[i] / std::sqrt(exact[i]);
    EXPECT_GT(ratio, 1 - 1e-9) << i;
    EXPECT_LT(ratio, 1 + 1e-3) << i;
  }
  const Eigen::MatrixXd product = c.body.modes.transpose() * (c.matrices.M * c.body.modes);
  EXPECT_LT((product - Eigen::MatrixXd::Identity(product.rows(), product.cols())).cwiseAbs().maxCoeff(), 1e-8);
}

/// ρ b h L = 1.57 kg, centre at half the length, inertia m (b² + h²)/12 …: bricks have them exactly, but for the 14
/// digits of the files.
TEST(Reduction, mass_properties_are_those_of_the_brick) {
  const Case c(cantilever, 4);
  const sid::Data sid = sid_of(c.body);
  const Summary s = summary_of(c.matrices, c.body, sid);
  EXPECT_NEAR(s.mass, 1.57, 1e-11);
  EXPECT_LT((s.centre - Vector3(0.5, 0, 0)).norm(), 1e-11);
  const Vector3 inertia = 1.57 / 12 * Vector3(0.0004 + 0.0001, 1 + 0.0001, 1 + 0.0004);
  EXPECT_LT((s.inertia - Matrix3(inertia.asDiagonal())).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT(s.mesh_difference, 1e-12);
  EXPECT_LT(s.rigid_stiffness, 1e-9);
  // A clamped beam's first mode has 61.3 % of its mass (4/β² (…)²: Blevins), and no share is above the whole.
  EXPECT_NEAR(s.effective_mass(0, 2), 0.613, 0.003);
  for (const double share : s.held) EXPECT_LE(share, 1 + 1e-9);
}

TEST(Reduction, says_what_it_drops_and_what_is_missing) {
  const Case c(cantilever, 8, 300);
  EXPECT_EQ(c.body.fixed_frequencies.size(), 8u);
  ASSERT_FALSE(c.body.dropped_frequencies.empty());
  EXPECT_GT(c.body.dropped_frequencies.front(), 300);
  EXPECT_LE(c.body.frequency(c.body.omega.size() - 1), 300);
  SidReport report;
  (void)body_of(sid_of(c.body), {}, report);
  EXPECT_THAT(report.missing, testing::Contains(HasSubstr("geometric stiffness")));
}

/// What `withy eval` sees of the file is what was written: ω² and the unit modal mass, and a static tip deflection
/// F L³/3EI within 0.5 %.
TEST(Reduction, file_read_by_a_scene_is_the_reduced_body) {
  const Case c(cantilever, 8);
  const Folder folder;
  (void)folder.with("c.SID_FEM", sid::write(sid_of(c.body)));
  Registry registry;
  enroll_static_plugins(registry);
  const Scene scene = parse_scene(
      "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: modal, file: c.SID_FEM}}\n"
      "hinges: {root: {type: weld, parent: world, child: boom}}\n",
      (folder.path() / "s.yaml").string(), registry, {});
  const auto equations = scene.formulation->compile(scene.model);
  State state = scene.initial;
  const auto n = static_cast<Eigen::Index>(c.body.omega.size());
  const DenseSystem rest = equations->system(0, state.y);
  const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(rest.mass.data(), n, n);
  EXPECT_LT((M - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-8);
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) state.y[k] = 1;
  const DenseSystem bent = equations->system(0, state.y);
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
    const double square = c.body.omega[static_cast<Eigen::Index>(k)] * c.body.omega[static_cast<Eigen::Index>(k)];
    EXPECT_NEAR((rest.force[k] - bent.force[k]) / square, 1, 1e-10);
  }
  const PointExpansion tip = *scene.model->bodies()[0].body->station(std::string("TIP"));
  EXPECT_LT((tip.X - Vector3(1, 0, 0)).norm(), 1e-12);
  const Eigen::RowVectorXd lift = tip.phi.row(2);
  const double compliance = (lift.array().square() / c.body.omega.transpose().array().square()).sum();
  EXPECT_NEAR(compliance * 3 * 2.1e11 * 0.02 * 1e-6 / 12, 1, 0.005);
}

/// The forms that Abaqus writes, made from the brick's matrices: one triangle or both, by row or by node and freedom.
TEST(Files, of_abaqus_are_read_in_every_form) {
  const Case c(data / "brick", 0);
  const Folder folder;
  std::ostringstream both, lower, named;
  both.precision(17);
  lower.precision(17);
  named.precision(17);
  named << "** made by a test\n*MATRIX ASSEMBLE\n";
  const SparseMatrix& K = c.matrices.K;
  for (Eigen::Index j = 0; j < K.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(K, j); it; ++it) {
      const auto row = it.row() + 1, column = it.col() + 1;
      both << row << ' ' << column << "  " << it.value() << '\n';
      if (row < column) continue;
      lower << row << ' ' << column << "  " << it.value() << '\n';
      named << it.row() / 3 + 1 << ',' << it.row() % 3 + 1 << ", " << it.col() / 3 + 1 << ',' << it.col() % 3 + 1
            << ", " << it.value() << '\n';
    }
  }
  for (const auto& text : {both.str(), lower.str(), named.str()}) {
    const NamedMatrix read = read_abaqus(folder.with("K.mtx", text), c.mesh);
    EXPECT_EQ((arranged(read, c.matrices.nodes) - K).norm(), 0);
  }
}

/// A triangle of the program's own order of rows has elements on either side of the diagonal of another order. Where
/// one element stands on both sides the whole matrix is given, and what one side lacks is zero.
TEST(Files, of_abaqus_may_have_a_triangle_in_any_order_of_nodes) {
  const Case c(data / "brick", 0);
  const Folder folder;
  const SparseMatrix& K = c.matrices.K;
  const auto place = [&](Eigen::Index row) { return 37 * (row / 3) % 101; };  // of a node in the program's order
  std::ostringstream named, numbered, lopsided;
  for (std::ostringstream* o : {&named, &numbered, &lopsided}) o->precision(17);
  for (Eigen::Index j = 0; j < K.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(K, j); it; ++it) {
      const auto row = it.row(), column = it.col();
      if (row != 3 || column != 0) lopsided << row + 1 << ' ' << column + 1 << "  " << it.value() << '\n';
      if (place(row) < place(column) || (row / 3 == column / 3 && row < column)) continue;
      named << row / 3 + 1 << ',' << row % 3 + 1 << ", " << column / 3 + 1 << ',' << column % 3 + 1 << ", "
            << it.value() << '\n';
      numbered << row + 1 << ' ' << column + 1 << "  " << it.value() << '\n';
    }
  }
  for (const auto& text : {named.str(), numbered.str()}) {
    const NamedMatrix read = read_abaqus(folder.with("K.mtx", text), c.mesh);
    // The two sides of the file's own matrix agree to rounding.
    EXPECT_LT((arranged(read, c.matrices.nodes) - K).norm(), 1e-12 * K.norm());
  }
  EXPECT_NE(K.coeff(3, 0), 0);
  EXPECT_THAT(refusal([&] { (void)read_abaqus(folder.with("K.mtx", lopsided.str()), c.mesh); }),
              HasSubstr("the matrix is not symmetric"));
}

/// The line of sizes is no element of the matrix; what a heading announces is there.
TEST(Files, of_matrix_market_have_a_heading_and_sizes) {
  const Case c(data / "brick", 0);
  const Folder folder;
  const SparseMatrix& K = c.matrices.K;
  std::ostringstream both, lower;
  both.precision(17);
  lower.precision(17);
  Eigen::Index count = 0, below = 0;
  for (Eigen::Index j = 0; j < K.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(K, j); it; ++it) {
      both << it.row() + 1 << ' ' << j + 1 << ' ' << it.value() << '\n';
      ++count;
      if (it.row() < j) continue;
      lower << it.row() + 1 << ' ' << j + 1 << ' ' << it.value() << '\n';
      ++below;
    }
  }
  const std::string rows = std::to_string(K.rows());
  const auto sizes = [&](Eigen::Index elements) { return rows + " " + rows + " " + std::to_string(elements) + "\n\n"; };
  const std::string heading = "%%MatrixMarket matrix coordinate real ", remark = "% made by a test, of a brick\n";
  // Other programs write the heading in other letters, or have lost it: the sizes tell themselves by their place.
  for (const std::string& text :
       {heading + "general\n" + remark + sizes(count) + both.str(),
        heading + "symmetric\r\n" + sizes(below) + lower.str(), remark + both.str(),
        "\n%%matrixmarket MATRIX Coordinate Real general\n" + remark + sizes(count) + both.str(),
        remark + " " + heading + "general\n" + sizes(count) + both.str(), remark + sizes(below) + lower.str()}) {
    const NamedMatrix read = read_abaqus(folder.with("K.mtx", text), c.mesh);
    EXPECT_EQ((arranged(read, c.matrices.nodes) - K).norm(), 0);
  }
  const auto refused = [&](const std::string& text) {
    return refusal([&] { (void)read_abaqus(folder.with("K.mtx", text), c.mesh); });
  };
  EXPECT_THAT(refused(heading + "general\n" + sizes(count + 1) + both.str()),
              HasSubstr("K.mtx: got " + std::to_string(count) + " elements; its line of sizes says " +
                        std::to_string(count + 1)));
  EXPECT_THAT(refused(sizes(count + 1) + both.str()), HasSubstr("its line of sizes says"));
  EXPECT_THAT(refused(heading + "general\n3 3 1\n1 1 2.5\n"),
              HasSubstr("K.mtx:2: got a matrix of 3 by 3; need " + rows + " by " + rows));
  for (const char* other : {"%%MatrixMarket matrix array real general\n",
                            "%%MatrixMarket matrix coordinate complex "
                            "hermitian\n",
                            "%%MatrixMarket matrix coordinate real skew-symmetric\n"})
    EXPECT_THAT(refused(other + sizes(1) + "1 1 2\n"), HasSubstr("K.mtx:1: got '%%MatrixMarket"));
}

/// Some editors put a mark of UTF-8 before the text.
TEST(Files, with_a_mark_of_utf8_are_read) {
  const Folder folder;
  const Mesh deck = read_mesh(folder.with("a.inp", "\xef\xbb\xbf*NODE\n7, 1, 0, 0\n"));
  EXPECT_EQ(deck.nodes.at(7), Vector3(1, 0, 0));
}

/// `root` is where the body is held, and no other place of it can have the name.
TEST(Files, no_interface_is_called_root) {
  ImportJob job;
  job.job = cantilever.string();
  job.root = "TIP";
  job.modes = 2;
  for (const char* name : {"root", "root=ROOT"}) {
    job.interfaces = {name};
    EXPECT_THAT(refusal([&] { (void)import(job); }), HasSubstr("give it another, as tip="));
  }
  job.interfaces = {"ROOT"};
  EXPECT_EQ(import(job).body.nodes.back().id, "ROOT");
}

TEST(Files, that_cannot_be_used_are_refused_with_their_place) {
  const Folder folder;
  const Mesh mesh = read_mesh(data / "brick.inp");
  EXPECT_THAT(refusal([&] { (void)read_calculix(data / "brick.sti", folder.with("a.dof", "1.1\n1.2\n1.3\n1.1\n")); }),
              HasSubstr("a.dof:4: freedom 1.1 stands there twice: CalculiX makes solids of beams and shells"));
  EXPECT_THAT(refusal([&] { (void)read_calculix(folder.with("a.sti", "1 1 2.0\n1 x 3\n"), data / "brick.dof"); }),
              HasSubstr("a.sti:2: need a row, a column and a value"));
  EXPECT_THAT(refusal([&] { (void)read_abaqus(folder.with("a.mtx", "1,1,1,1,nan\n"), mesh); }),
              HasSubstr("a.mtx:1: got 'nan'"));
  EXPECT_THAT(refusal([&] { (void)read_abaqus(folder.with("a.mtx", "1,4,1,4,2.0\n"), mesh); }),
              HasSubstr("solid elements"));
  EXPECT_THAT(refusal([&] { (void)read_abaqus(folder.with("a.mtx", "1 1 2\n2 2 2\n"), mesh); }),
              HasSubstr("fewer rows"));
  EXPECT_THAT(refusal([&] { (void)read_mesh(folder.with("a.inp", "*NODE\n1, 0, 0, 0\n1, 1, 0, 0\n")); }),
              HasSubstr("a.inp:3: node 1 is at two places"));
  EXPECT_THAT(refusal([&] { (void)nodes_of(mesh, "TOP"); }), HasSubstr("sets: ALL, ROOT, TIP"));
  EXPECT_THAT(refusal([&] { (void)nodes_of(mesh, "1, 99"); }), HasSubstr("the mesh has no node 99"));
}

TEST(Files, decks_and_result_files_give_the_same_nodes) {
  const Folder folder;
  const Mesh frd =
      read_mesh(folder.with("a.frd",
                            "    1C\n    2C                             2                                     1\n"
                            " -1         7 1.00000E+00-2.50000E-01 0.00000E+00\n"
                            " -1        12 0.00000E+00 0.00000E+00 5.00000E-01\n -3\n"));
  EXPECT_EQ(frd.nodes.at(7), Vector3(1, -0.25, 0));
  EXPECT_EQ(frd.nodes.at(12), Vector3(0, 0, 0.5));
  const Mesh deck = read_mesh(folder.with("a.inp",
                                          "*Heading\n a title, 1\n*NODE, NSET=all\n7, 1., -0.25\n12, 0, 0, 5e-1\n"
                                          "*NSET, NSET=Some, GENERATE\n7, 12, 5\n*nset,nset=More\nSOME, 7\n"));
  EXPECT_EQ(deck.nodes, frd.nodes);
  EXPECT_EQ(nodes_of(deck, "more"), (std::vector<long>{7, 12}));
}

TEST(Reduction, roots_and_interfaces_that_hold_nothing_are_refused) {
  const Case c(data / "brick", 0);
  const auto with = [&](std::vector<long> root, std::vector<Interface> interfaces, int modes) {
    ReductionOptions o;
    o.root = std::move(root);
    o.interfaces = std::move(interfaces);
    o.modes = modes;
    return refusal([&] { (void)reduce(c.matrices, o); });
  };
  EXPECT_THAT(with({1, 2}, {}, 3), HasSubstr("three nodes or more that are not in a line"));
  EXPECT_THAT(with({1, 2, 3}, {{"A", {3}}}, 3), HasSubstr("node 3 of A is in the root"));
  EXPECT_THAT(with({1, 2, 3, 4}, {{"A", {5, 6}}}, 3), HasSubstr("interface A needs one node, or three"));
  EXPECT_THAT(with({1, 2, 3, 4}, {}, 12), HasSubstr("the interior has 12 freedoms"));
  EXPECT_THAT(with({1, 2, 3, 4}, {}, 0), HasSubstr("rigid body"));
}

}  // namespace
}  // namespace withy::fem
