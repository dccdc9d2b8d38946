/// \file
/// Small bodies and trees for tests that do not depend on the project's body plugins.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Particles and sections as given, `modes` modes that deform nothing but the tip: station "tip" at (length, 0, 0)
/// moves along y by the sum of the modal coordinates.
class TestBody final : public Body {
 public:
  struct Mass {
    double mass;
    Vector3 at;
  };
  TestBody(const std::vector<Mass>& masses, const Matrix3& inertia, const Vector3& inertia_at, double length = 0,
           Eigen::Index modes = 0)
      : length_(length), modes_(modes) {
    for (const Mass& m : masses) shape_.particles.push_back({m.mass, PointExpansion::rigid(m.at, modes)});
    if (!inertia.isZero(0)) shape_.sections.push_back({inertia, PointExpansion::rigid(inertia_at, modes)});
    for (Eigen::Index i = 1; i <= modes; ++i) shape_.mode_names.push_back("bending_y[" + std::to_string(i) + "]");
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(modes, modes);
    shape_.length = length;
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    const auto* text = std::get_if<std::string>(&name);
    if (text == nullptr || (*text != "root" && *text != "tip")) return {};
    if (*text == "root") return PointExpansion::rigid(Vector3::Zero(), modes_);
    PointExpansion tip = PointExpansion::rigid({length_, 0, 0}, modes_);
    tip.phi.row(1).setOnes();
    return tip;
  }
  std::string stations() const override { return "root, tip"; }

 private:
  double length_;
  Eigen::Index modes_;
  ModalShape shape_;
};

/// A rigid body of this mass and central inertia.
inline std::shared_ptr<const Body> test_rigid(double mass, const Vector3& center, const Matrix3& inertia) {
  return std::make_shared<TestBody>(std::vector<TestBody::Mass>{{mass, center}}, inertia, center);
}

/// A uniform straight rod along x from the root. Three Gauss points give its mass, first moment and inertia exactly.
inline std::shared_ptr<const Body> test_rod(double mass_per_length, double length, Eigen::Index modes = 0) {
  const double m = mass_per_length * length / 18;
  const double a = length / 2 * std::sqrt(0.6);
  return std::make_shared<TestBody>(
      std::vector<TestBody::Mass>{
          {5 * m, {length / 2 - a, 0, 0}}, {8 * m, {length / 2, 0, 0}}, {5 * m, {length / 2 + a, 0, 0}}},
      Matrix3::Zero(), Vector3::Zero(), length, modes);
}

/// The body in a tree, with the frame "root" and others fixed at poses in its root section or its tip's.
struct FrameAt {
  std::string name;
  std::string station;
  Pose pose;
};
inline BodyNode test_node(std::string name, std::shared_ptr<const Body> body, const std::vector<FrameAt>& frames = {}) {
  BodyNode node{std::move(name), std::move(body), {}, {}};
  node.frames.push_back({"root", *node.body->station("root"), {}});
  for (const FrameAt& f : frames) node.frames.push_back({f.name, *node.body->station(f.station), f.pose});
  return node;
}

}  // namespace withy
