/// \file
/// How the hinges of closed loops follow the elastic coordinates, and what vibrates then.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// J of the closing equations at y, laid out as State::y: equations × speeds, J u [m/s]. No rows where there are no
/// loops. Allocates.
Eigen::MatrixXd closing_rows(const EquationsOfMotion& equations, std::span<const double> y);

/// A basis of the speeds that keep loops closed: columns z with rows · z = 0.
/// \param rows as of closing_rows, of some of the speeds
/// \param inertia M_ii of these, by which they are scaled before ranks are told; zero or less counts as one
Eigen::MatrixXd closed_motions(const Eigen::MatrixXd& rows, const Eigen::VectorXd& inertia);

/// What the loops make of the elastic coordinates q of one body while all other bodies stay as they are bent.
struct LoopBound {
  /// ω per q̇ that the hinges which follow give the section at the inboard hinge, axes of the root's section. What modes
  /// turn that section by in the body frame is no part of it.
  Matrix3X turn;
  Eigen::MatrixXd bound;  ///< rows · q̇ = 0: of what no hinge can follow; equations × modes
};

/// In trees the load and the frequency of a body are told with all hinges held. The hinges of a loop cannot be held: of
/// a rod that is pinned at both ends both pins turn as it bends. They move as little as the loops let them, in the
/// sense of M: with J = (J_h, J_q) of hinges that no motion drives and of elastic coordinates,
///   u_h = −M_h⁻¹ J_hᵀ (J_h M_h⁻¹ J_hᵀ)⁺ J_q q̇,
/// so that what a mechanism is free to do by itself stays held, as in a tree. Hinges that are in no loop are held.
class LoopFollowing {
 public:
  /// The model and the equations must outlive the object.
  LoopFollowing(const Model& model, const EquationsOfMotion& equations);
  /// Whether there are loops and elastic coordinates; else the others below say nothing.
  [[nodiscard]] bool any() const { return loops_ != nullptr; }
  /// Goes to a state, y as in State. Allocates where there are loops; in time proportional to the cube of the speeds.
  void update(std::span<const double> y);
  /// Finds the frequencies at the state of the last update; of more than `largest_examined` speeds once only.
  void find_frequencies();
  /// Of a flexible body, as at the last update; null where there are no loops.
  [[nodiscard]] const LoopBound* of(std::size_t body) const { return any() ? &bounds_[body] : nullptr; }
  /// The lowest frequency [rad/s] of the vibrations, loops closed, in which a body has more than a millionth of the
  /// strain energy; 0 where it is not known: without loops, or where a body has motions without stiffness.
  [[nodiscard]] double frequency(std::size_t body) const { return any() ? frequencies_[body] : 0; }
  void remember(Memory& memory) { memory(frequencies_); }

 private:
  void find_followers();
  void find_turns();
  [[nodiscard]] Eigen::MatrixXd mass_of(const std::vector<Eigen::Index>& speeds);

  const Model& model_;
  const EquationsOfMotion& equations_;
  const ClosedLoops* loops_;  ///< null: there are none
  std::unique_ptr<Observation> seen_;
  Work work_;
  std::vector<Eigen::Index> hinges_, elastic_;  ///< speeds that no motion drives
  std::vector<double> y_, unit_, product_;
  Eigen::MatrixXd rows_, follow_, bound_;  ///< J; u_h and what is bound, by elastic speeds
  std::vector<Eigen::Index> following_;    ///< of hinges_: those in loops, the rows of follow_
  std::vector<LoopBound> bounds_;          ///< one a body
  std::vector<double> frequencies_;        ///< one a body
};

}  // namespace withy
