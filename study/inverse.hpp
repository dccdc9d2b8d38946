/// \file
/// Inverse dynamics: what the motors of driven hinges would have to give.
#pragma once

#include <string>
#include <vector>

#include "withy/study/run.hpp"

namespace withy::study {

/// The effort on one driven speed over the outputs of a run.
struct Drive {
  std::string name;  ///< of the speed
  std::string unit;  ///< of the effort: "N m" or "N"
  std::size_t speed = 0;
  std::vector<double> effort;  ///< [N m, N]
  std::vector<double> rate;    ///< [rad/s, m/s]
};

/// What a motor would have to give.
struct Demand {
  double peak = 0, peak_time = 0;  ///< effort of greatest size, with its sign [N m, N]; [s]
  double rms = 0;                  ///< [N m, N]
  double peak_power = 0;           ///< [W] of greatest size, with its sign
  double work = 0;                 ///< [J]
};

/// The drives of a scene, filled from the outputs of a run.
class InverseStudy {
 public:
  /// `prepared` must outlive it. \throws InputError where no hinge is driven.
  explicit InverseStudy(const Prepared& prepared);
  void enter(const State& state);
  /// Of a run that enters its outputs here. Accelerations of the next model up tell nothing of efforts: it is not
  /// looked at. The settings refer to this.
  [[nodiscard]] RunSettings run_settings(Control control);

  [[nodiscard]] const std::vector<Drive>& drives() const { return drives_; }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }  ///< [s]
  /// Integrals by the trapezoidal rule over the outputs.
  [[nodiscard]] Demand demand(const Drive& drive) const;

 private:
  const Prepared& prepared_;
  std::vector<Drive> drives_;
  std::vector<double> times_;
  Work work_;
  std::vector<double> efforts_;
};

}  // namespace withy::study
