/// \file
/// The momenta of trees that float freely along a run.
#pragma once

#include <memory>
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
  /// Both must outlive this.
  OutsideLoads(const Model& model, const EquationsOfMotion& equations);
  /// Whether one does at (t, y) as of State.
  bool act(double t, std::span<const double> y);

 private:
  [[nodiscard]] bool on_roots(double t, std::span<const double> y);
  [[nodiscard]] bool by_wrenches(double t, std::span<const double> y);
  [[nodiscard]] bool by_wrenches_of(const LoadNode& node, double t, std::span<const double> y);

  const Model& model_;
  std::unique_ptr<Observation> seen_;  ///< null where no load acts at a frame
  std::vector<double> scratch_, efforts_;
  std::vector<FrameMotion> motions_;  ///< of one load's frames
  std::vector<Wrench> wrenches_;
};

/// Watches a run of a model that may float (may_float).
class MomentumWatch {
 public:
  /// \param initial the state of the energies `e`
  MomentumWatch(const Model& model, const EquationsOfMotion& equations, const State& initial, const Energies& e);
  /// To be called at each accepted state, and where loads may have jumped.
  void look_at_loads(const State& state);
  /// To be called at each state whose energies are looked at.
  void look(const State& state, const Energies& e);
  [[nodiscard]] MomentumDrift drift() const;
  void remember(Memory& memory);

 private:
  OutsideLoads outside_;
  MassCentre centre_;
  Vector3 linear_, angular_;  ///< at the start, the second about the mass centre
  bool pushed_ = false;       ///< something outside has acted
  double linear_error_ = 0, angular_error_ = 0;
  double relative_ = 0;  ///< greatest kinetic energy of motion relative to the mass centre [J]
  double carried_ = 0;   ///< greatest 2 T Σ m |r − c|², T the same [kg² m⁴/s²]
};

}  // namespace withy
