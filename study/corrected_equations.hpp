/// \file
/// A cheap formulation with the accelerations of a dearer one, found once a step: what coarse references are made in.
#pragma once

#include <vector>

#include "withy/core/simulation/rungs.hpp"
#include "withy/study/added_rates.hpp"

namespace withy::study {

/// ẏ = f_low(t, y) + d(t): d is f_high − f_low at the ends of accepted steps, where `sample` takes it, and goes on
/// beyond the last of them as it went between the last two, for as long as that took. A step so costs an evaluation of
/// each more than one in `low`, where a step in `high` may be ten times as dear. What the extrapolation is off by is
/// small against d where steps resolve what moves; so the run is a good reference where d does little.
class CorrectedEquations final : public AddedRates {
 public:
  /// \param rungs of one model, a tree; they must outlive it. With low = high they are the equations of that rung.
  CorrectedEquations(const std::vector<Rung>& rungs, std::size_t low, std::size_t high);

  /// Forgets what was sampled, and samples.
  void begin(const State& state);
  /// Takes the difference at the end of a step. Where it cannot be found, what was known stays.
  void sample(const State& state);

  [[nodiscard]] std::size_t low() const { return low_; }
  [[nodiscard]] std::size_t high() const { return high_; }
  /// What an integrator is to be given: these, or the rung's own where low = high.
  [[nodiscard]] const EquationsOfMotion& faces() const {
    return low_ == high_ ? cheap_ : static_cast<const EquationsOfMotion&>(*this);
  }
  /// Evaluations made by samples, of each of the two.
  [[nodiscard]] std::size_t samples() const { return samples_; }

 private:
  void add(double t, double factor, std::span<double> sum) const noexcept override;
  /// How far d goes on at a time, over what it changed by between the last two samples.
  [[nodiscard]] double ahead(double t) const noexcept;

  std::size_t low_, high_;
  const EquationsOfMotion& cheap_;
  const EquationsOfMotion& dear_;
  Work cheap_work_, dear_work_;
  double time_ = 0, span_ = 0;         ///< of the last sample [s]; from the one before to it, 0: there is none
  std::vector<double> last_, change_;  ///< d there, and since the one before; of all elements of y but the work
  std::vector<double> f_, g_;
  std::size_t samples_ = 0;
};

}  // namespace withy::study
