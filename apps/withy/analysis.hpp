/// \file
/// What the commands `equilibrium`, `linearize` and `modes` share: the configuration they look at.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/core/analysis/steady_state.hpp"

namespace withy::app {

/// A rate given on the command line: `axle=6.0`, `axle=60 rev/min`, or `ball.2=1` for one of several.
struct SpunRate {
  std::size_t speed = 0;
  double rate = 0;  ///< [rad/s, m/s]
};

/// A scene at a state, with what is held of it.
class Configuration {
 public:
  /// \throws SceneError, InputError, PluginError
  explicit Configuration(const ConfigurationArguments& arguments);

  [[nodiscard]] const Engine& engine() const { return engine_; }
  [[nodiscard]] const Layout& layout() const { return engine_.model().layout(); }
  [[nodiscard]] const TangentDynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Held& held() const { return held_; }
  /// Gives a speed a rate and holds it.
  void spin(const SpunRate& rate);
  /// Reads `HINGE=RATE`; `option` is named in messages. \throws InputError
  [[nodiscard]] SpunRate read_spin(const std::string& text, const std::string& option) const;
  /// Takes the free coordinates from another state of the same model.
  void begin_at(const State& state);
  void set_state(State state) { state_ = std::move(state); }
  /// Speeds of a hinge, or the one speed of that name. \throws InputError naming `option`
  [[nodiscard]] std::vector<std::size_t> speeds_of(const std::string& name, const std::string& option) const;
  /// Speeds that belong to hinges.
  [[nodiscard]] std::vector<std::size_t> hinge_speeds() const;

 private:
  Engine engine_;
  TangentDynamics dynamics_;
  State state_;
  Held held_;
};

/// The states, efforts and outcome of a steady state; the state is in the form of state files.
nlohmann::ordered_json steady_json(const Configuration& configuration, const SteadyState& steady);
/// Why there is no steady state, in a sentence or two; empty where there is one.
std::string no_steady_state(const Configuration& configuration, const SteadyState& steady);
/// How the derivatives were found: exact, or numerical for loads that are named.
std::string derivatives_text(const Tangents& tangents);
/// The names of what is held, as "axle.0"; empty where nothing is.
std::vector<std::string> held_names(const Configuration& configuration);

}  // namespace withy::app
