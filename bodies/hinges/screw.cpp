/// \file
/// The screw: rotation by x about an axis, with a translation of pitch · x along it; V_FM = (axis, pitch axis) ẋ.
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Screw final : public HolonomicHinge {
 public:
  Screw(const Vector3& axis, double pitch) : axis_(axis), pitch_(pitch) {}
  std::size_t speeds() const override { return 1; }
  void motion(std::span<const double> x, std::span<const double> /*rates*/, HingeMotion& out) const noexcept override {
    out.pose.R = Eigen::AngleAxisd(x[0], axis_).toRotationMatrix();
    out.pose.p = axis_ * (pitch_ * x[0]);
    out.H.resize(6, 1);
    out.H << axis_, axis_ * pitch_;
    out.bias.setZero();
  }
  void motion_derivative(std::span<const double> /*x*/, std::span<const double> /*rates*/, std::size_t /*along*/,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
  }
  std::optional<HingeKernel> kernel() const override { return {}; }

 private:
  Vector3 axis_;
  double pitch_;  ///< [m/rad]
};

std::unique_ptr<Hinge> make_screw(const Value& p, const MakeContext& context) {
  const auto axis = direction_at(p, "axis", context);
  if (!axis) return nullptr;
  return std::make_unique<Screw>(*axis, p.number_at("pitch"));
}

}  // namespace

void enroll_screw(Enrollment& enrollment) {
  std::vector<ParameterSpec> parameters = axis_parameter();
  parameters.push_back(number("pitch", "m/rad",
                              "translation for one radian, as \"2 mm/rev\" where a turn is meant; a negative one is a "
                              "left-hand thread"));
  enrollment.add<Hinge>({.id = "screw",
                         .summary = "Rotation about an axis with a translation along it in proportion",
                         .parameters = std::move(parameters),
                         .make = &make_screw});
}

}  // namespace withy
