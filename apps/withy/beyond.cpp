#include "withy/apps/withy/beyond.hpp"

#include <algorithm>

#include "withy/core/plugin/formulation.hpp"

namespace withy::app {
namespace {

bool same(const Terms& a, const Terms& b) {
  return a.strain == b.strain && a.truncation == b.truncation && a.products_of_speeds == b.products_of_speeds;
}

bool has_modes(const BodyNode& body) { return body.body->shape().modes() > 0; }

}  // namespace

bool has_terms_throughout(const Scene& scene, Terms terms) {
  return same(scene.formulation->terms(), terms) &&
         std::all_of(scene.model->bodies().begin(), scene.model->bodies().end(),
                     [&](const BodyNode& body) { return !has_modes(body) || !body.terms || same(*body.terms, terms); });
}

Beyond compile_throughout(const Engine& engine, const SceneArguments& arguments, const std::string& formulation) {
  const Scene& scene = engine.scene();
  Beyond compiled{formulation, scene.model, nullptr};
  SceneOptions options = arguments.options;
  options.formulation = formulation;
  bool own = false;
  for (const BodyNode& body : scene.model->bodies()) {
    if (!body.terms) continue;
    options.overrides.push_back("bodies." + body.name + ".formulation=" + formulation);
    own = true;
  }
  if (own) {
    const Scene all = read_scene(arguments.scene, engine.registry(), options);
    compiled.model = all.model;
    compiled.equations = all.formulation->compile(all.model);
    return compiled;
  }
  const auto* plugin = engine.registry().find<Formulation>(formulation);
  if (plugin == nullptr) throw InputError("no formulation '" + formulation + "'");
  Diagnostics diagnostics;
  compiled.equations = plugin->make(Value::map({}), {engine.registry(), diagnostics})->compile(scene.model);
  return compiled;
}

std::optional<Beyond> next_model_up(const Engine& engine, const SceneArguments& arguments) {
  const Scene& scene = engine.scene();
  const auto& bodies = scene.model->bodies();
  if (std::none_of(bodies.begin(), bodies.end(), has_modes)) return {};
  if (has_terms_throughout(scene, {StrainOrder::exact, Truncation::none})) return {};
  const bool quadratic = has_terms_throughout(scene, {StrainOrder::quadratic, Truncation::none});
  try {
    return compile_throughout(engine, arguments, quadratic ? "exact" : "quadratic");
  } catch (const std::invalid_argument&) {
    return {};  // a body without exact kinematics
  }
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
