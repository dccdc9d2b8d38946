/// \file
/// What a run watches while it goes: peaks, deflections, energy, the sign of det M.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/effort_watch.hpp"
#include "withy/core/simulation/momentum_watch.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/step_watch.hpp"
#include "withy/core/simulation/tips.hpp"

namespace withy {

/// Watches one run from its initial state on; the peaks go to the run's summary.
class Monitor {
 public:
  /// \param span of the run [s]
  /// \param seen an observation of these equations; null: the monitor makes its own
  /// \param attention with that to the outcome alone efforts and momenta are not looked at
  Monitor(const Model& model, const EquationsOfMotion& equations, const State& initial, double deflection_limit,
          double span, Observation* seen, RunSummary& summary, Attention attention = Attention::whole);

  /// Peaks of deflections and efforts: for every accepted step, and what lies between it and the one before.
  void observe(const Stepper& stepper);
  /// Loads and motions begin here, or what they do may have jumped.
  void begin_efforts(const State& state) {
    if (effort_watch_) effort_watch_->begin_at(state);
    if (momenta_) look_at_loads(state);
  }
  /// Brings the observation to an output.
  void show(const State& state) {
    seen_.observe(state.y);
    seen_y_.clear();
  }
  /// The deflection past its limit in the states observed, in words; empty where there is none.
  [[nodiscard]] const std::string& excess() const { return excess_; }
  /// Whether that is a deflection past its limit.
  [[nodiscard]] bool past_deflection() const { return past_deflection_; }
  /// Energy against the work done. A state where they balance is to be trusted. Brings the observation there.
  void audit_energy(const State& state);
  [[nodiscard]] const Observation& seen() const { return seen_; }
  /// The equations change at a state, by `change`: what energy does there is no error of theirs.
  void rebase_energy(const State& state, const std::function<void()>& change);
  /// Events have changed the state: what they did is in its work, and nothing is smooth across.
  void pass_event(const State& before, const State& after);
  /// The energy is that of the equations' mass matrix and of their weight (RunOptions::own_energy).
  void use_own_energy(const State& initial);
  /// To be called at the end, in place of audit_energy: what the loads have done on the way decides whether momenta are
  /// conserved.
  void finish(const State& state);
  /// What of the greatest energy may be missing from a state that is to be trusted.
  void trust(double limit) { trust_limit_ = limit; }
  /// Trusts no state from here on.
  void distrust() { trust_limit_ = -1; }
  /// The last state audited that can be trusted.
  [[nodiscard]] const State& trusted() const { return trusted_; }
  /// Takes the peaks of deflections and efforts back to what they were at the last trusted state.
  void forget_untrusted_peaks();
  /// Greatest |speed| in the states audited [rad/s, m/s].
  [[nodiscard]] double greatest_speed() const { return greatest_speed_; }
  /// Sign of det M at an accepted state against that of the start.
  void audit_mass_matrix(const State& state, int sign);
  /// Says that a load has changed at an instant known beforehand: rejections after it are no sign of another.
  void pass_instant() { burst_ = 0; }
  /// Rejections up to now, after an accepted step: notes the time where they pile up.
  void audit_steps(const State& state, const StepStatistics& steps);

  [[nodiscard]] const std::optional<SignChange>& sign_change() const { return sign_change_; }
  /// For a run that goes back to a state before its bad end.
  void forget_bad_end() {
    excess_.clear();
    past_deflection_ = false;
    sign_change_.reset();
  }
  /// What has been seen so far, with its part of the summary.
  void remember(Memory& memory);

 private:
  /// Displacement of a section, to second order.
  struct SectionExpansion {
    /// factor · q_i, or factor · q_i q_j where j ≥ 0.
    struct Term {
      double factor;  ///< of Φ_i, Γ_ij or ½ Γ_ii
      int i, j;
    };
    std::vector<Term> terms;            ///< of x, then of y, then of z, without those that are zero
    std::array<std::size_t, 3> ends{};  ///< where those of a component end
    std::vector<Term> turns;            ///< of the angle about x, then y, then z, to the first order
    std::array<std::size_t, 3> turn_ends{};
    explicit SectionExpansion(const PointExpansion& e);
    struct Motion {
      Vector3 displacement = Vector3::Zero(), velocity = Vector3::Zero();
    };
    void at(const double* q, const double* u, Motion& motion) const;
    /// Angle of the section [rad], squared.
    [[nodiscard]] double squared_angle(const double* q) const;
  };
  static constexpr Eigen::Index whole = 3;  ///< in the place of a component: the size of a deflection
  /// A flexible body's tip, or a segment's, or the station that a body without one has in its place.
  struct End {
    const Slot* slot;  ///< of the body's modes
    int body;
    int frame;      ///< −1: `section` stands for it
    bool expanded;  ///< what `section` says is the deflection
    SectionExpansion section;
    double length;                ///< [m]
    std::string name;             ///< of the place, in words
    std::array<double, 3>* peak;  ///< null: a segment's, or no tip's
    double* ratio;
    double* angle;
    std::array<double, 3> rough{};    ///< greatest |component| of the deflection by the expansion
    double rough_square = 0;          ///< greatest squared size of the deflection by the expansion
    SectionExpansion::Motion now{};   ///< at the last accepted state, by the expansion
    SectionExpansion::Motion next{};  ///< the same at the one that is looked at
    double within = 0;                ///< share of the last step at which a component may be greatest; 0: at none
    /// Half the rate of the square of a component, or of the size of the whole.
    [[nodiscard]] static double growth(const SectionExpansion::Motion& m, Eigen::Index k) {
      return k == whole ? m.displacement.dot(m.velocity) : m.displacement[k] * m.velocity[k];
    }
    /// Whether a deflection by the expansion may have been greater than it has been before, in a component or as a
    /// whole, since the last state: the cubic from there to the one that is looked at lies within its control points.
    /// \param h time between the two [s]
    [[nodiscard]] bool may_exceed(double h) const;
    /// Whether it grows at the last state and shrinks at the one that is looked at.
    [[nodiscard]] bool turns(Eigen::Index k) const { return !(growth(now, k) <= 0) && !(growth(next, k) >= 0); }
    /// Whether a deflection by the expansion is greater than it has been, in a component or as a whole.
    [[nodiscard]] bool exceeded_by(const Vector3& d) const {
      return std::abs(d[0]) > rough[0] || std::abs(d[1]) > rough[1] || std::abs(d[2]) > rough[2] ||
             d.squaredNorm() > rough_square;
    }
  };
  void look(const State& state);
  /// Brings the observation to a state, where it is not there yet.
  void see(const State& state);
  static void look_at_angle(End& end, const double* q);
  void observe_end(std::size_t index, const State& state, const Vector3& rough, bool& seen);
  void look_within(const State& state);
  [[nodiscard]] double greatest_within(const End& end, Eigen::Index component, double h) const;
  void note(std::size_t order, const std::string& place, const std::string& body, double length,
            const std::array<double, 3>& d, std::array<double, 3>* peak);
  /// `visit` is given each peak of the summary, always in the same order.
  template <class Visit>
  void each_peak(const Visit& visit);
  void trust_state(const State& state);
  /// Sign of det M by one evaluation; 0 where it cannot be solved.
  [[nodiscard]] int mass_matrix_sign(const State& state);

  const Model& model_;
  const EquationsOfMotion& equations_;
  RunSummary& summary_;
  std::unique_ptr<Observation> own_;  ///< null where another is used
  Observation& seen_;
  std::vector<double> seen_y_;  ///< that `see` has brought it to; empty: somebody else may have moved it
  std::vector<End> ends_;
  std::vector<Tip> wholes_;  ///< of bodies in segments
  double deflection_limit_;
  std::string excess_;
  bool past_deflection_ = false;
  std::size_t excess_order_ = 0;  ///< of several at one state the first body's is told
  State last_;                    ///< the accepted state before
  State between_;                 ///< a state within the last step
  State trusted_;
  std::vector<double> trusted_peaks_;
  double trust_limit_ = 0.5, greatest_speed_ = 0;
  std::optional<EffortWatch> effort_watch_;
  std::vector<double> efforts_;
  Work work_;  ///< for the equations' own energy
  [[nodiscard]] double kinetic(const State& state, const Energies& energies);
  [[nodiscard]] double potential(const State& state, const Energies& energies);
  void look_at_loads(const State& state);
  void find_rounding_energy(const State& state);

  bool own_energy_ = false;
  std::optional<MomentumWatch> momenta_;  ///< nothing where they cannot be conserved
  Energies initial_energies_;
  double untruncated_error_ = 0;
  double initial_energy_ = 0, initial_work_ = 0;
  double energy_error_ = 0, energy_scale_ = 0;
  const ClosedLoops* loops_;                      ///< null: there are none
  double length_of_loops_, rounding_energy_ = 0;  ///< [m], [J]: as much or less is no energy
  std::vector<double> multipliers_;
  Work loops_work_;
  std::size_t steps_ = 0;  ///< accepted
  int initial_sign_ = 0;   ///< of det M
  double checked_;         ///< time of the last look at the sign of det M
  std::optional<SignChange> sign_change_;
  std::size_t rejected_ = 0;  ///< steps rejected so far
  std::size_t burst_ = 0;     ///< of these, in the present burst
  std::size_t calm_ = 0;      ///< steps in a row that were not rejected
  bool noted_ = false;        ///< the present burst is in the summary
};

}  // namespace withy
