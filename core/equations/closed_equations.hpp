/// \file
/// Equations of motion of a tree whose loops are closed by constraints.
#pragma once

#include <memory>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/equations/pivoted_factors.hpp"
#include "withy/core/equations/work_slices.hpp"
#include "withy/core/kinematics/loop_paths.hpp"
#include "withy/core/model/hinge_angles.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/plugin/forwarding_equations.hpp"

namespace withy::equations {

/// The tree's equations with multipliers (ClosedLoops): with Z = M⁻¹ Jᵀ by the tree's own factors, one solution in O(n)
/// for each closing equation,
///   u̇ = u̇_tree + Z λ,   J Z λ = −(J u̇_tree + J̇ u),
/// solved in as many rows as are independent. Speeds that motions prescribe keep their accelerations; what that asks of
/// the motions is in their efforts and in the work.
class ClosedEquations final : public ForwardingEquations, public ClosedLoops {
 public:
  /// \param tree equations of the model's tree in these terms
  /// \throws std::invalid_argument where the formulation's mass matrix is not symmetric.
  ClosedEquations(std::shared_ptr<const Model> model, Terms terms, std::unique_ptr<EquationsOfMotion> tree);

  Work make_work() const override { return Work(work_size_); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override;
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override;
  std::size_t closing_equations() const override { return rows_; }
  void see(std::span<const double> y, std::span<double> gaps, std::span<double> rates, std::span<double> J,
           Work& work) const noexcept override;
  void see_turns(std::span<const double> y, std::span<double> gaps, std::span<double> J,
                 Work& work) const noexcept override;
  bool right_way_round(std::span<const double> y, std::size_t index, Work& work) const noexcept override;
  Closing close(std::span<double> y, Work& work) const noexcept override;
  bool keeps_rank(std::span<const double> before, std::span<const double> after, const LoopRank& rank,
                  Work& work) const noexcept override;
  double turned(std::span<const double> before, std::span<const double> after, double seconds) const noexcept override {
    return angles_.turned(before, after, seconds);
  }
  LoopRank rank_at(std::span<const double> y, Work& work) const override;
  std::vector<LoopCount> counts(std::span<const double> y, Work& work) const override;
  void multipliers(double t, std::span<const double> y, std::span<double> multipliers,
                   Work& work) const noexcept override;
  std::span<const FrameIndex> frames() const noexcept override { return paths_.frames(); }
  void wrenches(std::span<const double> multipliers, std::span<Wrench> wrenches, Work& work) const noexcept override {
    paths_.wrenches(multipliers, wrenches, of_paths_.in(work));
  }
  Wrench reaction(std::size_t index, std::span<const double> multipliers, Work& work) const noexcept override;
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override;
  // Inverse dynamics, M a and the dense system are those of the tree: what multipliers bear is among the efforts.
  /// None: the tree's know nothing of multipliers.
  const LinearlyImplicit* linearly_implicit() const override { return nullptr; }
  const Linearization* linearization() const override { return nullptr; }
  std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override;
  std::vector<std::string> savings() const override;

 private:
  const EquationsOfMotion& own() const noexcept override { return *tree_; }
  void lay_out();
  /// Those that the last call of `factorize` has left.
  [[nodiscard]] PivotedFactors factors(Work& work) const noexcept;
  /// Goes to a state: gaps, and the rows of J. A row that moves nothing but by rounding, as all do of a door's second
  /// hinge on the axis of the first, is zero: among none but such rows rounding would count for rank.
  void find_rows(std::span<const double> y, std::span<double> rows, Work& work,
                 LoopPaths::Held held = LoopPaths::Held::equations) const noexcept;
  /// keeps_rank of the rows in `work`.
  bool keeps_rank_by_mass(std::size_t rank, Work& work) const noexcept;
  bool keeps_rank_by_columns(std::size_t rank, Work& work) const noexcept;
  /// LoopRank::distinct at the state that `factorize` went to last. What it has left of factors goes.
  std::size_t distinct_rows(std::span<const double> sizes, Work& work) const noexcept;
  /// That with Z and the factors of J Z. The tree's own part of the memory is free after it.
  Evaluation factorize(std::span<const double> y, Work& work) const noexcept;
  /// change += Z λ for λ of J Z λ = −b, which is left in `multipliers_`.
  void answer(std::span<const double> b, std::span<double> change, Work& work) const noexcept;
  /// Of all multipliers that give the same accelerations as those in `multipliers_`, by the factors, the least.
  void find_least(Work& work) const noexcept;
  void close_positions(std::span<double> y, Closing& closing, Work& work) const noexcept;
  void close_speeds(std::span<double> y, Work& work) const noexcept;
  /// Positions by the change of speeds in `change_`, as if it held for a unit of time.
  void move(std::span<double> y, Work& work) const noexcept;

  std::shared_ptr<const Model> model_;
  Terms terms_;
  std::unique_ptr<EquationsOfMotion> tree_;
  const MassSolver* mass_;  ///< of the tree
  AppliedLoads loads_;      ///< for sensors, and for what loads measure of accelerations
  LoopPaths paths_;
  HingeAngles angles_;
  std::vector<bool> in_loops_;   ///< speeds
  std::vector<double> reaches_;  ///< reaches_of_speeds; of speeds that motions prescribe zero
  std::vector<Slot> driven_;     ///< hinges that motions drive
  std::size_t rows_ = 0, speeds_ = 0;
  // Work memory, behind the tree's.
  Region of_paths_, of_loads_;
  Slice<double> gaps_, rates_, multipliers_, left_;  ///< one a closing equation
  Slice<double> J_, J_after_, Z_, held_;             ///< equations × speeds; held_: M Z − Jᵀ of driven speeds
  Slice<double> A_, L_, other_A_, other_L_;          ///< equations × equations
  Slice<double> change_, on_loads_, on_motions_;     ///< one a speed
  Slice<double> state_, slopes_;                     ///< as y
  Slice<std::size_t> order_, other_order_, rank_;
  std::size_t work_size_ = 0;
};

}  // namespace withy::equations
