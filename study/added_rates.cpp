#include "withy/study/added_rates.hpp"

#include <algorithm>

namespace withy::study {

Evaluation AddedRates::derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                                   Work& work) const noexcept {
  const Evaluation e = f_.derivatives(t, y, y_dot, work);
  add(t, 1, y_dot);
  return e;
}

Evaluation AddedRates::implicit_derivatives(double t, std::span<const double> y, std::span<const double> base,
                                            double delta, std::span<double> y_dot, Work& work) const noexcept {
  std::copy(base.begin(), base.end(), base_.begin());
  add(t, delta, base_);
  const Evaluation e = implicit_->implicit_derivatives(t, y, base_, delta, y_dot, work);
  add(t, 1, y_dot);
  return e;
}

}  // namespace withy::study
