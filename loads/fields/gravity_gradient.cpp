/// \file
/// The gradient of gravity along a circular orbit, seen from the point that moves on it.
#include <Eigen/Geometry>

#include "withy/core/plugin/direction.hpp"
#include "withy/loads/fields/bound_field.hpp"

namespace withy {
namespace {

using fields::FieldAt;

/// a = n² (3 e eᵀ − 1) r of mass at r from the point on the orbit, e pointing up. In axes that do not turn e goes round
/// with n; in those of the orbit it stays, and what turning axes feel is added (Hill 1878).
struct GravityGradient : fields::SteadyLaw {
  double rate = 0;  ///< n [rad/s]
  Vector3 normal = Vector3::UnitZ(), vertical = Vector3::UnitX(), center = Vector3::Zero();
  bool turning = false;

  template <class S>
  [[nodiscard]] FieldAt<S> at(double t, const fields::V3<S>& r, const fields::V3<S>& v,
                              const fields::M3<S>& /*second*/) const {
    const Vector3 e = turning ? vertical : Vector3(Eigen::AngleAxisd(rate * t, normal) * vertical);
    const fields::V3<S> p = r - center.cast<S>();
    FieldAt<S> field;
    field.by_position = Matrix3(rate * rate * (3 * e * e.transpose() - Matrix3::Identity())).cast<S>();
    field.a = field.by_position * p;
    if (turning) fields::add_turning<S>(rate * normal, Vector3::Zero(), p, v, field);
    return field;
  }
};

std::unique_ptr<Load> make_gravity_gradient(const Value& p, const MakeContext& context) {
  GravityGradient law;
  law.rate = p.number_at("rate");
  law.turning = p.text_at("axes") == "orbit";
  law.center = fields::vector_at(p, "center");
  const std::optional<Vector3> normal = direction_at(p, "normal", context);
  const std::optional<Vector3> vertical = direction_at(p, "vertical", context);
  if (!normal || !vertical) return nullptr;
  if (std::abs(normal->dot(*vertical)) > 1e-9) {
    context.diagnostics.error(p.at("vertical").place(), "is not perpendicular to 'normal'");
    return nullptr;
  }
  law.normal = *normal;
  law.vertical = *vertical;
  return std::make_unique<fields::Field<GravityGradient>>(law);
}

}  // namespace

void enroll_gravity_gradient(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "gravity-gradient",
       .summary = "Gradient of gravity on all mass, near a point that moves on a circular orbit",
       .parameters = {number("rate", "rad/s", "of the orbit, n").above(0),
                      vector("vertical", 3, "1",
                             "direction of what is up, of any length; at time 0 where axes are fixed")
                          .otherwise(Value::list({Value(1.0), Value(0.0), Value(0.0)})),
                      vector("normal", 3, "1", "of the orbit, about which it is passed, of any length")
                          .otherwise(Value::list({Value(0.0), Value(0.0), Value(1.0)})),
                      text("axes", "what the axes of the world are: 'fixed', or turning with the 'orbit'")
                          .one_of({"fixed", "orbit"})
                          .otherwise("fixed"),
                      fields::center_parameter("the point on the orbit")},
       .make = &make_gravity_gradient});
}

}  // namespace withy
