#include "withy/study/blade_tracker.hpp"

#include <cmath>
#include <utility>

#include "withy/core/analysis/mode_branches.hpp"

namespace withy::study {
namespace {

using Exponent = std::complex<double>;

/// Of 1 − likeness and distance, each up to 1: what has another shape and is not near is another motion.
constexpr double most_unlike = 1.25;

/// Where a branch is, and where it is expected at the next value.
struct Track {
  Exponent last, expected;
};

/// How unlike it a mode is.
double cost_of(const Track& track, const Exponent& exponent, double likeness) {
  // The size at the last value keeps what is on its way through zero from being far from everything.
  const double size = std::abs(exponent) + std::abs(track.expected) + std::abs(track.last);
  return 1 - likeness + (size > 0 ? std::abs(exponent - track.expected) / size : 0.0);
}

/// A mode, or its conjugate where that is the more like.
struct Continuation {
  double cost = 0;
  bool conjugate = false;
};

Continuation continuation(const Track& track, const Eigen::VectorXcd& shape, const BladeModes& found,
                          std::size_t mode) {
  const Exponent exponent = found.modes[mode].exponent;
  const Eigen::VectorXcd& its = found.shapes[mode];
  const double as_it_is = cost_of(track, exponent, modal_assurance(shape, its, found.masses));
  if (exponent.imag() == 0) return {as_it_is, false};
  const double turned = cost_of(track, std::conj(exponent), modal_assurance(shape, its.conjugate(), found.masses));
  return turned < as_it_is ? Continuation{turned, true} : Continuation{as_it_is, false};
}

}  // namespace

void BladeTracker::follow(double value, BladeModes& found) {
  const std::size_t count = found.modes.size();
  if (count == 0 || (!last_.empty() && last_.front().shape.size() != found.shapes.front().size())) last_.clear();
  const auto track = [&](const Branch& b) {
    const Exponent turned(0, b.waves * (found.rate - b.rate));
    return Track{b.exponent, b.exponent + (b.slope ? *b.slope * (value - b.value) : turned)};
  };
  Eigen::MatrixXd costs(last_.size(), count);
  for (std::size_t i = 0; i < last_.size(); ++i)
    for (std::size_t k = 0; k < count; ++k)
      costs(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          continuation(track(last_[i]), last_[i].shape, found, k).cost;
  const std::vector<std::optional<std::size_t>> by = cheapest_pairs(costs, most_unlike);

  const auto begun = [&](std::size_t number, std::size_t k) {
    return Branch{number, value, found.modes[k].exponent, found.shapes[k], found.waves[k], found.rate, {}};
  };
  found.branches.assign(count, 0);
  std::vector<bool> taken(count, false);
  std::vector<Branch> now;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    if (!by[i]) continue;
    const std::size_t k = *by[i];
    taken[k] = true;
    const bool conjugate = continuation(track(last_[i]), last_[i].shape, found, k).conjugate;
    Branch b = begun(last_[i].number, k);
    if (conjugate) b.exponent = std::conj(b.exponent), b.shape = b.shape.conjugate().eval(), b.waves = -b.waves;
    if (value != last_[i].value) b.slope = (b.exponent - last_[i].exponent) / (value - last_[i].value);
    found.branches[k] = b.number;
    now.push_back(std::move(b));
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (taken[k]) continue;
    found.branches[k] = next_;
    now.push_back(begun(next_++, k));
  }
  last_ = std::move(now);
}

}  // namespace withy::study
