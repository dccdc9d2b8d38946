/// \file
/// Gravity of a point mass, or of a sphere, on all mass.
#include <cmath>

#include "withy/loads/fields/bound_field.hpp"

namespace withy {
namespace {

using fields::FieldAt;

/// a = −μ p/|p|³ of mass at p from the centre.
struct PointGravity : fields::SteadyLaw {
  double parameter = 0;  ///< μ [m³/s²]
  Vector3 center = Vector3::Zero();

  template <class S>
  [[nodiscard]] FieldAt<S> at(double /*t*/, const fields::V3<S>& r, const fields::V3<S>& /*v*/,
                              const fields::M3<S>& second) const {
    using std::sqrt;
    const fields::V3<S> p = r - center.cast<S>();
    const S d2 = p.squaredNorm(), inverse = S(1.0) / d2, k = inverse * S(parameter) / S(sqrt(d2));  // μ/d³
    FieldAt<S> field;
    field.a = p * S(-k);
    const S k5 = k * inverse;
    field.by_position = p * p.transpose() * S(k5 * 3.0) - fields::M3<S>::Identity() * k;
    const fields::V3<S> Sp = second * p;
    const S along = p.dot(Sp) * inverse;
    field.curvature = (Sp * S(2.0) + p * S(second.trace() - along * 5.0)) * S(k5 * 1.5);
    return field;
  }
};

std::unique_ptr<Load> make_point_gravity(const Value& p, const MakeContext& /*context*/) {
  PointGravity law;
  law.parameter = p.number_at("parameter");
  law.center = fields::vector_at(p, "center");
  return std::make_unique<fields::Field<PointGravity>>(law);
}

}  // namespace

void enroll_point_gravity(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "point-gravity",
       .summary = "Gravity of a point mass on all mass of all bodies: orbits",
       .parameters = {number("parameter", "m^3/s^2", "gravitational parameter of what attracts, G M").above(0),
                      fields::center_parameter("where it is, world axes")},
       .make = &make_point_gravity});
}

}  // namespace withy
