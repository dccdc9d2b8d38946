/// \file
/// A field of acceleration as a load on distributed mass.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/spatial/jet.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy::fields {

template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;

/// An acceleration a(r, v) of mass at r with velocity v, world axes, and its gradients there.
template <class S>
struct FieldAt {
  V3<S> a = V3<S>::Zero();            ///< [m/s²]
  M3<S> by_position = M3<S>::Zero();  ///< ∂a/∂r [1/s²]
  M3<S> by_velocity = M3<S>::Zero();  ///< ∂a/∂v [1/s]
  V3<S> curvature = V3<S>::Zero();    ///< ½ Σ_jk S_jk ∂²a/∂r_j∂r_k of the second moment S that was asked for
};

/// `Law` has `template <class S> FieldAt<S> at(double t, r, v, S) const`, and discontinuities() and end() as BoundLoad;
/// courses() and course() as CourseOfTime where it follows a formula of the time.
/// A point's own mass feels a; what turns about it, with S = Σ m ρ ρᵀ, feels
///   f = ½ S:∂²a/∂r²,   moment_i = ε_ijk (A S)_kj,   A = ∂a/∂r + ∂a/∂v ω̂,
/// for ρ̇ = ω × ρ: what the field, expanded about the point, does to second moments.
template <class Law>
class BoundField final : public FieldLoad, public CourseOfTime {
 public:
  BoundField(const Model& model, Law law) : FieldLoad(model), law_(std::move(law)) {}

  Wrench wrench(double t, const MassPoint& point, const FrameMotion& m) const noexcept override {
    const auto [moment, force] = on<double>(t, point, m.R, m.position, m.angular_velocity, m.velocity);
    return {moment, force};
  }
  Slope slope(double t, const MassPoint& point, const FrameMotion& m) const override {
    using Dual = DualNumber<double, 12>;
    const auto seeded = [](const Vector3& x, std::size_t first) {
      V3<Dual> d = x.cast<Dual>();
      for (std::size_t i = 0; i < 3; ++i) d[static_cast<Eigen::Index>(i)].derivatives()[first + i] = 1;
      return d;
    };
    const V3<Dual> turn = seeded(Vector3::Zero(), 0);
    M3<Dual> R = m.R.cast<Dual>();
    R += skew<Dual>(turn) * m.R.cast<Dual>();
    const auto [moment, force] =
        on<Dual>(t, point, R, seeded(m.position, 3), seeded(m.angular_velocity, 6), seeded(m.velocity, 9));
    Slope slope;
    for (Eigen::Index e = 0; e < 3; ++e) {
      for (Eigen::Index k = 0; k < 12; ++k) {
        slope(e, k) = moment[e].derivatives()[static_cast<std::size_t>(k)];
        slope(e + 3, k) = force[e].derivatives()[static_cast<std::size_t>(k)];
      }
    }
    return slope;
  }
  std::vector<double> discontinuities() const override { return law_.discontinuities(); }
  double end() const override { return law_.end(); }
  std::size_t courses() const override {
    if constexpr (requires { law_.courses(); }) return law_.courses();
    return 0;
  }
  void course(double t, std::span<double> values) const noexcept override {
    if constexpr (requires { law_.courses(); }) law_.course(t, values);
  }
  std::unique_ptr<BoundLoad> rebound(const Model& model, const Terms& /*terms*/) const override {
    if (is_of(model)) return nullptr;
    return std::make_unique<BoundField>(model, law_);
  }

 private:
  /// Moment and force.
  template <class S>
  std::pair<V3<S>, V3<S>> on(double t, const MassPoint& point, const M3<S>& R, const V3<S>& r, const V3<S>& w,
                             const V3<S>& v) const {
    if (point.second.isZero(0))
      return {V3<S>::Zero(), V3<S>(law_.template at<S>(t, r, v, M3<S>::Zero()).a * S(point.mass))};
    const M3<S> second = R * point.second.cast<S>() * R.transpose();
    const FieldAt<S> field = law_.template at<S>(t, r, v, second);
    const M3<S> pull = (field.by_position + M3<S>(field.by_velocity * skew<S>(w))) * second;
    const V3<S> moment(pull(2, 1) - pull(1, 2), pull(0, 2) - pull(2, 0), pull(1, 0) - pull(0, 1));
    return {moment, V3<S>(field.a * S(point.mass) + field.curvature)};
  }

  Law law_;
};

/// A field as the scene states it: on all bodies.
template <class Law>
class Field final : public Load {
 public:
  explicit Field(Law law) : law_(std::move(law)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundField<Law>>(model, law_);
  }

 private:
  Law law_;
};

/// What laws share that are steady.
struct SteadyLaw {
  [[nodiscard]] static std::vector<double> discontinuities() { return {}; }
  [[nodiscard]] static double end() { return 0; }
};

/// What the axes of the world feel where they turn at Ω, with Ω̇, about a point at rest from which r is measured:
///   a = −Ω × (Ω × r) − Ω̇ × r − 2 Ω × v.
template <class S>
void add_turning(const Vector3& rate, const Vector3& acceleration, const V3<S>& r, const V3<S>& v, FieldAt<S>& field) {
  const Matrix3 turn = skew<double>(rate);
  const M3<S> by_position = Matrix3(-turn * turn - skew<double>(acceleration)).cast<S>();
  const M3<S> by_velocity = Matrix3(-2 * turn).cast<S>();
  field.a += by_position * r + by_velocity * v;
  field.by_position += by_position;
  field.by_velocity += by_velocity;
}

inline Vector3 vector_at(const Value& p, const char* key) {
  const std::vector<double> x = p.at(key).numbers();
  return {x[0], x[1], x[2]};
}

inline ParameterSpec center_parameter(std::string meaning) {
  return vector("center", 3, "m", std::move(meaning)).otherwise(Value::list({Value(0.0), Value(0.0), Value(0.0)}));
}

}  // namespace withy::fields
