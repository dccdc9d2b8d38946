#include "withy/core/analysis/mode_branches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace withy {
namespace {

std::complex<double> closely(const Mode& mode, Closeness closeness) {
  return closeness == Closeness::of_squares ? mode.squared_frequency() : mode.eigenvalue;
}

}  // namespace

std::vector<std::optional<std::size_t>> cheapest_pairs(const Eigen::MatrixXd& costs, double most) {
  struct Pair {
    std::size_t row, column;
    double cost;
  };
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < costs.rows(); ++i)
    for (Eigen::Index k = 0; k < costs.cols(); ++k)
      if (costs(i, k) <= most) pairs.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(k), costs(i, k)});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
  std::vector<std::optional<std::size_t>> by(static_cast<std::size_t>(costs.rows()));
  std::vector<bool> taken(static_cast<std::size_t>(costs.cols()), false);
  for (const Pair& p : pairs) {
    if (by[p.row] || taken[p.column]) continue;
    by[p.row] = p.column;
    taken[p.column] = true;
  }
  return by;
}

/// Of each branch the mode that continues it. Likeness decides; where shapes mix, the frequency.
std::vector<std::optional<std::size_t>> BranchTracker::continued(const std::vector<Mode>& modes,
                                                                 const Eigen::VectorXd& weights,
                                                                 Closeness closeness) const {
  Eigen::MatrixXd costs(last_.size(), modes.size());
  for (Eigen::Index i = 0; i < costs.rows(); ++i) {
    const Branch& branch = last_[static_cast<std::size_t>(i)];
    const std::complex<double> now = closely(branch.mode, closeness),
                               expected = branch.before ? 2.0 * now - *branch.before : now;
    for (Eigen::Index k = 0; k < costs.cols(); ++k) {
      const Mode& mode = modes[static_cast<std::size_t>(k)];
      const std::complex<double> found = closely(mode, closeness);
      const double apart = std::abs(found - expected) / (std::abs(found) + std::abs(expected) + 1e-300);
      costs(i, k) = 1 - modal_assurance(branch.mode.shape, mode.shape, weights) + apart;
    }
  }
  return cheapest_pairs(costs, std::numeric_limits<double>::infinity());
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
