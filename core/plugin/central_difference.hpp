/// \file
/// Numerical derivatives, for what plugins do not differentiate themselves.
#pragma once

namespace withy {

/// f′(0) by the central difference of eighth order: f⁽⁹⁾ h⁸/630 of truncation, about 2 ε |f|/h of rounding. f returns a
/// number or an Eigen matrix that owns its elements. The quotients over h, 2h, 3h and 4h are put together by what they
/// differ by: of what is linear, and exact at these places, there is no rounding.
template <class Function>
auto central_difference(Function&& f, double h) {
  const auto quotient = [&](int k) {
    auto pair = f(k * h);
    pair -= f(-k * h);
    pair /= 2 * k * h;
    return pair;
  };
  const auto first = quotient(1);
  auto slope = first;
  const double weights[] = {-0.8, 8.0 / 35.0, -1.0 / 35.0};
  for (int k = 2; k <= 4; ++k) {
    auto apart = quotient(k);
    apart -= first;
    apart *= weights[k - 2];
    slope += apart;
  }
  return slope;
}

}  // namespace withy
