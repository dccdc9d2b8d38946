/// \file
/// What a controller is inside: a system from signals to efforts, with or without states.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace withy {

class ForeignLaw;

/// ż = g(t, w, z), v = h(t, w, z): w what is measured, v what is commanded. Immutable.
class ControlBlock {
 public:
  /// Derivatives at a point; shapes: states or outputs × inputs or states.
  struct Slopes {
    Eigen::MatrixXd rate_by_input, rate_by_state, output_by_input, output_by_state;
  };

  virtual ~ControlBlock() = default;
  [[nodiscard]] virtual std::size_t inputs() const = 0;
  [[nodiscard]] virtual std::size_t outputs() const { return 1; }
  /// Names of the states z.
  [[nodiscard]] virtual std::vector<std::string> states() const { return {}; }
  /// Sets z where the block begins to run.
  virtual void begin(double /*t*/, std::span<const double> /*w*/, std::span<double> z) const noexcept {
    for (double& x : z) x = 0;
  }
  virtual void rates(double /*t*/, std::span<const double> /*w*/, std::span<const double> /*z*/,
                     std::span<double> /*rates*/) const noexcept {}
  virtual void output(double t, std::span<const double> w, std::span<const double> z,
                      std::span<double> v) const noexcept = 0;
  /// A number that outputs show of it. In units the words "command" and "signal" stand for those of what it commands
  /// and of what it measures.
  struct Shown {
    std::string name, unit;
  };
  /// What it tells beside commands and states.
  [[nodiscard]] virtual std::vector<Shown> shown() const { return {}; }
  /// Sets one number for each of `shown`, of which `finish` makes what is shown. One that is sampled keeps them from
  /// sample to sample among what it holds, which small motions are about: there they are smooth in w and z.
  virtual void tell(double /*t*/, std::span<const double> /*w*/, std::span<const double> /*z*/,
                    std::span<double> /*values*/) const noexcept {}
  /// Makes a margin of what is asked for, where `tell` sets that.
  virtual void finish(std::span<double> /*values*/) const noexcept {}
  /// As those of Shown; of a command that acts nowhere.
  [[nodiscard]] virtual std::string unit_of_output() const { return "1"; }
  [[nodiscard]] virtual std::string unit_of_state(std::size_t /*state*/) const { return "1"; }
  /// Whether v depends on an input at once, not through z alone.
  [[nodiscard]] virtual bool feeds_through(std::size_t /*input*/) const { return true; }
  /// Whether v moves in steps, so that it has no derivative by w.
  [[nodiscard]] virtual bool gives_steps() const { return false; }
  /// Whether numbers are drawn for v.
  [[nodiscard]] virtual bool draws() const { return false; }
  /// Whether v by w and z depends on t: how much a gain is changes as time goes on.
  [[nodiscard]] virtual bool changes_gain() const { return false; }
  /// Takes z from t [s] to a sample later, w held at what it is at t.
  virtual void advance(double /*t*/, std::span<const double> /*w*/, std::span<double> /*z*/) const noexcept {}
  /// A sample at t [s]: `output`, then `advance`.
  virtual void sample(double t, std::span<const double> w, std::span<double> z, std::span<double> v) const noexcept {
    output(t, w, z, v);
    advance(t, w, z);
  }
  /// Count of numbers behind the states that a sampled one remembers and nobody looks at.
  [[nodiscard]] virtual std::size_t memory() const { return 0; }
  /// What it is where its law is not the engine's own, of the block's numbers; null: it is.
  [[nodiscard]] virtual const ForeignLaw* foreign() const { return nullptr; }
  /// Tells it of the period [s] of `advance`, before it is shared.
  virtual void set_sample(double /*period*/) {}
  /// Sets the derivatives, of the right shapes and zero before. False where it leaves them to differences.
  virtual bool slopes(double /*t*/, std::span<const double> /*w*/, std::span<const double> /*z*/,
                      Slopes& /*slopes*/) const {
    return false;
  }
  /// As BoundLoad's.
  [[nodiscard]] virtual std::vector<double> discontinuities() const { return {}; }
  [[nodiscard]] virtual double end() const { return 0; }
};

}  // namespace withy
