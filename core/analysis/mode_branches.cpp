#include "withy/core/analysis/mode_branches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace withy {
namespace {

std::complex<double> closely(const Mode& mode, Closeness closeness) {
  return closeness == Closeness::of_squares ? mode.squared_frequency() : mode.eigenvalue;
}

}  // namespace

/// Of each branch the mode that continues it. Likeness decides; where shapes mix, the frequency.
std::vector<std::optional<std::size_t>> BranchTracker::continued(const std::vector<Mode>& modes,
                                                                 const Eigen::VectorXd& weights,
                                                                 Closeness closeness) const {
  // All pairs of branch and mode, the best first.
  struct Pair {
    std::size_t branch, mode;
    double cost;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const std::complex<double> now = closely(last_[i].mode, closeness),
                               expected = last_[i].before ? 2.0 * now - *last_[i].before : now;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      const std::complex<double> found = closely(modes[k], closeness);
      const double apart = std::abs(found - expected) / (std::abs(found) + std::abs(expected) + 1e-300);
      pairs.push_back({i, k, 1 - modal_assurance(last_[i].mode.shape, modes[k].shape, weights) + apart});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
  std::vector<std::optional<std::size_t>> by(last_.size());
  std::vector<bool> taken(modes.size(), false);
  for (const Pair& p : pairs) {
    if (by[p.branch] || taken[p.mode]) continue;
    by[p.branch] = p.mode;
    taken[p.mode] = true;
  }
  return by;
}

BranchedModes BranchTracker::follow(std::vector<Mode> modes, const Eigen::VectorXd& weights, Closeness closeness) {
  if (last_.empty() || modes.empty() || last_.front().mode.shape.size() != modes.front().shape.size()) {
    last_.clear();
    next_ = 0;
  }
  const std::vector<std::optional<std::size_t>> by = continued(modes, weights, closeness);
  std::vector<Branch> now;
  std::vector<bool> taken(modes.size(), false);
  for (std::size_t i = 0; i < last_.size(); ++i) {
    if (!by[i]) continue;
    taken[*by[i]] = true;
    now.push_back({last_[i].number, std::move(modes[*by[i]]), closely(last_[i].mode, closeness)});
  }
  for (std::size_t k = 0; k < modes.size(); ++k)
    if (!taken[k]) now.push_back({next_++, std::move(modes[k]), {}});
  last_ = std::move(now);
  BranchedModes result;
  for (const Branch& branch : last_) {
    result.modes.push_back(branch.mode);
    result.branches.push_back(branch.number);
  }
  return result;
}

}  // namespace withy
