/// \file
/// The planar hinge: rotation by x[0] about a normal n, translation by x[1] and x[2] along two directions d, e = n × d
/// across it, all fixed in F. V_FM in M: ω = n ẋ[0], v = Rᵀ (d ẋ[1] + e ẋ[2]); Ḣẋ = (0, −ω × v).
#include "hinge_plugin.hpp"

namespace withy {
namespace {

class PlanarHinge final : public HolonomicHinge {
 public:
  PlanarHinge(const Vector3& normal, const Vector3& along) : normal_(normal) { across_ << along, normal.cross(along); }
  std::size_t speeds() const override { return 3; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    out.pose.R = Eigen::AngleAxisd(x[0], normal_).toRotationMatrix();
    out.pose.p = across_ * Eigen::Vector2d(x[1], x[2]);
    out.H.setZero(6, 3);
    out.H.col(0).head<3>() = normal_;
    out.H.bottomRightCorner<3, 2>() = out.pose.R.transpose() * across_;
    const Vector3 velocity = out.H.bottomRightCorner<3, 2>() * Eigen::Vector2d(rates[1], rates[2]);
    out.bias << Vector3::Zero(), -rates[0] * normal_.cross(velocity);
  }
  // v = Rᵀ (d ẋ[1] + e ẋ[2]) turns as −n × v with x[0].
  void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                         HingeMotion& out) const override {
    no_motion_derivative(*this, out);
    if (along > 0) return;
    HingeMotion here;
    motion(x, rates, here);
    out.H.bottomRightCorner<3, 2>() = -skew<double>(normal_) * here.H.bottomRightCorner<3, 2>();
    out.bias.tail<3>() = -normal_.cross(here.bias.tail<3>());
  }
  std::optional<HingeKernel> kernel() const override { return {}; }

 private:
  Vector3 normal_;
  Eigen::Matrix<double, 3, 2> across_;
};

std::unique_ptr<Hinge> make_planar(const Value& p, const MakeContext& context) {
  const auto normal = direction_at(p, "normal", context), along = direction_at(p, "along", context);
  if (!normal || !along) return nullptr;
  if (nearly_parallel(*normal, *along)) {
    context.diagnostics.error(p.at("along").place(), "is parallel to 'normal'; need a direction across it");
    return nullptr;
  }
  return std::make_unique<PlanarHinge>(*normal, (*along - *normal * normal->dot(*along)).normalized());
}

}  // namespace

void enroll_planar(Enrollment& enrollment) {
  enrollment.add<Hinge>(
      {.id = "planar",
       .summary = "Rotation about a normal and translation in the plane across it",
       .parameters = {vector("normal", 3, "1", "normal, the same components in both hinge frames; any length but zero")
                          .otherwise(direction(0, 0, 1)),
                      vector("along", 3, "1", "direction of the first translation; its part across the normal counts")
                          .otherwise(direction(1, 0, 0))},
       .make = &make_planar});
}

}  // namespace withy
