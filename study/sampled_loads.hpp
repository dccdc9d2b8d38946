/// \file
/// The sampled loads of a scene in small motions: what they hold, and the exact map over their common period.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/study/small_motions.hpp"

namespace withy::study {

/// With x the small motions and d what the loads hold, beside x in one vector (x, d):
///   at an instant   d⁺ = R (x, d)   of the loads whose instant it is,
///   until the next  ẋ = A x + B_τ E d,   d constant.
class SampledLoads {
 public:
  /// \throws InputError where the periods have no common one within a thousand instants.
  explicit SampledLoads(const SmallMotions& motions);

  [[nodiscard]] bool none() const { return loads_.empty(); }
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(names_.size()); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }  ///< as "control.held[0]"
  /// [s] after which all instants fall together again.
  [[nodiscard]] double period() const { return period_; }
  /// The period of one load (index in Model::loads()) [s]; 0: it is not sampled.
  [[nodiscard]] double period_of(std::size_t load) const;
  /// E: efforts on all speeds of what is held.
  [[nodiscard]] const Eigen::MatrixXd& efforts() const { return efforts_; }
  /// The columns of E that belong to a load.
  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> held_by(std::size_t load) const;
  /// Whether renewing changes what is held where the motion stays at the state.
  [[nodiscard]] bool steady() const { return steady_; }
  /// The state with d_i = h.
  [[nodiscard]] State displaced(Eigen::Index i, double h) const;
  /// (x, d) just after the instant at which all are renewed, from (x, d) just before.
  [[nodiscard]] Eigen::MatrixXd renewal() const { return renewal(0); }
  /// Φ and Γ of (x, d) just before one common instant to just before the next, v held, ẋ = A x + by_held d + B v.
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> map(const Eigen::MatrixXd& A,
                                                                const Eigen::MatrixXd& by_held,
                                                                const Eigen::MatrixXd& B) const;

 private:
  struct Part {
    LoadSlot slot;
    double period;
    Eigen::Index first;  ///< of its numbers in d
  };
  void find_period();
  [[nodiscard]] Eigen::VectorXd renewed(const Part& part, State state) const;
  void differentiate();
  [[nodiscard]] Eigen::MatrixXd renewal(double t) const;

  const SmallMotions& motions_;
  std::vector<Part> loads_;
  std::vector<std::string> names_;
  std::vector<double> instants_;  ///< within the common period, from 0
  double period_ = 0;
  bool steady_ = true;
  Eigen::MatrixXd efforts_, renewal_;  ///< of all loads
};

}  // namespace withy::study
