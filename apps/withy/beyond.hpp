/// \file
/// The next model up: the equations that a run's errors are measured against.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "withy/apps/withy/engine.hpp"

namespace withy::app {

/// Equations of a scene's model that neglect less than its own formulation: `quadratic` for all that neglect more, and
/// `exact` for `quadratic` where every flexible body offers it.
struct Beyond {
  std::string formulation;
  std::shared_ptr<const Model> model;  ///< the scene's, or the same without formulations of single bodies
  std::unique_ptr<EquationsOfMotion> equations;
};
/// The scene's model with every body in one formulation.
/// \throws std::invalid_argument where a body cannot be; InputError where there is no such formulation.
Beyond compile_throughout(const Engine& engine, const SceneArguments& arguments, const std::string& formulation);
/// Nothing where no body is flexible or there is no model up.
std::optional<Beyond> next_model_up(const Engine& engine, const SceneArguments& arguments);

/// Whether the scene and each of its bodies is in the formulation with these terms.
bool has_terms_throughout(const Scene& scene, Terms terms);

/// An integrator by id, its options at their defaults but for those given.
std::unique_ptr<Integrator> make_integrator(Registry& registry, const std::string& id, Value options);

}  // namespace withy::app
