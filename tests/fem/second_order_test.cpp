/// \file
/// Stresses of solid elements and the second-order displacements of reduced meshes: against matrices of CalculiX, the
/// beam body, whose Γ and Θ come from the kinematics of a rod, published frequencies of rotating beams, buckling loads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "reduced_case.hpp"
#include "withy/bodies/modal/sid_body.hpp"
#include "withy/fem/solid_elements.hpp"
#include "withy/tests/analysis/blade.hpp"

namespace withy::fem {
namespace {

using testing::HasSubstr;

struct Elements {
  Mesh mesh = read_mesh(data / "elements.inp");
  Matrices matrices = of("elements.sti");
  SolidElements solids{mesh, matrices};

  [[nodiscard]] Matrices of(const char* stiffness) const {
    return combined(read_calculix(data / stiffness, data / "elements.dof"),
                    read_calculix(data / "elements.mas", data / "elements.dof"), mesh);
  }
  /// Rows of an element, which shares none.
  template <class Matrix>
  [[nodiscard]] Eigen::MatrixXd part(const Element& e, const Matrix& all) const {
    return all.middleRows(3 * (e.nodes.front() - 1), 3 * static_cast<Eigen::Index>(e.nodes.size()));
  }
};

/// The files have 14 digits.
TEST(SolidElements, have_the_stiffness_of_calculix) {
  const Elements c;
  EXPECT_EQ(c.mesh.elements.size(), 7u);
  const Eigen::MatrixXd u = Eigen::MatrixXd::Random(c.matrices.K.rows(), 3);
  const Eigen::MatrixXd ours = c.solids.forces(u), theirs = c.matrices.K * u;
  for (const auto& [number, e] : c.mesh.elements)
    EXPECT_LT((c.part(e, ours) - c.part(e, theirs)).norm(), 1e-12 * c.part(e, theirs).norm()) << e.type;
}

/// CalculiX's stiffness under a given even stress without displacement, less that without stress. An even strain gives
/// the same stress in every element. The difference of two files leaves 3e-14 of K, 1e-2 of G in size.
TEST(SolidElements, have_the_geometric_stiffness_of_calculix) {
  const Elements c;
  const SparseMatrix G = c.of("stressed.sti").K - c.matrices.K;
  Matrix3 stress;
  stress << 1e5, 3e4, -5e4, 3e4, 2e5, 7e4, -5e4, 7e4, -1e5;
  const double E = 1e7, nu = 0.3;
  const Matrix3 strain = (1 + nu) / E * stress - nu / E * stress.trace() * Matrix3::Identity();
  const Matrix3X u = strain * c.matrices.X;
  const Eigen::MatrixXd fields = Eigen::MatrixXd::Random(c.matrices.K.rows(), 4);
  for (const auto& [number, e] : c.mesh.elements) {
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(fields.rows(), fields.cols());
    const Eigen::Index first = 3 * (e.nodes.front() - 1), count = 3 * static_cast<Eigen::Index>(e.nodes.size());
    own.middleRows(first, count) = fields.middleRows(first, count);
    const Eigen::MatrixXd theirs = own.transpose() * (G * own);
    const Eigen::MatrixXd ours =
        c.solids.geometric_stiffness(Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()), own)[0];
    EXPECT_LT((ours - theirs).norm(), 1e-9 * theirs.norm()) << e.type;
  }
}

/// The cantilever of scenes/meshes with its second order.
struct Stressed : Case {
  double imbalance;
  sid::Data sid;
  explicit Stressed(std::vector<Interface> stations = {}) : Case(cantilever, 12) {
    options.stations = std::move(stations);
    body = reduce(matrices, options);
    imbalance = add_second_order(mesh, matrices, options, body);
    sid = sid_of(body);
  }
  [[nodiscard]] Eigen::MatrixXd K() const { return body.omega.cwiseAbs2().asDiagonal(); }
  /// Smallest factor of a load at which K loses definiteness; `work` is f · Γ of the load.
  [[nodiscard]] double critical(const Eigen::MatrixXd& work) const {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(work, K());
    return 1 / eigen.eigenvalues().maxCoeff();
  }
};

constexpr double E = 2.1e11, width = 0.02, height = 0.01, mass = 1.57;  ///< of the steel bar, 1 m long
constexpr double EI = E * width * height * height * height / 12;        ///< out of its flat side

/// Two modes of bending in each plane and one of torsion, beside a beam with the modes of beam theory: Γ and Θ at the
/// tip and in every integral. The modes of a mesh of four quadratic elements differ: by up to 1 % in the slopes of the
/// second ones. Demanded is 2 % of the largest element of each matrix.
TEST(SecondOrder, is_that_of_a_rod) {
  const Stressed c;
  Registry registry;
  enroll_static_plugins(registry);
  const Scene scene = parse_scene(
      "format: withy/1\ntime: {end: 1}\nbodies:\n  boom: {type: beam, length: 1, mass_per_length: 1.57,\n"
      "    bending_y: {stiffness: 1400, modes: 2}, bending_z: {stiffness: 350, modes: 2},\n"
      "    torsion: {stiffness: 480, modes: 1, inertia: 6.54e-5}}\n"
      "hinges: {root: {type: weld, parent: world, child: boom}}\n",
      "s.yaml", registry, {});
  const sid::Data rod = sid_of(*scene.model->bodies()[0].body, {std::string("tip")});
  const sid::Node &ours = c.sid.nodes[1], &theirs = rod.nodes[0];
  const std::vector<Eigen::Index> mode = {1, 3, 0, 2, 9};  // by frequency
  // Scales of the modes: of the deflections, and of the twist.
  Eigen::VectorXd scale(5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    const sid::Taylor &f = k < 4 ? ours.phi : ours.psi, &r = k < 4 ? theirs.phi : theirs.psi;
    scale[k] = f.m0.col(mode[static_cast<std::size_t>(k)]).dot(r.m0.col(k)) / r.m0.col(k).squaredNorm();
  }
  const auto compare = [&](const char* name, auto&& element, const auto& a, const auto& b) {
    double most = 0, miss = 0;
    for (Eigen::Index k = 0; k < 5; ++k) {
      for (Eigen::Index l = 0; l < 5; ++l) {
        const auto i = mode[static_cast<std::size_t>(k)], j = mode[static_cast<std::size_t>(l)];
        const double expected = element(b, k, l);
        most = std::max(most, std::abs(expected));
        miss = std::max(miss, std::abs(element(a, i, j) / scale[k] / scale[l] - expected));
      }
    }
    EXPECT_GT(most, 0.1) << name;
    EXPECT_LT(miss, 0.02 * most) << name;
  };
  for (Eigen::Index c3 = 0; c3 < 3; ++c3) {
    const auto of_column = [c3](const sid::Taylor& t, Eigen::Index k, Eigen::Index l) {
      return t.m1[static_cast<std::size_t>(l)](k, c3);
    };
    const auto of_row = [c3](const sid::Taylor& t, Eigen::Index k, Eigen::Index l) {
      return t.m1[static_cast<std::size_t>(l)](c3, k);
    };
    compare("phi", of_row, ours.phi, theirs.phi);
    compare("psi", of_row, ours.psi, theirs.psi);
    compare("Ct", of_column, c.sid.Ct, rod.Ct);
    compare("Cr", of_column, c.sid.Cr, rod.Cr);
  }
  for (Eigen::Index six = 0; six < 6; ++six)
    compare(
        "Oe",
        [six](const sid::Taylor& t, Eigen::Index k, Eigen::Index l) {
          return t.m1[static_cast<std::size_t>(l)](k, six);
        },
        c.sid.Oe, rod.Oe);
}

/// A node of the tip's section, asked for by its own unit loads, moves as the section does to second order: Γ_tip +
/// Θ × r + ½ (ψ_k × (ψ_l × r) + ψ_l × (ψ_k × r)). The loads' stresses differ; that they agree is the reciprocity of K.
TEST(SecondOrder, of_a_section_is_rigid) {
  const Stressed c({{"CORNER", {77}}});
  const sid::Node &tip = c.sid.nodes[1], &corner = c.sid.nodes[2];
  const Vector3 r = corner.origin.m0 - tip.origin.m0;
  EXPECT_GT(r.norm(), 0.01);
  double most = 0;
  for (std::size_t l = 0; l < tip.phi.m1.size(); ++l) {
    const auto column = static_cast<Eigen::Index>(l);
    for (Eigen::Index k = 0; k < tip.phi.m0.cols(); ++k) {
      const Vector3 a = tip.psi.m0.col(k), b = tip.psi.m0.col(column);
      const Vector3 theta = Vector3(tip.psi.m1[l].col(k)) - 0.5 * b.cross(a);
      const Vector3 expected =
          Vector3(tip.phi.m1[l].col(k)) + theta.cross(r) + 0.5 * (a.cross(b.cross(r)) + b.cross(a.cross(r)));
      most = std::max(most, expected.norm());
      EXPECT_LT((Vector3(corner.phi.m1[l].col(k)) - expected).norm(), 1e-7 * (1 + expected.norm())) << k << ' ' << l;
    }
  }
  EXPECT_GT(most, 1);
}

/// Own weight 7.837347 EI/L³ and tip load π²/4 EI/L² (Timoshenko and Gere), with the loads the body knows; the mesh is
/// 0.1 % stiffer than the beam. Lateral buckling under a tip load across, 4.0126 √(EI GJ)/L² for a section that is
/// rigid in the load's plane: here the load acts on Γ of the undeformed beam. GJ is that of the mesh, from its
/// frequency of torsion √(GJ/ρI_p)/4L, 7 % above the bar's: one brick spans the flat side. Of the 3 % demanded 0.7 %
/// would be due to two modes of torsion, the rest to the third mode of bending; 24 by 4 by 2 bricks were measured 0.2 %
/// off.
TEST(SecondOrder, gives_buckling_loads) {
  const Stressed c;
  EXPECT_LT(c.imbalance, 1e-6);
  EXPECT_NEAR(c.critical(-c.body.second_order[0]) * mass / EI, 7.837347, 7.837347 * 0.005);
  EXPECT_NEAR(c.critical(-c.body.second_order[inertial_loads]) / EI, pi * pi / 4, pi * pi / 4 * 0.005);
  const double polar = mass * (width * width + height * height) / 12;  // per length
  const double GJ = polar * std::pow(4 * c.body.frequency(9), 2);
  EXPECT_NEAR(c.critical(c.body.second_order[inertial_loads + 1]) / std::sqrt(EI * GJ), 4.0126, 4.0126 * 0.03);
}

/// The table of Wright, Smith, Thresher and Wang (J. Appl. Mech. 49, 1982), through the file, the body and
/// `consistent`: flap out of the flat side, lag = √(flap(η/2)² 4 − η²) of twice the stiffness. The demand is 2 %;
/// measured 0.1 %, and 1 % in the second, which is 0.45 % off at rest.
TEST(SecondOrder, stiffens_a_spinning_boom) {
  const Stressed c;
  const Folder folder;
  const auto file = folder.with("c.SID_FEM", sid::write(c.sid));
  const double unit = std::sqrt(EI / mass);  // of rates, L = 1
  struct Row {
    double rate, flap_1, flap_2, flap_at_half;
  };
  for (const Row& row :
       {Row{2, 4.13732, 22.61492, 3.68165}, {4, 5.58500, 24.27335, 4.13732}, {12, 13.17015, 37.60311, 7.36037}}) {
    test::AnalysedScene scene("format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: modal, file: " + file.string() +
                                  "}}\nhinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}\n",
                              "consistent");
    scene.spin("axle", row.rate * unit);
    std::vector<double> found;
    for (const Mode& m : test::steady_modes(scene, {"axle"})) found.push_back(m.frequency() / unit);
    std::sort(found.begin(), found.end());
    const auto nearest = [&](double expected) {
      return *std::min_element(found.begin(), found.end(),
                               [&](double a, double b) { return std::abs(a - expected) < std::abs(b - expected); });
    };
    const double lag = std::sqrt(4 * row.flap_at_half * row.flap_at_half - row.rate * row.rate);
    EXPECT_NEAR(nearest(row.flap_1) / row.flap_1, 1, 2e-3) << row.rate;
    EXPECT_NEAR(nearest(row.flap_2) / row.flap_2, 1, 1e-2) << row.rate;
    EXPECT_NEAR(nearest(lag) / lag, 1, 3e-3) << row.rate;
  }
}

TEST(SecondOrder, lacks_nothing_that_is_reported) {
  SidReport report;
  const Stressed c;
  (void)body_of(c.sid, {}, report);
  EXPECT_THAT(report.missing, testing::IsEmpty());
  EXPECT_LT(report.inconsistency, 1e-9);
}

TEST(SecondOrder, is_refused_where_the_deck_does_not_tell_the_stresses) {
  Case c(data / "brick", 0);
  const auto with = [&](auto&& change) {
    Mesh mesh = c.mesh;
    change(mesh);
    return refusal([&] { (void)add_second_order(mesh, c.matrices, c.options, c.body); });
  };
  EXPECT_EQ(with([](Mesh&) {}), "");
  EXPECT_THAT(with([](Mesh& m) { m.elements.clear(); }), HasSubstr("no elements in the mesh's file"));
  EXPECT_THAT(with([](Mesh& m) { m.other_elements.insert("S4"); }), HasSubstr("elements of type S4"));
  EXPECT_THAT(with([](Mesh& m) {
                m.drawn_only.emplace(9, Element{"S4", {1, 2, 3, 4}});
                m.elements.clear();
              }),
              HasSubstr("elements of type S4"));
  EXPECT_EQ(with([](Mesh& m) {
              m.drawn_only.emplace(9, Element{"SFM3D4", {1, 2, 3, 4}});
            }),
            "")
      << "a skin bears nothing, as the balance shows";
  EXPECT_THAT(with([](Mesh& m) {
                m.drawn_only.emplace(9, Element{"S4", {1, 2, 3, 4}});
                m.materials["STEEL"].modulus *= 1.1;
              }),
              HasSubstr("without elements like its S4"));
  EXPECT_THAT(with([](Mesh& m) { m.materials.clear(); }), HasSubstr("material STEEL has no constant isotropic"));
  EXPECT_THAT(with([](Mesh& m) { m.sections.clear(); }), HasSubstr("element 1 has no *SOLID SECTION"));
  EXPECT_THAT(with([](Mesh& m) { m.materials["STEEL"].modulus *= 1.1; }), HasSubstr("leave 0.1 of the unit loads"));
  EXPECT_THAT(with([](Mesh& m) { std::swap(m.elements[1].nodes[0], m.elements[1].nodes[4]); }),
              HasSubstr("element 1 is inside out"));
}

}  // namespace
}  // namespace withy::fem
