#include "withy/campaign/distribution.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace withy::campaign {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of the logarithm of a lognormal value.
struct Logarithm {
  double mean, deviation;
  explicit Logarithm(const Distribution& d)
      : mean(0), deviation(std::sqrt(std::log1p(d.deviation / d.mean * (d.deviation / d.mean)))) {
    mean = std::log(d.mean) - 0.5 * deviation * deviation;
  }
};

/// Standard normal values between which the value lies.
struct Cut {
  double low, high;
};
Cut cut_of(const Distribution& d) {
  Cut cut{-infinity, infinity};
  if (d.kind == Distribution::Kind::lognormal) {
    const Logarithm log(d);
    if (d.from && *d.from > 0) cut.low = (std::log(*d.from) - log.mean) / log.deviation;
    if (d.to) cut.high = (std::log(*d.to) - log.mean) / log.deviation;
  } else {
    if (d.from) cut.low = (*d.from - d.mean) / d.deviation;
    if (d.to) cut.high = (*d.to - d.mean) / d.deviation;
  }
  return cut;
}

/// A standard normal value between two others. Above the mean the tail is measured from its end, where it has digits.
double cut_normal(const Cut& cut, double u) {
  if (cut.low > 0) return -cut_normal({-cut.high, -cut.low}, 1 - u);
  const double below = normal_share(cut.low);
  return std::clamp(normal_quantile(below + u * (normal_share(cut.high) - below)), cut.low, cut.high);
}

}  // namespace

double normal_quantile(double u) {
  u = std::clamp(u, std::numeric_limits<double>::min(), 1 - 0.5 * std::numeric_limits<double>::epsilon());
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * u);
}
double normal_share(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double Distribution::quantile(double u) const {
  if (kind == Kind::uniform) return std::clamp(*from + u * (*to - *from), *from, *to);
  const double z = from || to ? cut_normal(cut_of(*this), u) : normal_quantile(u);
  double value = mean + deviation * z;
  if (kind == Kind::lognormal) {
    const Logarithm log(*this);
    value = std::exp(log.mean + log.deviation * z);
  }
  return std::clamp(value, from.value_or(-infinity), to.value_or(infinity));
}

std::string Distribution::problem() const {
  if (from && to && !(*from < *to)) return "'from' is not below 'to'";
  if (kind == Kind::uniform) return std::isfinite(*to - *from) ? "" : "its ends are too far apart";
  if (!(deviation > 0)) return "need a deviation above 0";
  if (kind == Kind::lognormal) {
    if (!(mean > 0)) return "a lognormal value needs a mean above 0";
    if (to && !(*to > 0)) return "a lognormal value is above 0: so must 'to' be";
  }
  const Cut cut = cut_of(*this);
  const double share =
      cut.low > 0 ? normal_share(-cut.low) - normal_share(-cut.high) : normal_share(cut.high) - normal_share(cut.low);
  return share > 1e-12 ? "" : "nothing of it lies between 'from' and 'to'";
}

}  // namespace withy::campaign
