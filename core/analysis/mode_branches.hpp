/// \file
/// Modes along a sweep: which one continues which.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "withy/core/analysis/modes.hpp"

namespace withy {

/// Modes at one value of a sweep, in the order of their branches.
struct BranchedModes {
  std::vector<Mode> modes;
  std::vector<std::size_t> branches;  ///< the number of each, ascending from 0 on; with gaps where branches have ended
};

/// What is close to where the last two values of a branch lead to. Squared frequencies λ₁λ₂ pass smoothly through zero
/// where a mode buckles; of a loop, whose real eigenvalues are modes by themselves, eigenvalues tell more of them
/// apart.
enum class Closeness { of_squares, of_eigenvalues };

/// Of each row of costs the column that goes with it, each column once: the cheapest pairs first. None where all
/// columns are taken, or those left cost more than `most`.
std::vector<std::optional<std::size_t>> cheapest_pairs(const Eigen::MatrixXd& costs, double most);

/// Follows modes through a sweep: the same branch keeps its number although others cross it.
class BranchTracker {
 public:
  /// By likeness of shape and by closeness to where the last two values of each branch lead to.
  /// `weights` as for modal_assurance. Where there are more modes than before, as where a conjugate pair of a loop
  /// becomes two real eigenvalues, branches begin; where there are fewer, the ones end that fit worst. Where shapes
  /// have another number of components all begin anew, in the order given.
  BranchedModes follow(std::vector<Mode> modes, const Eigen::VectorXd& weights,
                       Closeness closeness = Closeness::of_squares);

 private:
  struct Branch {
    std::size_t number = 0;
    Mode mode;
    std::optional<std::complex<double>> before;  ///< what is to be close, at the value before
  };
  [[nodiscard]] std::vector<std::optional<std::size_t>> continued(const std::vector<Mode>& modes,
                                                                  const Eigen::VectorXd& weights,
                                                                  Closeness closeness) const;

  std::vector<Branch> last_;
  std::size_t next_ = 0;  ///< number of the next branch that begins
};

}  // namespace withy
