#include "withy/apps/withy/beyond.hpp"

#include <algorithm>

#include "withy/core/plugin/formulation.hpp"

namespace withy::app {
namespace {

bool same(const Terms& a, const Terms& b) { return a.strain == b.strain && a.truncation == b.truncation; }

bool flexible(const BodyNode& body) { return body.body->shape().modes() > 0; }

}  // namespace

bool has_terms_throughout(const Scene& scene, Terms terms) {
  return same(scene.formulation->terms(), terms) &&
         std::all_of(scene.model->bodies().begin(), scene.model->bodies().end(),
                     [&](const BodyNode& body) { return !flexible(body) || !body.terms || same(*body.terms, terms); });
}

std::optional<Beyond> next_model_up(const Engine& engine, const SceneArguments& arguments) {
  const Scene& scene = engine.scene();
  const auto& bodies = scene.model->bodies();
  if (std::none_of(bodies.begin(), bodies.end(), flexible)) return {};
  if (has_terms_throughout(scene, {StrainOrder::exact, Truncation::none})) return {};
  const bool quadratic = has_terms_throughout(scene, {StrainOrder::quadratic, Truncation::none});
  Beyond beyond{quadratic ? "exact" : "quadratic", scene.model, nullptr};
  SceneOptions options = arguments.options;
  options.formulation = beyond.formulation;
  bool own = false;
  for (const BodyNode& body : bodies) {
    if (!body.terms) continue;
    options.overrides.push_back("bodies." + body.name + ".formulation=" + beyond.formulation);
    own = true;
  }
  try {
    if (own) {
      const Scene up = read_scene(arguments.scene, engine.registry(), options);
      beyond.model = up.model;
      beyond.equations = up.formulation->compile(up.model);
    } else {
      Diagnostics diagnostics;
      const auto* plugin = engine.registry().find<Formulation>(beyond.formulation);
      if (plugin == nullptr) return {};
      beyond.equations = plugin->make(Value::map({}), {engine.registry(), diagnostics})->compile(scene.model);
    }
  } catch (const std::invalid_argument&) {
    return {};  // a body without exact kinematics
  }
  return beyond;
}

std::unique_ptr<Integrator> make_integrator(Registry& registry, const std::string& id, Value options) {
  const auto* plugin = registry.find<Integrator>(id);
  if (plugin == nullptr) throw InputError("no integrator '" + id + "'");
  for (const ParameterSpec& spec : plugin->parameters) {
    if (spec.fallback && !options.has(spec.key)) options.set(spec.key, *spec.fallback);
  }
  Diagnostics diagnostics;
  auto made = plugin->make(options, {registry, diagnostics});
  if (made == nullptr) throw InputError("integrator '" + id + "': " + diagnostics.errors().front().message);
  return made;
}

}  // namespace withy::app
