/// \file
/// The equations of motion of a scene as y' = f(t, y), for integrators of the host's own.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/host/scene.hpp"

namespace withy::host {

/// What came of many states.
struct EvaluatedRows {
  std::size_t rows = 0;   ///< those from the first on whose derivatives are there
  Evaluation evaluation;  ///< of the row after them; ok where all are there
};

/// y holds positions (hinge and modal coordinates [rad, m]), then speeds, then continuous states of loads. An object is
/// of one thread at a time, since it owns the memory of an evaluation; copies share the compiled equations and are of
/// threads of their own.
class Equations {
 public:
  /// \param formulation id of a formulation; empty: the scene's
  /// \throws as Scene::check; study::InputError where a load changes at instants (sampled, or a relay), which only a
  /// Simulation knows.
  explicit Equations(const Scene& scene, const std::string& formulation = {});
  Equations(const Equations& other);
  Equations& operator=(const Equations& other);
  Equations(Equations&&) noexcept;
  Equations& operator=(Equations&&) noexcept;
  ~Equations();

  /// Count of numbers in y.
  [[nodiscard]] std::size_t size() const;
  /// The numbers of y by the names of the result columns.
  [[nodiscard]] const std::vector<Port>& states() const;
  /// The scene's initial state.
  [[nodiscard]] const std::vector<double>& y0() const;
  [[nodiscard]] double t0() const;  ///< [s]

  [[nodiscard]] const std::vector<Port>& inputs() const;
  [[nodiscard]] double input(std::size_t index) const;
  /// Holds for the evaluations from now on. \throws std::out_of_range, std::invalid_argument as Simulation::set_input.
  void set_input(std::size_t index, double value);
  void set_input(std::string_view name, double value);

  /// y' at (t, y). Allocates nothing. Spans of another size than size() are std::invalid_argument.
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot);
  /// y' of many states at one time, row after row of size() numbers each. Where the equations have lanes (symmetric
  /// formulations, hinges of one rate; LaneEquations) four or eight rows are evaluated at once, and a row agrees with
  /// `derivatives` to rounding; elsewhere in every bit. What a row gets depends on that row alone, to the last bit.
  /// Allocates at the first call. Spans that are not rows of size(), or not as many, are std::invalid_argument.
  EvaluatedRows derivatives_many(double t, std::span<const double> y, std::span<double> y_dot);
  /// ∂f/∂y, row after row. Exact, but for parts that loads leave to differences. With respect to a quaternion along its
  /// unit sphere, but for its own rate, which is linear in all four of its components. \throws SimulationStopped where
  /// f is not to be had there; study::InputError where the formulation has no derivatives.
  void jacobian(double t, std::span<const double> y, std::span<double> jacobian);
  /// Scales quaternions in y back to unit length, and closes loops. \throws std::invalid_argument where these have no
  /// closed state near by.
  void normalize(std::span<double> y);
  /// Why an evaluation was not ok, in a sentence.
  [[nodiscard]] std::string reason(double t, const Evaluation& evaluation) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace withy::host
