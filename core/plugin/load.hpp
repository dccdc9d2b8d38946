/// \file
/// The interface of loads.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace withy {

class Model;
struct State;

/// A load fixed to one model: it knows which generalized speeds it acts on. Immutable; scratch space is the caller's.
class BoundLoad {
 public:
  virtual ~BoundLoad() = default;
  /// Doubles of scratch space that `add` needs; their content does not matter before or after a call.
  [[nodiscard]] virtual std::size_t scratch() const = 0;
  /// Adds the load's generalized efforts [N m, N] at time t [s] to `efforts`, one for each generalized speed.
  /// `positions` and `speeds` are those of State.
  virtual void add(double t, std::span<const double> positions, std::span<const double> speeds,
                   std::span<double> efforts, std::span<double> scratch) const noexcept = 0;
  /// Adds the derivatives of the efforts that `add` gives: `by_position(i, j)` of effort i with respect to a
  /// displacement along speed j (position changes as if that speed alone were one), `by_speed(i, j)` to speed j. For
  /// analyses: may allocate. \returns false, adding nothing, where the load has none; it is then differentiated
  /// numerically.
  virtual bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                               Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                               Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const {
    return false;
  }
  /// Times [s], increasing, where the effort or one of its first derivatives jumps: integrators land on them.
  [[nodiscard]] virtual std::vector<double> discontinuities() const = 0;
  /// Time [s] at which the load has done its work (a slew's end); 0 where it has no end of its own.
  [[nodiscard]] virtual double end() const = 0;
  /// Sets the hinge coordinates where the load wants the motion to begin (a slew starts at its `from`).
  virtual void begin(State& state) const = 0;
};

/// A load as the scene states it.
class Load {
 public:
  virtual ~Load() = default;
  /// \throws std::invalid_argument where the load does not fit the model; the text says why.
  [[nodiscard]] virtual std::unique_ptr<BoundLoad> bind(const Model& model) const = 0;
};

}  // namespace withy
