/// \file
/// Whole steps of explicit Runge–Kutta methods, for equations that make the stages of several cases at once.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Coefficients of an explicit method: stage i is the slope at y + h Σ_j a[i][j] k_j and t + c[i] h. The first is the
/// slope at the start; the argument of the last is the state at the end of the step.
struct StageTable {
  static constexpr std::size_t most = 7;  ///< stages
  std::size_t stages = 0;
  std::array<double, most> c{};
  std::array<std::array<double, most>, most> a{};  ///< below the diagonal
};

/// What EquationsOfMotion are as well that take a whole step at a time. Their states need no normalizing.
class StagedSteps {
 public:
  virtual ~StagedSteps() = default;
  /// A step of length h [s] from y at t [s], where the slope is `slope`.
  struct Step {
    const StageTable* table = nullptr;  ///< of static life: equal methods have one
    double t = 0, h = 0;
    double latest = 0;  ///< [s]: stages behind it are evaluated there
    std::span<const double> y, slope;
    std::span<const std::span<double>> slopes;  ///< takes those of the stages after the first; empty: not wanted
    std::span<double> end;                      ///< takes the state at the end
    Work* work = nullptr;  ///< holds afterwards what `derivatives` would leave there of the last stage
    /// Ends [s] of this step, t + h but for rounding, and of those that are asked for after it where each is accepted:
    /// they may be made at once. Empty: nobody knows.
    std::span<const double> ends = {};
    /// y and slope are what the last step asked for has given, and it ended at t.
    bool follows = false;
  };
  struct Outcome {
    Evaluation evaluation;  ///< of the last stage, or of the first that was not ok
    std::size_t evaluations = 0;
  };
  /// Makes all stages but the first; where one is not ok, what the step takes is meaningless. Allocates nothing.
  virtual Outcome stages(const Step& step) const noexcept = 0;
};

}  // namespace withy
