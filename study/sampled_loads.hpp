/// \file
/// The sampled loads of a scene in small motions: what they hold, and the exact map over their common period.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/simulation/renewal.hpp"
#include "withy/study/linear_inputs.hpp"

namespace withy::study {

/// With x the small motions and d what the loads hold, beside x in one vector (x, d):
///   at an instant   d⁺ = R (x, d)   of the loads whose instant it is; what they measure may depend on all efforts,
///   until the next  ẋ = A x + (B_τ E + Z) d,   d constant, Z of the rates of loads' continuous states.
/// What outputs alone show of the loads, as errors, is told at an instant and no part of d: nothing follows it.
class SampledLoads {
 public:
  /// \throws InputError where the periods have no common one within a thousand instants, or a load measures what the
  /// acceleration of a speed has a part in that is held while others of its hinge are not, or what is told of another.
  explicit SampledLoads(const SmallMotions& motions);

  [[nodiscard]] bool none() const { return loads_.empty(); }
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(names_.size()); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }  ///< sampled_names
  /// Count of what is told alone, as told_slots have it.
  [[nodiscard]] Eigen::Index told() const { return told_; }
  /// [s] after which all instants fall together again.
  [[nodiscard]] double period() const { return period_; }
  /// The period of one load (index in Model::loads()) [s]; 0: it is not sampled.
  [[nodiscard]] double period_of(std::size_t load) const;
  /// E: efforts on all speeds of all loads by what is held: of the load that holds it, and of those that measure what
  /// that one gives, as an actuator its command.
  [[nodiscard]] const Eigen::MatrixXd& efforts() const { return efforts_; }
  /// The part of E that is the efforts of the load itself that holds it.
  [[nodiscard]] const Eigen::MatrixXd& own_efforts() const { return own_efforts_; }
  /// ẋ by what is held, for E or what of it still acts: continuous states of loads may measure what is held as well.
  [[nodiscard]] Eigen::MatrixXd moved(const Eigen::MatrixXd& efforts) const {
    return motions_.by_effort() * efforts + rates_;
  }
  /// The columns of E that belong to a load.
  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> held_by(std::size_t load) const;
  /// What is held after an instant at which all are renewed, from a state as SmallMotions::state().
  [[nodiscard]] Eigen::VectorXd renewed(const State& before) { return renewed(before, before, due_.front()); }
  /// Whether other sampled loads are renewed with what a load holds, directly and not by what it makes others do.
  [[nodiscard]] bool measured_by_others(std::size_t load);
  /// By how much it does.
  [[nodiscard]] const Eigen::VectorXd& change() const { return change_; }
  /// What is held at the state.
  [[nodiscard]] Eigen::VectorXd held_at_state() const { return held(motions_.state()); }
  /// The state with what is held displaced by d.
  [[nodiscard]] State displaced(const Eigen::VectorXd& d) const;
  /// The state with one number displaced that is told. \param i up to told()
  [[nodiscard]] State told_displaced(Eigen::Index i, double by) const;
  /// A state as SmallMotions::state(), with what is told as of a sample at it.
  [[nodiscard]] State told_at(State state) { return study::told_at(motions_.model(), renewal_, std::move(state)); }
  /// Derivatives of d⁺, then of what is told, by v just before instants, of which `inputs` tell the states: reactions
  /// and inner forces feel where a force acts, not its efforts alone. One a kind of instant; empty where loads measure
  /// nothing that follows v at once.
  [[nodiscard]] std::vector<Eigen::MatrixXd> felt(const std::vector<LinearInput>& inputs);
  /// A linear system from what is held from one common instant to the next, and what it takes at once.
  struct Held {
    Eigen::MatrixXd A, by_held, B;      ///< ẋ = A x + by_held d + B v
    std::vector<Eigen::MatrixXd> felt;  ///< as from `felt`
    Eigen::MatrixXd replaced;           ///< v × d: v stands in the place of this times d; empty: in none
  };
  /// Φ and Γ of (x, d) just before one common instant to just before the next, v held. Where v is felt, (x, d, h) with
  /// h the v before.
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> map(const Held& system) const;
  /// (x, d) just after the instant at which all are renewed, from (x, d) or (x, d, h) just before.
  [[nodiscard]] Eigen::MatrixXd renewal(const Held& system) const { return renewal(system, 0); }
  /// What outputs show just after that instant, (x, d) and what is told, from the same.
  [[nodiscard]] Eigen::MatrixXd shown(const Held& system) const { return shown(system, 0); }
  /// x over a common period.
  struct Course {
    double fastest = 0;                     ///< greatest frequency of ẋ = A x [rad/s]
    std::vector<double> times, weights;     ///< [s] from the first instant, and shares of the period
    std::vector<Eigen::MatrixXcd> motions;  ///< x at those, of each column
  };
  /// The small motions that begin with columns of (x, d) just before a common instant, v zero.
  [[nodiscard]] Course course(const Held& system, const Eigen::MatrixXcd& columns) const;

 private:
  struct Part {
    LoadSlot slot;
    double period;
    Eigen::Index first;  ///< of its numbers in d
    LoadSlot told;
  };
  void find_period();
  [[nodiscard]] std::vector<bool> due(double t) const;
  [[nodiscard]] Eigen::VectorXd held(const State& state) const;
  /// A step of d_i over which anything changes little: one, or as much as its load holds.
  [[nodiscard]] double step(Eigen::Index i) const;
  [[nodiscard]] Eigen::VectorXd held_and_told(const State& state) const;
  /// A state after an instant at which outputs are those of `before`.
  [[nodiscard]] State after(const State& before, State state, const std::vector<bool>& due);
  /// What is held then.
  [[nodiscard]] Eigen::VectorXd renewed(const State& before, State state, const std::vector<bool>& due) {
    return held(after(before, std::move(state), due));
  }
  [[nodiscard]] Eigen::MatrixXd differentiated(const std::vector<bool>& due);
  [[nodiscard]] Eigen::MatrixXd shown(const Held& system, std::size_t kind) const;
  [[nodiscard]] Eigen::MatrixXd renewal(const Held& system, std::size_t kind) const {
    return shown(system, kind).topRows(motions_.size() + size());
  }
  void differentiate();
  void refuse_held_alone();
  void refuse_told_measured();

  const SmallMotions& motions_;
  std::vector<Part> loads_;
  std::vector<std::string> names_;
  Renewal renewal_;
  std::vector<double> instants_;           ///< within the common period, from 0
  std::vector<std::size_t> kinds_;         ///< of the instants
  std::vector<std::vector<bool>> due_;     ///< one a kind: the loads that are renewed; all of them first
  std::vector<Eigen::MatrixXd> renewals_;  ///< one a kind: R, then rows of what is told
  Eigen::Index told_ = 0;
  double period_ = 0;
  Eigen::VectorXd change_;
  Eigen::MatrixXd efforts_, own_efforts_;
  Eigen::MatrixXd rates_;  ///< Z: zero but for the rows of continuous states
};

}  // namespace withy::study
