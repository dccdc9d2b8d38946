/// \file
/// The rigid body: mass, centre of mass and inertia about it.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

class RigidBody final : public Body {
 public:
  RigidBody(double mass, const Vector3& center_of_mass, const Matrix3& inertia) {
    shape_.particles.push_back({mass, PointExpansion::rigid(center_of_mass, 0)});
    shape_.sections.push_back({inertia, PointExpansion::rigid(center_of_mass, 0)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    const auto* text = std::get_if<std::string>(&name);
    if (text == nullptr || *text != "root") return {};
    return PointExpansion::rigid(Vector3::Zero(), 0);
  }
  std::string stations() const override { return "root"; }

 private:
  ModalShape shape_;
};

/// The central inertia of any distribution of mass has non-negative principal moments, none above the sum of the
/// others.
bool physical(const Matrix3& inertia, double& excess) {
  const Vector3 I = Eigen::SelfAdjointEigenSolver<Matrix3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  const double rounding = 1e-12 * inertia.cwiseAbs().maxCoeff();
  excess = I[2] - I[0] - I[1];
  return I[0] >= -rounding && excess <= rounding;
}

std::unique_ptr<Body> make_rigid(const Value& p, const MakeContext& context) {
  const std::vector<double> c = p.at("center_of_mass").numbers();
  const std::vector<double> i = p.at("inertia").numbers();
  Matrix3 inertia;
  inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  double excess = 0;
  if (!physical(inertia, excess)) {
    context.diagnostics.error(
        p.at("inertia").place(),
        "no distribution of mass has this inertia about its centre of mass; need principal "
        "moments >= 0, none above the "
        "sum of the other two (triangle inequality; " +
            (std::isfinite(excess) ? fmt::format("here the greatest exceeds the sum by {:.4g} kg m^2)", excess)
                                   : std::string("here they are beyond the range of numbers)")));
    return nullptr;
  }
  return std::make_unique<RigidBody>(p.number_at("mass"), Vector3(c[0], c[1], c[2]), inertia);
}

}  // namespace

void enroll_rigid(Enrollment& enrollment) {
  const Value none = Value::list({Value(0.0), Value(0.0), Value(0.0)});
  const Value point = Value::list({Value(0.0), Value(0.0), Value(0.0), Value(0.0), Value(0.0), Value(0.0)});
  enrollment.add<Body>({.id = "rigid",
                        .summary = "Rigid body",
                        .parameters = {number("mass", "kg", "mass").least(0),
                                       vector("center_of_mass", 3, "m", "centre of mass, body frame").otherwise(none),
                                       vector("inertia", 6, "kg m^2",
                                              "elements xx, yy, zz, xy, xz, yz of the inertia matrix about the centre "
                                              "of mass, body axes")
                                           .otherwise(point)},
                        .make = &make_rigid});
}

}  // namespace withy
