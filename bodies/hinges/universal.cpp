/// \file
/// The universal hinge: rotation by x[0] about an axis a fixed in F, then by x[1] about an axis b fixed in M,
/// R_FM = R_a(x[0]) R_b(x[1]). In M axes H = [R_bᵀ a, b; 0]; Ḣẋ = −b × (R_bᵀ a) ẋ[0] ẋ[1].
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class Universal final : public HolonomicHinge {
 public:
  Universal(const Vector3& first, const Vector3& second) : first_(first), second_(second) {}
  std::size_t speeds() const override { return 2; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    const Matrix3 R_b = Eigen::AngleAxisd(x[1], second_).toRotationMatrix();
    const Vector3 first = R_b.transpose() * first_;
    out.pose.R = Eigen::AngleAxisd(x[0], first_).toRotationMatrix() * R_b;
    out.pose.p.setZero();
    out.H.setZero(6, 2);
    out.H.topRows<3>() << first, second_;
    out.bias << first.cross(second_) * (rates[0] * rates[1]), Vector3::Zero();
  }
  // R_bᵀ a turns as −b × R_bᵀ a with x[1].
  void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
    if (along == 0) return;
    const Vector3 first = Eigen::AngleAxisd(x[1], second_).toRotationMatrix().transpose() * first_;
    const Vector3 turned = -second_.cross(first);
    out.H.col(0).head<3>() = turned;
    out.bias.head<3>() = turned.cross(second_) * (rates[0] * rates[1]);
  }
  std::optional<HingeKernel> kernel() const override { return {}; }

 private:
  Vector3 first_;
  Vector3 second_;
};

std::unique_ptr<Hinge> make_universal(const Value& p, const MakeContext& context) {
  const auto first = direction_at(p, "first_axis", context), second = direction_at(p, "second_axis", context);
  if (!first || !second) return nullptr;
  if (nearly_parallel(*first, *second)) {
    context.diagnostics.error(p.at("second_axis").place(), "is parallel to 'first_axis'; need two directions");
    return nullptr;
  }
  return std::make_unique<Universal>(*first, *second);
}

}  // namespace

void enroll_universal(Enrollment& enrollment) {
  enrollment.add<Hinge>(
      {.id = "universal",
       .summary = "Rotation about an axis of the parent, then about an axis of the child",
       .parameters = {vector("first_axis", 3, "1", "axis in the hinge frame F of the parent; any length")
                          .otherwise(direction(1, 0, 0)),
                      vector("second_axis", 3, "1", "axis in the hinge frame M of the child; any length")
                          .otherwise(direction(0, 1, 0))},
       .make = &make_universal});
}

}  // namespace withy
