/// \file
/// The momenta of trees that float freely along a run.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/mass_centre.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// Whether momenta may be conserved: nothing holds the tree in the world, and it has no weight.
bool may_float(const Model& model);

/// Whether loads act on a tree from outside it: on the speeds of its hinges to the world, or by wrenches at frames that
/// do not cancel. What two bodies do to each other does, whatever the equations' partial velocities make of it.
class OutsideLoads {
 public:
  /// \param model must outlive this
  explicit OutsideLoads(const Model& model);
  /// Whether one does at (t, y) as of State. \param seen an observation of y
  bool act(double t, std::span<const double> y, const Observation& seen);

 private:
  [[nodiscard]] bool on_roots(double t, std::span<const double> y);
  [[nodiscard]] bool by_wrenches_of(const LoadNode& node, double t, std::span<const double> y, const Observation& seen);

  const Model& model_;
  std::vector<double> scratch_, efforts_;
  std::vector<FrameMotion> motions_;  ///< of one load's frames
  std::vector<Wrench> wrenches_;
};

/// Watches a run of a model that may float (may_float).
class MomentumWatch {
 public:
  /// \param initial the state of the energies `e`
  MomentumWatch(const Model& model, const EquationsOfMotion& equations, const State& initial, const Energies& e);
  /// To be called where loads may have jumped. \param seen an observation of the state
  void look_at_loads(const State& state, const Observation& seen) {
    if (!pushed_) pushed_ = outside_.act(state.time, state.y, seen);
  }
  /// To be called at each state whose energies are looked at. \param seen the observation that told them
  void look(const State& state, const Energies& e, const Observation& seen);
  /// To be called at the end, after `look`.
  void finish(const State& state, const Energies& e) {
    if (!pushed_) look_about_centre(state, e);
  }
  [[nodiscard]] MomentumDrift drift() const;
  void remember(Memory& memory);

 private:
  void look_about_centre(const State& state, const Energies& e);

  OutsideLoads outside_;
  MassCentre centre_;
  Vector3 linear_, angular_;  ///< at the start, the second about the mass centre
  bool pushed_ = false;       ///< something outside has acted
  std::size_t looks_ = 0;
  double linear_error_ = 0, angular_error_ = 0;
  double relative_ = 0;  ///< greatest kinetic energy of motion relative to the mass centre [J]
  double carried_ = 0;   ///< greatest 2 T Σ m |r − c|², T the same [kg² m⁴/s²]
};

}  // namespace withy
