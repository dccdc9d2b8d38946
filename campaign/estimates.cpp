#include "withy/campaign/estimates.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

namespace withy::campaign {
namespace {

constexpr double tail = 0.025;
constexpr double normal_half_width = 1.959963984540054;
constexpr double unknown = std::numeric_limits<double>::infinity();  ///< of an end of an interval

struct Moments {
  double mean = 0, deviation = 0;
};
Moments moments(std::span<const double> sample) {
  const double n = static_cast<double>(sample.size());
  Moments m;
  m.mean = std::accumulate(sample.begin(), sample.end(), 0.0) / n;
  double squares = 0;
  for (const double x : sample) squares += (x - m.mean) * (x - m.mean);
  m.deviation = sample.size() > 1 ? std::sqrt(squares / (n - 1)) : 0;
  return m;
}

Estimate mean_of(std::span<const double> sample) {
  const Moments m = moments(sample);
  if (sample.size() < 2) return {m.mean, -unknown, unknown};
  const double n = static_cast<double>(sample.size());
  const double half =
      boost::math::quantile(boost::math::complement(boost::math::students_t(n - 1), tail)) * m.deviation / std::sqrt(n);
  return {m.mean, m.mean - half, m.mean + half};
}

/// A sample as if it were sorted: the few places that are asked for are found one by one, which takes a part of the
/// time that sorting all of it does.
class Sorted {
 public:
  explicit Sorted(std::vector<double> sample) : sample_(std::move(sample)) {}
  [[nodiscard]] std::size_t size() const { return sample_.size(); }
  /// The number that as many are below as the place says.
  double operator[](std::size_t place) {
    const auto above = found_.lower_bound(place);
    if (above != found_.end() && *above == place) return sample_[place];
    const auto at = [this](std::size_t i) { return sample_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(above == found_.begin() ? sample_.begin() : at(*std::prev(above) + 1), at(place),
                     above == found_.end() ? sample_.end() : at(*above));
    found_.insert(place);
    return sample_[place];
  }

 private:
  std::vector<double> sample_;
  /// Places that have their number: what is less stands before it, what is greater behind.
  std::set<std::size_t> found_;
};

/// The number below which a share of a sample lies, between its order statistics.
double quantile_of(Sorted& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double low = sorted[below], high = sorted[std::min(below + 1, sorted.size() - 1)];
  return low + (place - static_cast<double>(below)) * (high - low);
}

Estimate quantile_estimate(Sorted& sorted, double p) {
  const double n = static_cast<double>(sorted.size());
  using Up =
      boost::math::policies::policy<boost::math::policies::discrete_quantile<boost::math::policies::integer_round_up>>;
  const boost::math::binomial_distribution<double, Up> below(n, p);
  const double low = boost::math::quantile(below, tail);
  const double high = boost::math::quantile(boost::math::complement(below, tail));
  return {quantile_of(sorted, p), low >= 1 ? sorted[static_cast<std::size_t>(low - 1)] : -unknown,
          high < n ? sorted[static_cast<std::size_t>(high)] : unknown};
}

/// a/b of the means of two columns; the deviation of the ratio is that of its linearization (a_j − r b_j)/b.
Estimate ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const double denominator = moments(b).mean;
  if (!(denominator > 0)) return {};
  const double r = moments(a).mean / denominator;
  if (a.size() < 2) return {r, -unknown, unknown};
  std::vector<double> influence;
  for (std::size_t j = 0; j < a.size(); ++j) influence.push_back((a[j] - r * b[j]) / denominator);
  const double half = normal_half_width * moments(influence).deviation / std::sqrt(static_cast<double>(a.size()));
  return {r, r - half, r + half};
}

}  // namespace

Statistics statistics(std::vector<double> sample) {
  Statistics s;
  s.count = sample.size();
  const Moments m = moments(sample);
  s.mean = m.mean;
  s.deviation = m.deviation;
  if (sample.size() > 1) s.mean_interval = mean_of(sample);
  Sorted sorted(std::move(sample));
  for (const double p : shares_of_quantiles) s.quantiles.push_back(quantile_estimate(sorted, p));
  s.least = sorted[0];
  s.greatest = sorted[s.count - 1];
  return s;
}

std::vector<double> percentiles(std::vector<double> sample, std::span<const double> shares) {
  Sorted sorted(std::move(sample));
  std::vector<double> all;
  for (const double p : shares) all.push_back(quantile_of(sorted, p));
  return all;
}

Estimate share(std::size_t hits, std::size_t count) {
  using Binomial = boost::math::binomial_distribution<>;
  const double k = static_cast<double>(hits), n = static_cast<double>(count);
  return {k / n, Binomial::find_lower_bound_on_p(n, k, tail), Binomial::find_upper_bound_on_p(n, k, tail)};
}

std::vector<SobolIndex> sobol_indices(std::span<const SaltelliSample> samples) {
  std::vector<SobolIndex> indices;
  if (samples.empty()) return indices;
  double mean = 0;
  for (const SaltelliSample& s : samples) mean += 0.5 * (s.first + s.second);
  mean /= static_cast<double>(samples.size());
  std::vector<double> variance;
  for (const SaltelliSample& s : samples)
    variance.push_back(0.5 * ((s.first - mean) * (s.first - mean) + (s.second - mean) * (s.second - mean)));
  for (std::size_t i = 0; i < samples.front().mixed.size(); ++i) {
    std::vector<double> alone, total;
    for (const SaltelliSample& s : samples) {
      alone.push_back((s.second - mean) * (s.mixed[i] - s.first));
      total.push_back(0.5 * (s.first - s.mixed[i]) * (s.first - s.mixed[i]));
    }
    indices.push_back({ratio(alone, variance), ratio(total, variance)});
  }
  return indices;
}

MorrisMeasure morris_measure(const std::vector<double>& effects) {
  MorrisMeasure m;
  m.count = effects.size();
  if (effects.empty()) return m;
  const Moments all = moments(effects);
  m.mean = all.mean;
  m.deviation = all.deviation;
  std::vector<double> sizes;
  for (const double e : effects) sizes.push_back(std::abs(e));
  m.mean_size = mean_of(sizes);
  if (std::isfinite(m.mean_size.low)) m.mean_size.low = std::max(m.mean_size.low, 0.0);  // no mean of sizes is less
  return m;
}

}  // namespace withy::campaign
