/// \file
/// A scene with its equations of motion: what every study starts from, and the models up from it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/equations/branch_equations.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"
#include "withy/core/simulation/rungs.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/scene/scene.hpp"

namespace withy {
class SceneParts;
}

namespace withy::study {

/// Immutable; threads may share it.
struct Prepared {
  SceneValues values;  ///< that the scene was made of
  Scene scene;
  std::shared_ptr<const EquationsOfMotion> equations;
  /// Of the formulation `auto`, which a run chooses and changes: those that studies take, by their ranks, but for the
  /// strict ones, whose mass matrix can become singular, and those that not every flexible body offers; else empty.
  /// Where nothing runs, `auto` is `quadratic`.
  std::vector<Rung> rungs;
  std::vector<std::shared_ptr<const EquationsOfMotion>> rung_equations;

  [[nodiscard]] const Model& model() const { return *scene.model; }
  [[nodiscard]] bool escalates() const { return !rungs.empty(); }
  /// The scene's name, or that of its file.
  [[nodiscard]] const std::string& title() const { return scene.name.empty() ? scene.file : scene.name; }
};

/// Makes the scene and compiles it.
/// \throws SceneError; InputError where the formulation cannot treat the model; PluginError where a library is refused.
Prepared prepare(SceneValues values, Registry& registry);
/// The same with what `parts` remembers of scenes before.
Prepared prepare(SceneValues values, Registry& registry, SceneParts& parts);

/// \param who "an FMU". \throws InputError where the formulation is `auto`, which changes along a run: they need one
void check_one_formulation(const Prepared& prepared, const std::string& who);

/// From now on evaluates the branches of the tree on that many threads (on_threads): the same bits, in less time where
/// they are large. \returns why it does not, and nothing has changed; empty where it does. \param threads at least 2
std::string use_threads(Prepared& prepared, std::size_t threads);

/// How a run of the scene goes: its end, outputs, limits and events. \throws SceneError where it has no end.
RunOptions run_options(const Scene& scene);
/// What the scene's formulation keeps, then what those of single bodies do.
std::vector<Terms> terms_in_use(const Scene& scene);
/// Whether its energy is truncated as its equations are (RunOptions::own_energy).
bool has_own_energy(const Scene& scene);

/// A formulation with its options at their defaults. \throws InputError where there is none of that id.
std::shared_ptr<const Formulation> make_formulation(Registry& registry, const std::string& id);
/// An integrator by id, its options at their defaults but for those given. \throws InputError
std::shared_ptr<const Integrator> make_integrator(Registry& registry, const std::string& id, Value options);
/// One with this relative tolerance, the absolute one a hundredth of it. \throws InputError
std::shared_ptr<const Integrator> make_integrator(Registry& registry, const std::string& id, double tolerance);

/// Equations of a scene's model that neglect less than its own formulation and those of single bodies: in the least
/// rung of `auto` above them that every flexible body offers.
struct Beyond {
  std::string formulation;
  std::shared_ptr<const Model> model;  ///< the scene's, or the same without formulations of single bodies
  std::shared_ptr<const EquationsOfMotion> equations;
  bool highest = false;  ///< no rung is above it
};
/// The scene's model with every body in one formulation.
/// \throws std::invalid_argument where a body cannot be; InputError where there is no such formulation.
Beyond compile_throughout(const Prepared& prepared, Registry& registry, const std::string& formulation);
/// Nothing where no body is flexible or there is no model up.
std::optional<Beyond> next_model_up(const Prepared& prepared, Registry& registry);

/// The least rung of `auto` above a formulation; nothing where there is none. \throws InputError
std::optional<std::string> next_rung(Registry& registry, const std::string& formulation);

/// Why these equations have no Jacobian; only where EquationsOfMotion::linearization gives none.
std::string why_no_derivatives(const Prepared& prepared);

/// Whether any body has modes.
bool flexible(const Model& model);

}  // namespace withy::study
