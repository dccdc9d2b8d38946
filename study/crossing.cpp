#include "withy/study/crossing.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

namespace withy::study {

Crossing find_crossing(const std::function<double(double)>& error, const std::vector<double>& values, double limit,
                       double accuracy) {
  // Errors grow by powers and end in failure: their logarithm, cut where it says enough, is what the solver likes.
  const auto above = [&](double e) { return std::isnan(e) ? 7.0 : std::clamp(std::log(e / limit), -7.0, 7.0); };
  double from = values.front(), at_from = error(from);
  if (!(at_from <= limit)) return {Crossing::Kind::exceeds, from, !std::isfinite(at_from)};
  double greatest = 0;
  for (const double v : values) greatest = std::max(greatest, std::abs(v));
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double at_to = error(values[k]);
    if (at_to <= limit) {
      from = values[k];
      at_from = at_to;
      continue;
    }
    double failing = std::isfinite(at_to) ? INFINITY : values[k];  // nearest value known to fail
    const auto f = [&](double v) {
      const double e = error(v);
      if (!std::isfinite(e) && std::abs(v - from) < std::abs(failing - from)) failing = v;
      return above(e);
    };
    const double width = accuracy * greatest;
    std::uintmax_t most = 60;
    const bool rising = from < values[k];
    const auto [a, b] = boost::math::tools::toms748_solve(
        f, rising ? from : values[k], rising ? values[k] : from, rising ? above(at_from) : above(at_to),
        rising ? above(at_to) : above(at_from), [&](double x, double y) { return std::abs(y - x) <= width; }, most);
    const double below = rising ? a : b, beyond = rising ? b : a;
    return {Crossing::Kind::passes, 0.5 * (below + beyond), std::abs(failing - beyond) <= width};
  }
  return {};
}

}  // namespace withy::study
