/// \file
/// Whether a formulation holds in the motion that a run makes (theory, section 5): looked at along the run.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/busiest_state.hpp"
#include "withy/core/simulation/carried_frequency.hpp"
#include "withy/core/simulation/carried_spin.hpp"
#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/core/simulation/states_along.hpp"

namespace withy {

/// How much of the elastic energy of a family of modes is in the highest vibration that its modes can show.
struct HighestMode {
  std::string family;
  double frequency = 0;  ///< of that vibration, the body's frame held [rad/s]
  double share = 0;      ///< of the energies summed over the samples; 1 where the family has one mode alone
  std::size_t modes = 0;
};

/// Extremes of one flexible body: of its rate over all steps whose energy is looked at, of its load over the samples of
/// a run, the steps at which bodies turned fastest, and the busiest of every few steps.
struct BodyValidity {
  std::string name;
  std::string station;              ///< whose deflection is held against the body's length (measured_place)
  std::vector<std::string> beside;  ///< further ones; the greatest counts (measured_places)
  /// ω₁ of the structure that the body is part of, as it is carried and loaded: with what hangs on it, hinges held but
  /// for what closed loops ask of theirs (LoopFollowing), at the last sample up to rate_time [rad/s].
  double fundamental = 0;
  double rate_ratio = 0;  ///< greatest |ω| of the body's frame over ω₁
  double rate_time = 0;   ///< when [s]
  double spin_ratio = 0;  ///< greatest moment of what spins on the body over what bends it (CarriedSpin), over samples
  double spin_time = 0;   ///< when [s]
  LoadRatio load;         ///< where its size is greatest
  double load_time = 0;   ///< when [s]
  LoadRatio whole;        ///< of the first of several segments: the same of the whole as one piece
  double buckling = 0;    ///< greatest compressive load over the buckling load, ≥ 0
  std::vector<HighestMode> highest;
};

/// What the accelerations lack against those of equations that neglect less, in the norm √(aᵀ M a) of these equations'
/// mass matrix. By Gauss's principle it does not depend on the choice of coordinates.
struct NeglectedAcceleration {
  std::size_t samples = 0;
  double rms = 0;   ///< root mean square of the difference over that of the accelerations used
  double peak = 0;  ///< greatest difference over the greatest acceleration used
};

struct Validity {
  std::vector<BodyValidity> bodies;  ///< the flexible ones
  std::size_t samples = 0;
  NeglectedAcceleration neglected;  ///< no samples where there was nothing to compare with
  std::vector<State> along;         ///< states of the run for looks at it afterwards, by `StatesAlong`
  std::vector<State> closely;       ///< more of them, where the equations have no linearly implicit steps
};

/// Samples one run. The interval is counted in evaluations of the equations of motion that steps make, which makes the
/// samples the same on every machine and at every output interval, and is such that samples take about 2 % of a long
/// run. Loads are looked at more often, for as much again: what a body carries may be there for a few steps, as after
/// an impact. Allocates nothing after construction where there are no closed loops.
class ValidityWatch {
 public:
  /// `beyond`: equations of the same model that neglect less, or null.
  ValidityWatch(const Model& model, const EquationsOfMotion& equations, const EquationsOfMotion* beyond,
                Validity& validity);
  /// At an accepted state, with the evaluations that steps have made so far. What is due is sampled once the run is
  /// known to be right up to there, for what lies behind the last state `trusted` [s] is no motion of the model.
  /// \param seen an observation that has been brought to the state; null: there is none
  void observe(const State& state, std::size_t evaluations, double trusted, const Observation* seen) {
    if (bodies_.empty()) return;
    along_.observe(state);
    closely_.observe(state);
    busiest_.observe(state);
    if (evaluations >= next_look_ && look_at_busiest(trusted)) next_look_ = evaluations + look_interval_;
    if (due_ && held_.time <= trusted) sample_due();
    if (seen != nullptr && state.time <= trusted) follow(state, *seen);
    if (!due_ && evaluations >= next_) hold(state, evaluations);
  }
  /// Where speeds have jumped.
  void begin_at(const State& state) { busiest_.begin_at(state); }
  /// Looks at all that is due: the equations are about to change.
  void settle();
  /// At the last state that can be trusted, which is a sample too where its accelerations say something: at the pole of
  /// a singular mass matrix they do not. Sums become ratios.
  void finish(const State& trusted, bool sampled);
  /// What has been seen so far.
  void remember(Memory& memory);

 private:
  struct Family {
    std::string name;
    double highest = 0;  ///< frequency [rad/s]
    std::vector<Eigen::Index> coordinates;
    Eigen::VectorXd projection;  ///< row of G times the highest vibration
    Eigen::MatrixXd stiffness, mass;
    Eigen::VectorXd q, rate;
  };
  struct Energy {
    double highest = 0, whole = 0;
  };
  struct Watched {
    std::size_t body;
    const Slot* slot;
    MotionStiffness stiffness;
    std::shared_ptr<std::vector<Family>> families;  ///< equal bodies share them
    std::vector<Energy> energies;                   ///< of each family
    double sampled = 0;                             ///< greatest rate of the frame in the samples [rad/s]
    std::optional<MotionStiffness> whole = {};      ///< of a body in segments, at the first of them
  };
  static std::vector<Family> families_of(const ModalShape& shape);
  /// ω₁ of a body at the last sample [rad/s].
  [[nodiscard]] double fundamental(std::size_t body) const {
    const double closed = loops_.frequency(body);
    return closed > 0 ? closed : frequency_.of(body);
  }
  void sample_due();
  void hold(const State& state, std::size_t evaluations);
  void follow(const State& state, const Observation& seen);
  void note_rate(std::size_t index, double rate, double time);
  /// \returns whether the equations could be evaluated there.
  bool look_at_loads(const State& state);
  bool look_at_motion(const State& state);
  /// \returns whether there was one, up to a time that is trusted [s].
  bool look_at_busiest(double trusted);
  void sample(const State& state);
  void look_at_energies(const State& state, Watched& w) const;
  void compare_accelerations(const State& state);

  const Model& model_;
  const EquationsOfMotion& equations_;
  const EquationsOfMotion* beyond_;
  Validity& validity_;
  TreeMotion motion_;
  FeltMotion felt_;
  std::vector<Watched> bodies_;
  CarriedFrequency frequency_;
  CarriedSpin spin_;
  LoopFollowing loops_;
  Work work_;  ///< of whichever equations are evaluated
  std::vector<double> rates_, beyond_rates_, difference_, product_;
  double squares_ = 0, neglected_squares_ = 0, greatest_ = 0, neglected_greatest_ = 0;
  std::size_t cost_;      ///< of a sample in evaluations, roughly
  std::size_t next_ = 0;  ///< evaluations at which the next sample is due
  State held_;            ///< to be sampled
  bool due_ = false;
  State fastest_;  ///< since the last sample, where a body turned faster than in any
  double excess_;  ///< by this factor
  StatesAlong along_, closely_;
  BusiestState busiest_;
  std::size_t next_look_ = 0;  ///< evaluations at which the next look at it is due
  std::size_t look_interval_;
};

}  // namespace withy
