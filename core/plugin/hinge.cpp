#include "withy/core/plugin/hinge.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "withy/core/plugin/refined_difference.hpp"

namespace withy {

void Hinge::motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                              HingeMotion& out) const {
  const auto n = static_cast<Eigen::Index>(speeds());
  std::vector<double> direction(coordinates()), displaced(coordinates()), unit(speeds(), 0.0);
  unit[along] = 1;
  derivatives(x, unit, direction);
  double place = 0;
  for (const double number : x) place = std::max(place, std::abs(number));
  const Eigen::Matrix<double, 6, Eigen::Dynamic> both = refined_difference(
      [&](double h) -> Eigen::Matrix<double, 6, Eigen::Dynamic> {
        for (std::size_t i = 0; i < displaced.size(); ++i) displaced[i] = x[i] + h * direction[i];
        normalize(displaced);
        HingeMotion m;
        m.H.resize(6, n);
        motion(displaced, rates, m);
        Eigen::Matrix<double, 6, Eigen::Dynamic> values(6, n + 1);
        values << m.H, m.bias;
        return values;
      },
      0.02, place);
  out.H = both.leftCols(n);
  out.bias = both.col(n);
}

}  // namespace withy
