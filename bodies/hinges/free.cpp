/// \file
/// The free hinge: x is the quaternion w x y z, then the position of M in F; ẋ is ω_FM, then v_FM, both in F.
/// In M axes H = diag(Rᵀ, Rᵀ); Ḣẋ = (0, −ω × v) with ω, v in M axes.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Free final : public Hinge {
 public:
  std::size_t coordinates() const override { return 7; }
  std::size_t speeds() const override { return 6; }
  void reference(std::span<double> x) const noexcept override {
    for (double& xi : x) xi = 0;
    x[0] = 1;
  }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    out.pose.R = rotation_from_quaternion(x[0], x[1], x[2], x[3]);
    out.pose.p << x[4], x[5], x[6];
    out.H.setZero(6, 6);
    out.H.topLeftCorner<3, 3>() = out.pose.R.transpose();
    out.H.bottomRightCorner<3, 3>() = out.pose.R.transpose();
    const Vector3 omega(rates[0], rates[1], rates[2]);
    const Vector3 velocity(rates[3], rates[4], rates[5]);
    out.bias.head<3>().setZero();
    out.bias.tail<3>() = -(out.pose.R.transpose() * omega.cross(velocity));
  }
  // Along an angular velocity Ṙᵀ = −Rᵀ ω̂ with ω = e_along in F; along a velocity nothing changes.
  void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                         HingeMotion& out) const override {
    out.H.setZero(6, 6);
    out.bias.setZero();
    if (along >= 3) return;
    const Matrix3 R = rotation_from_quaternion(x[0], x[1], x[2], x[3]);
    const Matrix3 Rt_rate = -R.transpose() * skew<double>(Vector3(Vector3::Unit(static_cast<Eigen::Index>(along))));
    out.H.topLeftCorner<3, 3>() = Rt_rate;
    out.H.bottomRightCorner<3, 3>() = Rt_rate;
    const Vector3 omega(rates[0], rates[1], rates[2]);
    const Vector3 velocity(rates[3], rates[4], rates[5]);
    out.bias.tail<3>() = -(Rt_rate * omega.cross(velocity));
  }
  void derivatives(std::span<const double> x, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    quaternion_rates(x, rates.first(3), x_dot.first(4));
    for (std::size_t i = 0; i < 3; ++i) x_dot[4 + i] = rates[3 + i];
  }
  void normalize(std::span<double> x) const noexcept override { normalize_quaternion(x); }
  std::optional<HingeKernel> kernel() const override { return HingeKernel{HingeKernel::Kind::free, Vector3::UnitZ()}; }
};

std::unique_ptr<Hinge> make_free(const Value& /*p*/, const MakeContext& /*context*/) {
  return std::make_unique<Free>();
}

}  // namespace

void enroll_free(Enrollment& enrollment) {
  enrollment.add<Hinge>({.id = "free",
                         .summary = "Any motion; coordinates are a quaternion and a position",
                         .parameters = {},
                         .make = &make_free});
}

}  // namespace withy
