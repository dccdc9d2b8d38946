/// \file
/// The cylindrical hinge: rotation by x[0] about an axis and translation by x[1] along it.
/// H = [axis, 0; 0, axis], constant in M, whose axis is that of F.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Cylindrical final : public HolonomicHinge {
 public:
  explicit Cylindrical(const Vector3& axis) : axis_(axis) {}
  std::size_t speeds() const override { return 2; }
  void motion(std::span<const double> x, std::span<const double> /*rates*/, HingeMotion& out) const noexcept override {
    out.pose.R = Eigen::AngleAxisd(x[0], axis_).toRotationMatrix();
    out.pose.p = axis_ * x[1];
    out.H.setZero(6, 2);
    out.H.col(0).head<3>() = axis_;
    out.H.col(1).tail<3>() = axis_;
    out.bias.setZero();
  }
  void motion_derivative(std::span<const double> /*x*/, std::span<const double> /*rates*/, std::size_t /*along*/,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
  }
  std::optional<HingeKernel> kernel() const override { return {}; }

 private:
  Vector3 axis_;
};

std::unique_ptr<Hinge> make_cylindrical(const Value& p, const MakeContext& context) {
  const auto axis = direction_at(p, "axis", context);
  if (!axis) return nullptr;
  return std::make_unique<Cylindrical>(*axis);
}

}  // namespace

void enroll_cylindrical(Enrollment& enrollment) {
  enrollment.add<Hinge>({.id = "cylindrical",
                         .summary = "Rotation about an axis and translation along it",
                         .parameters = axis_parameter(),
                         .make = &make_cylindrical});
}

}  // namespace withy
