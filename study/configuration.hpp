/// \file
/// A scene at a state, with what is held of it: what studies of steady states and small motions look at.
#pragma once

#include <string>
#include <vector>

#include "withy/core/analysis/steady_state.hpp"
#include "withy/core/simulation/renewal.hpp"
#include "withy/scene/state_as_given.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// A rate that a hinge is held at.
struct Spin {
  std::string name;  ///< of the hinge, or where it has several rates of one of its speeds, as "ball.2"
  double rate = 0;   ///< [rad/s, m/s]
};

/// What is held beside the hinges that motions drive.
struct Holding {
  std::vector<std::string> locked;  ///< hinges, or single speeds of them, at the state's coordinates and rates
  std::vector<Spin> spun;
};

class Configuration {
 public:
  /// Loops that the state leaves open are closed as where a run begins: what is locked stays, and what the state names
  /// stays where the rest can close them. Sampled loads that have not begun hold what they give at the state. Hinges
  /// that an integrator has left creeping about rest are at rest (without_creep).
  /// \throws InputError where a load switches, there is no such hinge, a loop cannot be closed, or its shape changes;
  /// SceneError where a load is wrong about its derivatives.
  Configuration(const Prepared& prepared, StateAsGiven start, const Holding& holding);

  [[nodiscard]] const Prepared& prepared() const { return prepared_; }
  [[nodiscard]] const Layout& layout() const { return prepared_.model().layout(); }
  [[nodiscard]] const TangentDynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] const State& state() const { return state_; }
  /// What has no motion of its own: speeds that are held, and those that follow others as closed loops ask for.
  [[nodiscard]] const Held& held() const { return held_; }
  /// What was changed to close loops, in a sentence; empty where nothing was.
  [[nodiscard]] const std::string& closing() const { return closing_; }
  [[nodiscard]] bool follows(std::size_t speed) const { return follows_[speed]; }
  /// What is held, without what follows.
  [[nodiscard]] Held kept() const;
  /// Names of the speeds that are held, as "axle.0".
  [[nodiscard]] std::vector<std::string> held_names() const;

  /// Gives a speed a rate and holds it. \throws InputError where a motion drives it already.
  void spin(const Spin& spin);
  /// Whether loads are sampled.
  [[nodiscard]] bool sampled() const;
  /// Takes the free coordinates, and the states of continuous and sampled loads, from another state of the same model.
  void begin_at(const State& state);
  void set_state(State state) { state_ = std::move(state); }

 private:
  /// What integrators leave of a rest goes. \throws InputError where the shape of a loop changes
  void rest_loops();
  void close_loops(const StateAsGiven& start, const Holding& holding);

  Prepared prepared_;
  TangentDynamics dynamics_;
  State state_;
  Held held_, follows_;
  std::string closing_;
};

/// Where a state has what the sampled loads of a model hold, but for what outputs alone show of them.
std::vector<LoadSlot> sampled_slots(const Model& model);
/// Its names, as "control.held[0]".
std::vector<std::string> sampled_names(const Model& model);
/// Where it has the rest: what outputs alone show of them, one for each of sampled_slots, in their order.
std::vector<LoadSlot> told_slots(const Model& model);
/// The state with what outputs alone show of sampled loads as a sample at it would tell; what these hold stays.
/// \param renewal of the same model
State told_at(const Model& model, Renewal& renewal, State state);

/// Speeds of a hinge, or the one speed of that name. \throws InputError naming `what` they were wanted for
std::vector<std::size_t> speeds_of(const Model& model, const std::string& name, const std::string& what);
/// Speeds that belong to hinges.
std::vector<std::size_t> hinge_speeds(const Layout& layout);
/// Whether the one rate of that name turns something. \throws InputError as speeds_of, and where it names several
bool rate_is_angular(const Model& model, const std::string& name, const std::string& what);

/// A rate from its text, a number or "60 rev/min". \throws InputError naming `what` it was wanted for
Spin read_spin(const Model& model, const std::string& hinge, const std::string& rate, const std::string& what);

/// What is locked, and what turns or slides at rates as "axle=6.0", "axle=60 rev/min", "ball.2=1".
/// \throws OptionError of `spin`, InputError
Holding read_holding(const Model& model, const std::vector<std::string>& lock, const std::vector<std::string>& spin);

/// What is not finite at a state, in a clause, and whether that is a law which has failed where it runs.
struct NotFinite {
  std::string text;  ///< empty: all is finite
  bool failed = false;
};
NotFinite not_finite(const Configuration& configuration, const State& state);

/// Accelerations at the configuration's state, those of held speeds as for `withy::accelerations`.
/// \throws std::domain_error where something is not finite, which it names, or the mass matrix is singular
Eigen::VectorXd accelerations_of(const Configuration& configuration);

/// Why there is no steady state, in a sentence or two; empty where there is one.
std::string no_steady_state(const Configuration& configuration, const SteadyState& steady);
/// How the derivatives were found: exact, or numerical for loads that are named.
std::string derivatives_text(const Tangents& tangents);

}  // namespace withy::study
