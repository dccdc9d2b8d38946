/// \file
/// What keeps the loops of closed equations of motion closed: integrators ask for it after each step.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/load.hpp"

namespace withy {

/// How far apart the frames of loops are: gaps of positions [m], and of directions times the length of the largest body
/// [m]; greatest over all equations.
struct Closing {
  bool closed = true;  ///< false: Newton's method finds no closed state near by, and y is as it was
  double gap = 0;      ///< before it was closed
  /// Closed but for more than rounding, which no change of free coordinates takes away: motions part the frames. From
  /// here no step, however small, leads to a closed state.
  bool apart = false;
};

/// The equations of one loop.
struct LoopCount {
  std::string name;
  std::size_t equations = 0;
  std::size_t independent = 0;  ///< of those of the loops before, and of each other
};

/// Of the closing equations at the state where a run begins.
struct LoopRank {
  std::size_t independent = 0;
  std::vector<double> sizes;  ///< of the rows of J, one an equation
  std::size_t distinct = 0;   ///< rows that, over their sizes, keep more than a millionth beside the others
};

/// With g(x) the gaps of all loops and J = ∂g/∂x N the map from speeds to their rates, equations of motion of closed
/// loops are
///   M u̇ = f + Jᵀ λ,   J u̇ + J̇ u = 0.
class ClosedLoops {
 public:
  virtual ~ClosedLoops() = default;
  /// Of closing equations, in all loops.
  [[nodiscard]] virtual std::size_t closing_equations() const = 0;
  /// Sets g [m], J u [m/s] and J (equations × speeds, row-major) at a state.
  virtual void see(std::span<const double> y, std::span<double> gaps, std::span<double> rates, std::span<double> J,
                   Work& work) const noexcept = 0;
  /// Whether loop `index` is closed as its hinge is, not at another pose that solves the same equations.
  [[nodiscard]] virtual bool right_way_round(std::span<const double> y, std::size_t index,
                                             Work& work) const noexcept = 0;
  /// Scales quaternions to unit length, then moves positions to g = 0 and speeds to J u = 0 by the smallest changes in
  /// the sense of M; what motions prescribe stays. Allocates nothing.
  /// \param work of EquationsOfMotion::make_work
  virtual Closing close(std::span<double> y, Work& work) const noexcept = 0;
  /// Whether the equations surely keep their rank on the straight way from one closed state to the next: with rows J₁
  /// and J₂ of the two and a positive W the symmetric part of J₁ W J₂ᵀ is positive, for W = M⁻¹ or for one that scales
  /// the columns. Where rank is lost in between it is for none: J(s)ᵀ v = 0 there makes J₂ᵀ v a negative multiple of
  /// J₁ᵀ v. Else states nearer to each other tell.
  /// False too where fewer rows than at the start are told from a loss of rank: within the root of the gap that is left
  /// of where ways fork no state is known to be on one of them, and short steps slide from one to the other.
  [[nodiscard]] virtual bool keeps_rank(std::span<const double> before, std::span<const double> after,
                                        const LoopRank& rank, Work& work) const noexcept = 0;
  /// The greatest angle by which a hinge that changes rows of J turns from one state to the next, `seconds` later
  /// [rad]: by its coordinates, or its rates where these say more, as of a spherical hinge. keeps_rank says nothing of
  /// ways on which it is some radians, for rows that come round again are the same.
  [[nodiscard]] virtual double turned(std::span<const double> /*before*/, std::span<const double> /*after*/,
                                      double /*seconds*/) const noexcept {
    return 0;
  }
  /// Equations of each loop at a state, counted by the rank of J M⁻¹ Jᵀ; speeds that motions prescribe are not free.
  [[nodiscard]] virtual std::vector<LoopCount> counts(std::span<const double> y, Work& work) const = 0;
  /// Multipliers λ at (t, y) [N], one an equation: where equations depend on each other, of all that give the same
  /// accelerations those of least Σ λ². Zero where there are no accelerations.
  virtual void multipliers(double t, std::span<const double> y, std::span<double> multipliers,
                           Work& work) const noexcept = 0;
  /// Frames that loops act on, and the wrench at each for multipliers, at the state of the last call with this memory:
  /// about its origin, world axes.
  [[nodiscard]] virtual std::span<const FrameIndex> frames() const noexcept = 0;
  virtual void wrenches(std::span<const double> multipliers, std::span<Wrench> wrenches, Work& work) const noexcept = 0;
  /// What loop `index` exerts then on the body of its frame b: about the origin of b, in the axes of F on a.
  [[nodiscard]] virtual Wrench reaction(std::size_t index, std::span<const double> multipliers,
                                        Work& work) const noexcept = 0;
  /// What keeps_rank goes by, at the state where a run begins.
  [[nodiscard]] virtual LoopRank rank_at(std::span<const double> y, Work& work) const = 0;
  /// `see` without rates, where the gaps of a hinge that holds all three directions are ℓ times the turn that is left
  /// to its pose, and those of one that holds an axis are ℓ times the shortest turn that brings it there. That has no
  /// zero elsewhere, as the equations have, and J leads the shortest way to it.
  virtual void see_turns(std::span<const double> y, std::span<double> gaps, std::span<double> J,
                         Work& work) const noexcept = 0;
};

/// A SensedState of closed loops may be this too (dynamic_cast).
class SensedLoops {
 public:
  virtual ~SensedLoops() = default;
  /// ClosedLoops::reaction at the state.
  [[nodiscard]] virtual Wrench closing_reaction(std::size_t loop) noexcept = 0;
};

/// What closing loops has changed in a run.
struct ClosingRecord {
  double gap = 0;     ///< greatest gap at the end of a step, before it was closed there, as Closing::gap [m]
  double energy = 0;  ///< that closing has added in all [J]
};

/// Steppers that close loops at the end of each of their steps may be this too (dynamic_cast).
class ClosingStepper {
 public:
  virtual ~ClosingStepper() = default;
  /// Of all accepted steps.
  [[nodiscard]] virtual const ClosingRecord& closing_record() const = 0;
};

/// \throws std::invalid_argument saying why an integrator cannot keep loops closed.
[[noreturn]] inline void refuse_loops(const std::string& integrator, const std::string& why) {
  throw std::invalid_argument("integrator '" + integrator + "' cannot run closed loops (constraints): " + why +
                              ". Use dopri5, dop853, rk4, rk4-adaptive, gauss or radau");
}

}  // namespace withy
