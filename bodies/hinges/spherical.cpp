/// \file
/// The spherical hinge: x is the quaternion w x y z of M in F, ẋ the angular velocity ω_FM in F.
/// In M axes H = (R_FMᵀ, 0); Ḣẋ = −ω × ω = 0.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Spherical final : public Hinge {
 public:
  std::size_t coordinates() const override { return 4; }
  std::size_t speeds() const override { return 3; }
  void reference(std::span<double> x) const noexcept override {
    x[0] = 1;
    x[1] = x[2] = x[3] = 0;
  }
  void motion(std::span<const double> x, std::span<const double> /*rates*/, HingeMotion& out) const noexcept override {
    out.pose.R = rotation_from_quaternion(x[0], x[1], x[2], x[3]);
    out.pose.p.setZero();
    out.H.setZero(6, 3);
    out.H.topRows<3>() = out.pose.R.transpose();
    out.bias.setZero();
  }
  // Ṙᵀ = −Rᵀ ω̂ with ω = e_along in F.
  void motion_derivative(std::span<const double> x, std::span<const double> /*rates*/, std::size_t along,
                         HingeMotion& out) const override {
    const Matrix3 R = rotation_from_quaternion(x[0], x[1], x[2], x[3]);
    out.H.setZero(6, 3);
    out.H.topRows<3>() = -R.transpose() * skew<double>(Vector3(Vector3::Unit(static_cast<Eigen::Index>(along))));
    out.bias.setZero();
  }
  void derivatives(std::span<const double> x, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    quaternion_rates(x, rates, x_dot);
  }
  void normalize(std::span<double> x) const noexcept override { normalize_quaternion(x); }
  std::optional<HingeKernel> kernel() const override {
    return HingeKernel{HingeKernel::Kind::spherical, Vector3::UnitZ()};
  }
};

std::unique_ptr<Hinge> make_spherical(const Value& /*p*/, const MakeContext& /*context*/) {
  return std::make_unique<Spherical>();
}

}  // namespace

void enroll_spherical(Enrollment& enrollment) {
  enrollment.add<Hinge>({.id = "spherical",
                         .summary = "Any rotation; coordinates are a quaternion",
                         .parameters = {},
                         .make = &make_spherical});
}

}  // namespace withy
