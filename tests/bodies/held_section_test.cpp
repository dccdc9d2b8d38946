// A body that is held at a section which its modes move: its fields as seen from there, and its damping.
#include "withy/core/shape/held_section.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "withy/bodies/modal/sid_body.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/shape/modal_mass.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {
namespace {

/// Some fields of two modes.
PointExpansion some_section(double phase) {
  PointExpansion e = PointExpansion::rigid({0.3 + phase, 0.1 * phase, -0.2}, 2);
  double x = phase;
  const auto next = [&x] { return std::sin(x += 1.7); };
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) e.phi(c, i) = next(), e.psi(c, i) = next();
    for (Eigen::Index j = 0; j <= i; ++j)
      for (std::size_t c = 0; c < 3; ++c) {
        e.gamma[c](i, j) = e.gamma[c](j, i) = next();
        e.theta[c](i, j) = e.theta[c](j, i) = next();
      }
  }
  return e;
}

Vector3 to_second_order(const Vector3& zero, const Matrix3X& first, const std::array<Eigen::MatrixXd, 3>& second,
                        const Eigen::VectorXd& q) {
  Vector3 r = zero + first * q;
  for (std::size_t c = 0; c < 3; ++c) r[static_cast<Eigen::Index>(c)] += 0.5 * q.dot(second[c] * q);
  return r;
}

Matrix3 rotation_of(const PointExpansion& e, const Eigen::VectorXd& q) {
  const Vector3 theta = to_second_order(Vector3::Zero(), e.psi, e.theta, q);
  return Eigen::AngleAxisd(theta.norm(), theta.normalized()).toRotationMatrix();
}

// What is left is of third order: an eighth at half the size.
TEST(HeldSections, SeeAPointMoveRelativeToThemToTheSecondOrder) {
  const PointExpansion section = some_section(0.2), point = some_section(1.1);
  const PointExpansion seen = HeldSection{section}.seen(point);
  const auto miss = [&](double size) {
    const Eigen::Vector2d q = size * Eigen::Vector2d(0.7, -1);
    const auto place = [&](const PointExpansion& e) { return to_second_order(e.X, e.phi, e.gamma, q); };
    const Matrix3 R = rotation_of(section, q);
    const Vector3 moved = R.transpose() * (place(point) - place(section)) + section.X;
    return std::pair((place(seen) - moved).norm(),
                     (rotation_of(seen, q) - R.transpose() * rotation_of(point, q)).norm());
  };
  const auto [far, turned_far] = miss(4e-4);
  const auto [near, turned_near] = miss(2e-4);
  EXPECT_LT(far, 1e-8);
  EXPECT_NEAR(far / near, 8, 0.1);
  EXPECT_NEAR(turned_far / turned_near, 8, 0.1);
  EXPECT_TRUE((HeldSection{section, Matrix3::Zero()}.leaves_all()));
  EXPECT_TRUE((HeldSection{PointExpansion::rigid({1, 0, 0}, 2)}.leaves_all()));
  EXPECT_FALSE(HeldSection{section}.leaves_all());
}

// Of a beam from a file that is turned round, held at its tip: the mass matrix is the dense one of the welded tree,
// which knows nothing of held sections.
TEST(ModalDamping, IsThatOfEveryModeOfTheBodyHeldAtItsRootAlsoWhereModesMoveIt) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto folder = std::filesystem::temp_directory_path() / ("withy-held-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto scene = [&](const std::string& boom) {
    return parse_scene("format: withy/1\ntime: {end: 1}\ngravity: [0, 0, 0]\nbodies: {boom: " + boom +
                           "}\nhinges: {h: {type: weld, parent: world, child: boom}}\n",
                       (folder / "scene.yaml").string(), registry, {"quadratic", "", {}});
  };
  const Scene beam = scene(
      "{type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 30, modes: 3}, bending_z: {stiffness: "
      "20, "
      "modes: 2}}");
  std::ofstream(folder / "boom.SID_FEM") << sid::write(
      sid_of(*beam.model->bodies()[0].body, {std::string("root"), std::string("tip")}));
  for (const char* root : {"", ", root: tip"}) {
    const Scene held = scene("{type: modal, file: boom.SID_FEM, damping_ratio: 0.01" + std::string(root) + "}");
    const DenseSystem s = held.formulation->compile(held.model)->system(0, held.initial.y);
    const auto n = static_cast<Eigen::Index>(s.size);
    ASSERT_EQ(n, 5);
    const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(s.mass.data(), n, n);
    const ModalShape& shape = held.model->bodies()[0].body->shape();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(shape.stiffness, M);
    const Eigen::MatrixXd D = modes.eigenvectors().transpose() * shape.damping * modes.eigenvectors();
    for (Eigen::Index k = 0; k < n; ++k) {
      const double critical = 2 * std::sqrt(modes.eigenvalues()[k]);
      EXPECT_NEAR(D(k, k) / critical, 0.01, 1e-8) << "mode " << k + 1 << root;
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace withy::test
