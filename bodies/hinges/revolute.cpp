/// \file
/// The revolute hinge: rotation by x about an axis, V_FM = (axis, 0) ẋ.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Revolute final : public HolonomicHinge {
 public:
  explicit Revolute(const Vector3& axis) : axis_(axis) {}
  std::size_t speeds() const override { return 1; }
  void motion(std::span<const double> x, std::span<const double> /*rates*/, HingeMotion& out) const noexcept override {
    out.pose.R = Eigen::AngleAxisd(x[0], axis_).toRotationMatrix();
    out.pose.p.setZero();
    out.H.resize(6, 1);
    out.H << axis_, Vector3::Zero();
    out.bias.setZero();
  }
  void motion_derivative(std::span<const double> /*x*/, std::span<const double> /*rates*/, std::size_t /*along*/,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
  }
  std::optional<HingeKernel> kernel() const override { return HingeKernel{HingeKernel::Kind::revolute, axis_}; }

 private:
  Vector3 axis_;
};

std::unique_ptr<Hinge> make_revolute(const Value& p, const MakeContext& context) {
  const auto axis = direction_at(p, "axis", context);
  if (!axis) return nullptr;
  return std::make_unique<Revolute>(*axis);
}

}  // namespace

void enroll_revolute(Enrollment& enrollment) {
  enrollment.add<Hinge>(
      {.id = "revolute", .summary = "Rotation about an axis", .parameters = axis_parameter(), .make = &make_revolute});
}

}  // namespace withy
