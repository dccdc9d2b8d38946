/// \file
/// Steppers whose steps the user gives.
#pragma once

namespace withy {

/// A Stepper may be this too (dynamic_cast): its steps are as long as it was told, and no estimate of an error makes
/// them shorter. Nothing cuts them but what has to end on a time.
class GivenSteps {
 public:
  virtual ~GivenSteps() = default;
  struct WorkGap {
    double work = 0;  ///< [J]
    double time = 0;  ///< end of that step [s]
    double step = 0;  ///< its length [s]
  };
  /// Of a method that keeps a balance of energy by construction, and so too where its steps are too long for what acts:
  /// the greatest difference between the work over a step as it has it and as Simpson's rule has it from the powers at
  /// the ends and in the middle. Zero of others, whose energy tells.
  [[nodiscard]] virtual WorkGap greatest_gap() const { return {}; }
};

}  // namespace withy
