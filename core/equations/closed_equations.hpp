/// \file
/// Equations of motion of a tree whose loops are closed by constraints.
#pragma once

#include <memory>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/equations/pivoted_factors.hpp"
#include "withy/core/equations/work_slices.hpp"
#include "withy/core/kinematics/loop_paths.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"

namespace withy::equations {

/// The tree's equations with multipliers (ClosedLoops): with Z = M⁻¹ Jᵀ by the tree's own factors, one solution in O(n)
/// for each closing equation,
///   u̇ = u̇_tree + Z λ,   J Z λ = −(J u̇_tree + J̇ u),
/// solved in as many rows as are independent. Speeds that motions prescribe keep their accelerations; what that asks of
/// the motions is in their efforts and in the work.
class ClosedEquations final : public EquationsOfMotion, public ClosedLoops {
 public:
  /// \param tree equations of the model's tree in these terms
  /// \throws std::invalid_argument where the formulation's mass matrix is not symmetric.
  ClosedEquations(std::shared_ptr<const Model> model, Terms terms, std::unique_ptr<EquationsOfMotion> tree);

  const Layout& layout() const override { return tree_->layout(); }
  Work make_work() const override { return Work(work_size_); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override;
  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work& work) const noexcept override {
    tree_->load_efforts(t, y, load, efforts, work);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override;
  std::size_t closing_equations() const override { return rows_; }
  void see(std::span<const double> y, std::span<double> gaps, std::span<double> rates, std::span<double> J,
           Work& work) const noexcept override;
  bool right_way_round(std::span<const double> y, std::size_t index, Work& work) const noexcept override;
  Closing close(std::span<double> y, Work& work) const noexcept override;
  bool passes_singularity(std::span<const double> before, std::span<const double> after, std::size_t rank,
                          Work& work) const noexcept override;
  std::vector<LoopCount> counts(std::span<const double> y, Work& work) const override;
  void multipliers(double t, std::span<const double> y, std::span<double> multipliers,
                   Work& work) const noexcept override;
  std::span<const FrameIndex> frames() const noexcept override { return paths_.frames(); }
  void wrenches(std::span<const double> multipliers, std::span<Wrench> wrenches, Work& work) const noexcept override {
    paths_.wrenches(multipliers, wrenches, of_paths_.in(work));
  }
  Wrench reaction(std::size_t index, std::span<const double> multipliers, Work& work) const noexcept override;
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override;
  /// Of the tree: what multipliers bear is among the efforts.
  void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                        Work& work) const override {
    tree_->inverse_dynamics(y, u_dot, efforts, work);
  }
  void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> product,
                  Work& work) const override {
    tree_->mass_times(y, a, product, work);
  }
  Evaluation position_rates(double t, std::span<const double> y, std::span<double> y_dot,
                            Work& work) const noexcept override {
    return tree_->position_rates(t, y, y_dot, work);
  }
  void normalize(std::span<double> y) const noexcept override { tree_->normalize(y); }
  std::unique_ptr<Observation> make_observation() const override { return tree_->make_observation(); }
  std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override;
  /// Of the tree.
  DenseSystem system(double t, std::span<const double> y) const override { return tree_->system(t, y); }
  Energies energies(std::span<const double> y) const override { return tree_->energies(y); }
  WorldPose frame_pose(std::span<const double> y, int body, int frame) const override {
    return tree_->frame_pose(y, body, frame);
  }
  std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const override {
    return tree_->deflection(y, body, frame);
  }
  std::vector<std::string> savings() const override;

 private:
  void lay_out();
  /// Those that the last call of `factorize` has left.
  [[nodiscard]] PivotedFactors factors(Work& work) const noexcept;
  /// Goes to a state: gaps, and the rows of J.
  void find_rows(std::span<const double> y, std::span<double> rows, Work& work) const noexcept;
  /// That with Z and the factors of J Z. The tree's own part of the memory is free after it.
  Evaluation factorize(std::span<const double> y, Work& work) const noexcept;
  /// change += Z λ for λ of J Z λ = −b, which is left in `multipliers_`.
  void answer(std::span<const double> b, std::span<double> change, Work& work) const noexcept;
  bool close_positions(std::span<double> y, Work& work) const noexcept;
  void close_speeds(std::span<double> y, Work& work) const noexcept;
  /// Positions by the change of speeds in `change_`, as if it held for a unit of time.
  void move(std::span<double> y, Work& work) const noexcept;

  std::shared_ptr<const Model> model_;
  Terms terms_;
  std::unique_ptr<EquationsOfMotion> tree_;
  const MassSolver* mass_;  ///< of the tree
  AppliedLoads loads_;      ///< for sensors, and for what loads measure of accelerations
  LoopPaths paths_;
  std::vector<Slot> driven_;  ///< hinges that motions drive
  std::size_t rows_ = 0, speeds_ = 0;
  // Work memory, behind the tree's.
  Region tree_memory_, of_paths_, of_loads_;
  Slice<double> gaps_, rates_, multipliers_, left_;  ///< one a closing equation
  Slice<double> J_, J_after_, Z_, held_;             ///< equations × speeds; held_: M Z − Jᵀ of driven speeds
  Slice<double> A_, L_, other_A_, other_L_;          ///< equations × equations
  Slice<double> change_, on_loads_, on_motions_;     ///< one a speed
  Slice<double> state_, slopes_;                     ///< as y
  Slice<std::size_t> order_, other_order_, rank_;
  std::size_t work_size_ = 0;
};

}  // namespace withy::equations
