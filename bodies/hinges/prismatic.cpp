/// \file
/// The prismatic hinge: translation by x along an axis, V_FM = (0, axis) ẋ.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Prismatic final : public HolonomicHinge {
 public:
  explicit Prismatic(const Vector3& axis) : axis_(axis) {}
  std::size_t speeds() const override { return 1; }
  void motion(std::span<const double> x, std::span<const double> /*rates*/, HingeMotion& out) const noexcept override {
    out.pose.R.setIdentity();
    out.pose.p = axis_ * x[0];
    out.H.resize(6, 1);
    out.H << Vector3::Zero(), axis_;
    out.bias.setZero();
  }
  void motion_derivative(std::span<const double> /*x*/, std::span<const double> /*rates*/, std::size_t /*along*/,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
  }
  std::optional<HingeKernel> kernel() const override { return HingeKernel{HingeKernel::Kind::prismatic, axis_}; }

 private:
  Vector3 axis_;
};

std::unique_ptr<Hinge> make_prismatic(const Value& p, const MakeContext& context) {
  const auto axis = direction_at(p, "axis", context);
  if (!axis) return nullptr;
  return std::make_unique<Prismatic>(*axis);
}

}  // namespace

void enroll_prismatic(Enrollment& enrollment) {
  enrollment.add<Hinge>({.id = "prismatic",
                         .summary = "Translation along an axis",
                         .parameters = axis_parameter(),
                         .make = &make_prismatic});
}

}  // namespace withy
