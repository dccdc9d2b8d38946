/// \file
/// What the rates of a run's own equations differ by from others', along the run.
#pragma once

#include <span>
#include <vector>

#include "withy/study/added_rates.hpp"

namespace withy::study {

/// ẏ = f_beyond(t, y) + d(t): d is f_used − f_beyond at the states that a run in f_used went through, linear in
/// between. Their solution from the start of the run is the run, however stiff f_used is and wherever its mass matrix
/// is singular: d depends on no state but those of the run, and what is solved for is f_beyond.
class CorrectionAlong final : public AddedRates {
 public:
  /// \param states of the run in the order of time; those without a finite difference are passed over
  /// \throws std::invalid_argument where no state is left
  CorrectionAlong(const EquationsOfMotion& beyond, const EquationsOfMotion& used, std::span<const State> states);

 private:
  void add(double t, double factor, std::span<double> sum) const noexcept override;

  std::size_t size_;           ///< of y without the work
  std::vector<double> times_;  ///< [s]
  std::vector<double> d_;      ///< a row a time
};

}  // namespace withy::study
