/// \file
/// A scene: read, checked, and made into a model.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/mode_parameters.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/scene/scene_values.hpp"
#include "withy/scene/sources.hpp"

namespace withy {

/// What the command line asks for beyond the file; empty: what the file says.
struct SceneOptions {
  std::string formulation;             ///< plugin id; the file's options stay if they are that plugin's
  std::string integrator;              ///< the same
  std::vector<std::string> overrides;  ///< `path.to.value=text`, applied before the scene is checked
};

/// The numbers of modes that a scene gives a body, which studies may vary.
struct BodyModes {
  std::string body;
  std::vector<ModeCount> counts;  ///< in the order of the body's modal coordinates
};

/// A scene ready to run. Immutable but for what the caller does with its copies.
struct Scene {
  std::string name;
  std::string file;                   ///< as it was named when it was read: for messages
  std::string folder;                 ///< its own, from the root on; empty: not known
  Value source;                       ///< checked values, SI units, defaults filled in
  std::string sha256;                 ///< of the text as it was read
  std::vector<std::string> settings;  ///< `path=value` of the command line, in their order
  SceneSources sources;               ///< files and plugins that it is made from
  std::vector<BodyModes> modes;       ///< of the bodies that have such numbers, in the order of the file
  std::shared_ptr<const Model> model;
  std::string formulation_name;
  std::shared_ptr<const Formulation> formulation;
  std::string integrator_name;
  std::shared_ptr<const Integrator> integrator;
  std::optional<double> end;        ///< [s]; where the scene gives none, the latest end of a load, if one has an end
  double output = 0.01;             ///< [s]
  double deflection_limit = 1.0;    ///< lengths of a body
  std::vector<RunEvent> events;     ///< for RunOptions
  std::vector<SensorNode> outputs;  ///< in the order of the file
  State initial;

  /// Where relative names of files begin, whatever the working directory is by now: `Document::directory_now`.
  [[nodiscard]] std::string folder_now() const;
};

/// Checks the values of a scene and makes it. Loads only the plugins it names.
/// \throws SceneError with every problem found. \throws PluginError where a library it names is refused.
Scene make_scene(const SceneValues& values, Registry& registry);
/// Reads a scene file (YAML or JSON) and makes it. Loads only the plugins it names.
/// \throws SceneError with every problem found. \throws std::system_error where the file cannot be read.
/// \throws PluginError where a library it names is refused.
Scene read_scene(const std::string& file, Registry& registry, const SceneOptions& options = {});
/// The same from text; `file` is the name used in messages.
Scene parse_scene(std::string_view text, const std::string& file, Registry& registry, const SceneOptions& options = {});

/// The time [s] at which a run of the scene ends. \throws SceneError where neither the scene nor a load says so; such
/// a scene can be evaluated, but not run.
double end_of_run(const Scene& scene);
/// From its initial time to that [s]; 0 where there is no end.
double span_of(const Scene& scene);

/// Reads a state (JSON or YAML, form as under `initial` of a scene) for a scene: what is not named is as in its
/// `initial`, but loads' continuous states that neither names begin where the state read has them begin. \throws
/// SceneError
State read_state(const std::string& file, const Scene& scene);
State parse_state(std::string_view text, const std::string& file, const Scene& scene);
/// The same for a model, where no scene says what is named: what is not is as in `start`, but loads' continuous states
/// of `start` that are as they would begin there begin anew.
State read_state(const std::string& file, const Model& model, const State& start);
State parse_state(std::string_view text, const std::string& file, const Model& model, const State& start);
/// The state as JSON text, complete with time and work: reading it back gives the same bits.
std::string write_state(const Model& model, const State& state);

/// The JSON Schema (draft 2020-12) of scenes, made from every plugin in the registry but those of libraries that are
/// refused when they are loaded here.
/// \param left_out called with the reason of each such library, once
std::string schema(Registry& registry, const std::function<void(const std::string& why)>& left_out = {});

}  // namespace withy
