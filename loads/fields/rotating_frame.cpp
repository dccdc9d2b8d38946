/// \file
/// What all mass feels where the axes of the world turn.
#include "withy/core/plugin/direction.hpp"
#include "withy/loads/fields/bound_field.hpp"

namespace withy {
namespace {

using fields::FieldAt;

/// Turns about `axis` with rate + acceleration · t.
struct RotatingFrame : fields::SteadyLaw {
  double rate = 0, acceleration = 0;  ///< [rad/s], [rad/s²]
  Vector3 axis = Vector3::UnitZ(), center = Vector3::Zero();

  template <class S>
  [[nodiscard]] FieldAt<S> at(double t, const fields::V3<S>& r, const fields::V3<S>& v,
                              const fields::M3<S>& /*second*/) const {
    FieldAt<S> field;
    fields::add_turning<S>((rate + acceleration * t) * axis, acceleration * axis, r - center.cast<S>(), v, field);
    return field;
  }
};

std::unique_ptr<Load> make_rotating_frame(const Value& p, const MakeContext& context) {
  RotatingFrame law;
  law.rate = p.number_at("rate");
  law.acceleration = p.number_at("acceleration");
  law.center = fields::vector_at(p, "center");
  const std::optional<Vector3> axis = direction_at(p, "axis", context);
  if (!axis) return nullptr;
  law.axis = *axis;
  return std::make_unique<fields::Field<RotatingFrame>>(law);
}

}  // namespace

void enroll_rotating_frame(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "rotating-frame",
                        .summary = "Centrifugal, Coriolis and Euler forces on all mass: the axes of the world turn",
                        .parameters = {vector("axis", 3, "1", "that they turn about, of any length")
                                           .otherwise(Value::list({Value(0.0), Value(0.0), Value(1.0)})),
                                       number("rate", "rad/s", "of turning at time 0"),
                                       number("acceleration", "rad/s^2", "of turning").otherwise(0.0),
                                       fields::center_parameter("a point on the axis")},
                        .make = &make_rotating_frame});
}

}  // namespace withy
