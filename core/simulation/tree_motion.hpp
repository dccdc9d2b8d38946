/// \file
/// Motion of every body frame of a tree and the forces that carry it, for what a run watches: the elastic coordinates
/// count to first order.
#pragma once

#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// One body, world axes. Accelerations are those felt: gravity is subtracted.
struct BodyMotion {
  Matrix3 R = Matrix3::Identity();         ///< R_WB
  Vector3 p = Vector3::Zero();             ///< origin of the body frame [m]
  Vector3 rate = Vector3::Zero();          ///< ω of the body frame [rad/s]
  Vector3 spin_up = Vector3::Zero();       ///< ω̇ [rad/s²]
  Vector3 acceleration = Vector3::Zero();  ///< v̇ − g of the body frame's origin [m/s²]
  double mass = 0;                         ///< of the body and all that hangs on it [kg]
  Vector3 mass_moment = Vector3::Zero();   ///< Σ m p of the same [kg m]
  Vector3 force = Vector3::Zero();  ///< Σ m (p̈ − g) of the same [N]: with `load` what the inboard hinge carries
  Vector3 load = Vector3::Zero();   ///< of loads at frames of the same [N], which the hinge is spared
  /// Of what fields give mass that moves with the body frame, by place [1/s²]: at r from its origin the body feels less
  /// gradient · r beside what its frame's motion says.
  Matrix3 gradient = Matrix3::Zero();
};

/// A pass outward for the motions and one inward for the forces. Sections and particles move by r = X + Φq,
/// R = exp(Ψq); products of elastic rates among themselves are left out.
class TreeMotion {
 public:
  /// The model must outlive the object.
  explicit TreeMotion(const Model& model);
  /// Motions at y, laid out as State::y, with the accelerations u_dot of all generalized speeds. Allocates nothing.
  void update(std::span<const double> y, std::span<const double> u_dot);
  /// One a body of the model, as at the last update.
  [[nodiscard]] const std::vector<BodyMotion>& bodies() const { return bodies_; }

 private:
  /// Mass, first moment about the body frame's origin, and Σ m Φ.
  struct Mass {
    double mass = 0;
    Vector3 moment = Vector3::Zero();
    Matrix3X modal;
  };
  struct Relative {
    Matrix3 R = Matrix3::Identity();
    Vector3 r, r_rate, r_second, w, w_dot;  ///< body axes
  };
  [[nodiscard]] Relative frame(std::size_t body, int index, const Pose& offset) const;

  const Model& model_;
  std::vector<BodyMotion> bodies_;
  std::vector<Mass> masses_;
  std::vector<const Slot*> slots_;  ///< of the modes; null where there are none
  std::vector<HingeMotion> hinges_;
  std::span<const double> y_, u_dot_;
};

}  // namespace withy
