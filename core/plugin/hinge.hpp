/// \file
/// The interface of hinges.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Motion of the hinge frame M (on the child) relative to F (on the parent), for coordinates x and rates ẋ.
/// Twists are angular first, at M's origin, in the axes of M: V_FM = H ẋ; `bias` is the component-wise derivative
/// Ḣ ẋ in M.
struct HingeMotion {
  Pose pose;                                            ///< X_FM
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> H;  ///< motion subspace, 6×speeds
  Vector6 bias = Vector6::Zero();                       ///< Ḣ ẋ
};

/// A motion the sweeps know and inline. A hinge that has one must move exactly so; find_fault (validate.hpp) compares.
struct HingeKernel {
  enum class Kind {
    weld,       ///< no motion
    revolute,   ///< rotation by x[0] about `axis`
    prismatic,  ///< translation by x[0] along `axis`
    spherical,  ///< x: quaternion w x y z of M in F; ẋ: ω_FM in F
    free        ///< x: quaternion, then position of M in F; ẋ: ω_FM, then v_FM, both in F
  };
  Kind kind = Kind::weld;
  Vector3 axis = Vector3::UnitZ();  ///< unit vector, same components in F and M
};

/// A hinge between a frame F on the parent and a frame M on the child. Immutable; everything is a function of the
/// arguments. Coordinates [rad], [m]; rates [rad/s], [m/s]. None of these functions may throw or allocate once H in the
/// result has its size.
class Hinge {
 public:
  virtual ~Hinge() = default;
  /// Numbers of coordinates x and of rates (generalized speeds). Where there are as many, rates are ẋ, one by one;
  /// there are more coordinates where x holds quaternions.
  [[nodiscard]] virtual std::size_t coordinates() const = 0;
  [[nodiscard]] virtual std::size_t speeds() const = 0;
  /// The coordinates of the reference pose, X_FM as undisplaced as can be.
  virtual void reference(std::span<double> x) const noexcept = 0;
  /// R of the pose is a rotation: orthogonal, of determinant 1. H in `out` has a column a rate and keeps them.
  virtual void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept = 0;
  /// The derivatives of H and of the bias, at x and rates, with respect to a displacement along rate `along`: x changes
  /// as if that rate alone were one. In `out` the pose has no meaning; its derivative is R ω̂, R v with (ω, v) = H
  /// e_along. For analyses: may allocate. The default differentiates `motion` numerically (refined_difference.hpp), to
  /// about twelve digits where it is smooth over a few hundredths of a radian or metre, and to fewer where it is over
  /// less.
  virtual void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                                 HingeMotion& out) const;
  /// Time derivatives of the coordinates from the rates.
  virtual void derivatives(std::span<const double> x, std::span<const double> rates,
                           std::span<double> x_dot) const noexcept = 0;
  /// Removes integration drift of constrained coordinates (unit quaternions); others leave x alone.
  virtual void normalize(std::span<double> x) const noexcept = 0;
  /// The known motion this hinge is, if it is one.
  [[nodiscard]] virtual std::optional<HingeKernel> kernel() const = 0;
  /// Whether a rate is that of an angle: then it is told in rad/s, its coordinate in rad and its effort in N m, and
  /// else in m/s, m and N. Nothing: by the motion, an angle where the rate turns the child. For hinges that slide by an
  /// angle or turn by a length; of one that has a kernel nobody asks.
  [[nodiscard]] virtual std::optional<bool> angular(std::size_t /*rate*/) const { return {}; }
};

}  // namespace withy
