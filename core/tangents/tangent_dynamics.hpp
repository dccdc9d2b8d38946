/// \file
/// The equations of motion as a residual with its exact derivatives: what linearization, equilibria and modes rest on.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/deformation/rod_table.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

class ClosedMotions;

namespace analysis {
template <class S>
class Recursion;
template <class S>
struct AppliedWrench;
}  // namespace analysis

/// The residual r(δ, u, a) = M a − f − τ at one state, τ the efforts of the loads, with its derivatives. Displacements
/// δ have one number a speed: x changes as if the speeds were δ for a unit of time, so that a rotation is displaced by
/// the rotation vector whose rate its speeds are. Shapes: speeds, speeds × speeds.
struct Tangents {
  Eigen::VectorXd residual;     ///< [N m, N]
  Eigen::MatrixXd mass;         ///< ∂r/∂a = M
  Eigen::MatrixXd by_position;  ///< ∂r/∂δ: tangent stiffness, with weight, spin, acceleration and loads
  Eigen::MatrixXd by_speed;     ///< ∂r/∂u: damping and gyroscopic terms
  /// With the continuous states z of loads, ż = g(t, δ, u, z): ∂r/∂z (speeds × z), ∂g/∂δ and ∂g/∂u (z × speeds), ∂g/∂z.
  Eigen::MatrixXd by_state, rate_by_position, rate_by_speed, rate_by_state;
  /// ∂g/∂a where a load measures accelerations (z × speeds); the derivatives above are then those at a that stays.
  Eigen::MatrixXd rate_by_acceleration;
  /// Sizes of what the diagonal of by_position is known against, as TangentDynamics::stiffness_in_play tells; empty
  /// where nobody asked.
  Eigen::VectorXd in_play;
  /// C of δ̇ = δu + C δ: zero but where speeds are no derivatives of coordinates (angular velocities).
  Eigen::MatrixXd drift;
  /// Loads whose derivatives are numerical: without BoundLoad::add_derivatives or those of their continuous part, or
  /// wrenches that depend on their frame's motion, with respect to that motion.
  std::vector<std::string> differenced;
  bool loops = false;  ///< of closed loops; what these exert is differentiated by differences
};

/// The part of Tangents that equilibria need.
struct Stiffness {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_position;
  Eigen::MatrixXd by_state, rate_by_position, rate_by_state;  ///< empty where no load has continuous states
  Eigen::VectorXd
      diagonal_terms;  ///< magnitudes of the terms that each element of by_position's diagonal is the sum of
};

/// Position of a frame with its derivatives.
struct FrameTangent {
  Vector3 position = Vector3::Zero();    ///< in the world [m]
  Matrix3X by_position;                  ///< 3 × speeds, with respect to δ
  Vector3 deflection = Vector3::Zero();  ///< r − X of the frame's section, body axes [m]
  Matrix3X deflection_by_position;       ///< 3 × speeds
};

/// A model in one formulation. Of closed loops see keep_closed. Derivatives are exact to rounding: the recursive
/// Newton–Euler algorithm in numbers that carry derivatives, an algorithm independent of sweeps and of
/// ReferenceDynamics; the strict truncation, itself a derivative (theory (3)), takes them nested, and the symmetric one
/// in series. Exception: loads and hinges of others that do not differentiate themselves. Const functions allocate.
class TangentDynamics {
 public:
  /// `terms` are the formulation's.
  /// \throws std::invalid_argument where a body's kinematics is to be exact and it offers none.
  TangentDynamics(std::shared_ptr<const Model> model, Terms terms);

  [[nodiscard]] const Model& model() const { return *model_; }
  /// From here on all of the functions below, where the model has loops, are of motions that keep these closed
  /// (ClosedMotions): rows and columns of speeds that follow others are zero, those of the others are of all that moves
  /// with them. Speeds and accelerations that are given are those of the others. What changes the shape of a loop is to
  /// be at rest.
  /// \param equations of the same model and formulation; of loops, ClosedLoops \param held one a speed
  void keep_closed(std::shared_ptr<const EquationsOfMotion> equations, const State& state,
                   const std::vector<bool>& held);
  /// ClosedMotions::singular; false of trees.
  [[nodiscard]] bool singular(std::span<const double> y) const;
  /// Speeds that follow others, one a speed; none before keep_closed.
  [[nodiscard]] std::vector<bool> follows() const;
  /// Speeds or accelerations with those of what follows, and efforts on all speeds as they act on the others.
  [[nodiscard]] Eigen::MatrixXd whole(std::span<const double> y, const Eigen::MatrixXd& speeds) const;
  [[nodiscard]] Eigen::MatrixXd on_motions(std::span<const double> y, const Eigen::MatrixXd& efforts) const;
  /// The accelerations of steady motion: those that prescribed motions have at t, all others zero.
  [[nodiscard]] Eigen::VectorXd steady_accelerations(double t) const;
  /// r at time t, y as in State, a one number a speed.
  [[nodiscard]] Eigen::VectorXd residual(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  /// What the terms of the residual amount to, one a speed [N m, N]: what weight, inertia, wrenches, stiffness and each
  /// load would come to if none made up for another. Against this a residual is small or not.
  [[nodiscard]] Eigen::VectorXd terms_in_play(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  /// What stiffness forces in play could have, one a speed [N m/rad, N/m]: beside a small share of it an element of the
  /// diagonal of ∂r/∂δ is rounding. The terms of that element, and M_ii ω² with the greatest ω² that weight, inertia
  /// and wrenches turn anything with, which leave rounding on what they do not turn too. Springs of hinges and the
  /// stiffness of bodies act on their own coordinates alone.
  /// \param terms magnitudes of the terms of the diagonal \param mass M_ii
  [[nodiscard]] Eigen::VectorXd stiffness_in_play(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                                  const Eigen::VectorXd& terms, const Eigen::VectorXd& mass) const;
  /// g of Tangents: rates of the continuous states of loads.
  [[nodiscard]] Eigen::VectorXd rates(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  [[nodiscard]] Tangents tangents(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  /// M alone, at a third of the cost of all tangents.
  [[nodiscard]] Eigen::MatrixXd mass(double t, std::span<const double> y) const;
  /// What depends on speeds and accelerations left out, at a third of the cost.
  [[nodiscard]] Stiffness stiffness(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  /// In the formulation's strain kinematics without truncation, as results show them.
  [[nodiscard]] FrameTangent frame(std::span<const double> y, int body, int frame) const;
  /// Moves y by δ (a quaternion to first order, then scaled to unit length). Where loops cannot be closed then, it is
  /// not finite.
  void displace(std::span<double> y, const Eigen::VectorXd& delta) const;

 private:
  struct Seeds;
  struct Plain;
  template <class T>
  struct Builder;
  /// Wrenches of the loads at frames, `shown` being the tree at the deformation that the truncations keep.
  template <class T>
  std::vector<analysis::AppliedWrench<T>> wrenches(double t, std::span<const double> y,
                                                   const analysis::Recursion<T>& shown,
                                                   std::vector<bool>* differenced) const;
  /// \param plain what passes over the same y know of bodies without derivatives
  /// \param seen the state that wrenches of loads see, y where it is empty
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> efforts(double t, std::span<const double> y,
                                                            const Eigen::VectorXd& a, Seeds seeds, Plain& plain,
                                                            std::vector<bool>* differenced = nullptr,
                                                            std::span<const double> seen = {}) const;
  /// Directions, those of one body's modes next to each other: what all others are is found without derivatives.
  [[nodiscard]] std::vector<std::size_t> directions(std::size_t from, std::size_t count) const;
  /// Minus the residual without stiffness and accelerations: the efforts of wrenches at frames and those of speeds.
  /// \param seen the state that the wrenches see
  [[nodiscard]] Eigen::VectorXd frame_load_efforts(double t, std::span<const double> y,
                                                   std::span<const double> seen) const;
  /// The residual; its derivatives along directions from `from` on, one a column.
  Eigen::VectorXd differentiate(double t, std::span<const double> y, const Eigen::VectorXd& a, std::size_t from,
                                Eigen::Ref<Eigen::MatrixXd> columns, std::vector<bool>* differenced) const;
  /// add_elastic, add_loads and add_continuous add what they add to the diagonal of by_position to in_play too.
  void add_elastic(Tangents& tangents) const;
  void add_loads(double t, std::span<const double> y, const Eigen::VectorXd& a, Tangents& tangents) const;
  void add_continuous(double t, std::span<const double> y, const Eigen::VectorXd& a, Tangents& tangents) const;
  [[nodiscard]] Eigen::VectorXd load_efforts(double t, std::span<const double> y) const;
  /// Their magnitudes, load by load.
  [[nodiscard]] Eigen::VectorXd load_sizes(double t, std::span<const double> y) const;
  [[nodiscard]] Eigen::VectorXd elastic(std::span<const double> y) const;
  /// HingeNode::reflected_inertia, by speeds.
  [[nodiscard]] Eigen::VectorXd reflected() const;
  [[nodiscard]] Eigen::MatrixXd drift(std::span<const double> y) const;
  /// Those of the tree, loops open, at accelerations of all speeds.
  [[nodiscard]] Eigen::VectorXd open_residual(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  [[nodiscard]] Tangents open_tangents(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  [[nodiscard]] Stiffness open_stiffness(double t, std::span<const double> y, const Eigen::VectorXd& a) const;
  [[nodiscard]] Eigen::MatrixXd open_mass(double t, std::span<const double> y) const;
  /// Makes those of the tree those of motions that keep the loops closed.
  void close(std::span<const double> y, const Eigen::VectorXd& a, Tangents& tangents) const;

  std::shared_ptr<const Model> model_;
  std::vector<Terms> terms_;                           ///< of each body
  std::vector<const Slot*> slots_;                     ///< of each body's modes; null where it has none
  std::vector<std::shared_ptr<const RodTable>> rods_;  ///< of each body; null where its kinematics is an expansion
  std::shared_ptr<const ClosedMotions> closed_;        ///< null of trees
  bool controlled_frames_ = false;                     ///< a load with a continuous part acts at a frame
  bool strict_ = false, symmetric_ = false;
  bool products_of_speeds_ = true;
};

}  // namespace withy
