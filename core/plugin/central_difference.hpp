/// \file
/// Numerical derivatives, for what plugins do not differentiate themselves.
#pragma once

namespace withy {

/// f′(0) by the central difference of eighth order: f⁽⁹⁾ h⁸/630 of truncation, about 2 ε |f|/h of rounding. f returns a
/// number or an Eigen matrix that owns its elements.
template <class Function>
auto central_difference(Function&& f, double h) {
  auto sum = f(h);
  sum -= f(-h);
  sum *= 0.8;
  const double weights[] = {-0.2, 4.0 / 105.0, -1.0 / 280.0};
  for (int k = 2; k <= 4; ++k) {
    auto pair = f(k * h);
    pair -= f(-k * h);
    pair *= weights[k - 2];
    sum += pair;
  }
  sum /= h;
  return sum;
}

}  // namespace withy
