/// \file
/// A scene with the plugins it is made of and its equations of motion: what every command starts from.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/apps/withy/commands.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/escalation.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/scene/scene.hpp"

namespace withy::app {

/// Bad input found by a command: reported as it is, exit status 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The plugins of the folders the command line names and of the program's own.
class Plugins {
 public:
  /// \throws InputError where a folder is none.
  explicit Plugins(const CommonArguments& arguments);
  [[nodiscard]] Registry& registry() const { return *registry_; }
  [[nodiscard]] const PluginHost& host() const { return host_; }

 private:
  PluginHost host_;
  std::unique_ptr<Registry> registry_;
};

/// What a simulation does beside its outputs.
struct SimulationExtras {
  const EquationsOfMotion* beyond = nullptr;          ///< what is neglected is measured against it; may be null
  double checkpoint_seconds = 0;                      ///< wall time between checkpoints; 0: none but at SIGINT
  std::function<void(const Checkpoint&)> checkpoint;  ///< takes them; may be empty
  const Checkpoint* resume = nullptr;                 ///< where to go on; null: at the scene's initial state
  Observation* seen = nullptr;                        ///< brought to each output's state; may be null
};

class Engine {
 public:
  /// Reads the scene, loads what it names and compiles it.
  /// \throws SceneError, InputError; PluginError where a plugin is refused.
  explicit Engine(const SceneArguments& arguments);
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Model& model() const { return *scene_.model; }
  [[nodiscard]] const EquationsOfMotion& equations() const { return *equations_; }
  [[nodiscard]] const Plugins& plugins() const { return plugins_; }
  [[nodiscard]] Registry& registry() const { return plugins_.registry(); }
  /// The formulation in a sentence.
  [[nodiscard]] std::string formulation_summary() const;
  /// The state of a file, or the scene's initial state where the name is empty.
  [[nodiscard]] State state(const std::string& file) const;

  /// Simulates from the scene's initial state to its end. Shows progress on standard error where that is a terminal;
  /// ends as interrupted at SIGINT.
  /// Where the formulation is `auto`: as simulate_escalating() does, which has no extras.
  [[nodiscard]] RunSummary simulate(const std::function<void(const State&)>& output,
                                    const SimulationExtras& extras = {}) const;

  /// Whether the formulation is `auto`, which a run chooses and changes. Where nothing runs, it is `quadratic`.
  [[nodiscard]] bool escalates() const { return !rungs_.empty(); }
  /// `ruthless`, `quadratic` and, where every flexible body offers it, `exact`.
  [[nodiscard]] const std::vector<Rung>& rungs() const { return rungs_; }
  /// The run of an engine that escalates, with the same progress and end at SIGINT.
  /// \throws InputError where a load has discrete states.
  [[nodiscard]] EscalatedRun simulate_escalating(
      const std::function<void(const State&, std::size_t rung)>& output) const;

 private:
  void make_rungs();
  [[nodiscard]] RunOptions run_options() const;

  Plugins plugins_;
  Scene scene_;
  std::unique_ptr<EquationsOfMotion> equations_;
  std::vector<std::unique_ptr<EquationsOfMotion>> rung_equations_;
  std::vector<Rung> rungs_;
};

}  // namespace withy::app
