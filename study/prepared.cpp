#include "withy/study/prepared.hpp"

#include <algorithm>
#include <limits>

#include "withy/core/model/compiled_model.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/scene/scene_parts.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/own_instants.hpp"
#include "withy/study/point.hpp"

namespace withy::study {
namespace {

bool has_modes(const BodyNode& body) { return body.body->shape().modes() > 0; }

/// A plugin's object, options at their defaults but for those given.
template <class Interface>
std::shared_ptr<const Interface> make_with_defaults(Registry& registry, const std::string& id, Value options) {
  const std::string name = std::string(kind_name<Interface>()) + " '" + id + "'";
  const auto* plugin = registry.find<Interface>(id);
  if (plugin == nullptr) throw InputError("no " + name);
  for (const ParameterSpec& spec : plugin->parameters) {
    if (spec.fallback && !options.has(spec.key)) options.set(spec.key, *spec.fallback);
    if (spec.required && !spec.fallback && !options.has(spec.key)) throw InputError(name + " needs '" + spec.key + "'");
  }
  Diagnostics diagnostics;
  FloatingPointGuard arithmetic;
  std::shared_ptr<const Interface> made = plugin->make(options, {registry, diagnostics});
  arithmetic.check(name);
  if (made != nullptr) return made;
  throw InputError(name + ": " + (diagnostics.ok() ? "cannot be made" : diagnostics.errors().front().message));
}

/// What a study sets as a tolerance must be one: an integrator without it would run at another accuracy.
void require_tolerance(const Plugin<Integrator>& plugin) {
  for (const char* key : {"rtol", "atol"})
    if (std::none_of(plugin.parameters.begin(), plugin.parameters.end(),
                     [&](const ParameterSpec& spec) { return spec.key == key; }))
      throw InputError("integrator '" + plugin.id + "' has no parameter '" + key +
                       "': studies set tolerances by 'rtol' and 'atol', and know of no other");
}

/// Of the scene's formulation and those of single bodies.
int least_rank(const Scene& scene) {
  int rank = scene.formulation->standing().rank;
  for (const BodyNode& body : scene.model->bodies())
    if (has_modes(body) && body.terms) rank = std::min(rank, rank_of(*body.terms));
  return rank;
}

/// What energy may be off where every body conserves it: hundredths by steps of any length that is chosen well, and
/// what a loose tolerance leaves.
double drift_limit(const Scene& scene) {
  constexpr double least = 0.05, most = 0.5, of_tolerance = 50;
  // The symmetric truncation conserves an energy whose weight has no terms of third order: drift is looked at without.
  const bool weightless = scene.model->gravity().isZero(0);
  const auto conserves = [&](const Terms& t) {
    return (t.truncation == Truncation::none || (t.truncation == Truncation::symmetric && weightless)) &&
           t.products_of_speeds;
  };
  const std::vector<Terms> terms = terms_in_use(scene);
  const bool all = scene.formulation_name != "auto" && std::all_of(terms.begin(), terms.end(), conserves);
  if (!all && flexible(*scene.model)) return std::numeric_limits<double>::infinity();
  const Value* rtol = scene.source.at("integrator").find("rtol");
  return rtol != nullptr ? std::clamp(of_tolerance * rtol->number(), least, most) : least;
}

/// Whether modes move a body, its own or those of what carries it.
bool moved_by_modes(const Model& model, int body) {
  for (; body >= 0; body = model.hinges()[static_cast<std::size_t>(body)].parent)
    if (model.bodies()[static_cast<std::size_t>(body)].body->shape().modes() > 0) return true;
  return false;
}

/// Whether the symmetric truncation costs less than no truncation: where a body has at least four modes (measured: 1.2
/// times as much with two a body, 0.8 with six), and no load acts at a frame that modes move, whose efforts it needs to
/// second order (a boom of five modes in space: 0.5 times as much without, 2.5 with a force at its tip).
bool worth_symmetric(const Model& model) {
  constexpr Eigen::Index many = 4;
  const auto frames_moved = [&](const LoadNode& load) {
    const auto frames = load.load->frames();
    return std::any_of(frames.begin(), frames.end(), [&](FrameIndex f) { return moved_by_modes(model, f.body); });
  };
  const auto& bodies = model.bodies();
  return std::any_of(bodies.begin(), bodies.end(), [](const BodyNode& b) { return b.body->shape().modes() >= many; }) &&
         std::none_of(model.loads().begin(), model.loads().end(), frames_moved);
}

void make_rungs(Prepared& prepared, Registry& registry) {
  for (const RankedFormulation& rung : formulations_by_rank(registry)) {
    const Truncation truncation = rung.formulation->terms().truncation;
    if (!rung.standing.studied || truncation == Truncation::strict) continue;
    if (truncation == Truncation::symmetric && !worth_symmetric(prepared.model())) continue;
    try {
      prepared.rung_equations.push_back(compile_model(*rung.formulation, prepared.scene.model));
    } catch (const std::invalid_argument&) {
      continue;  // a body without exact kinematics: the ladder ends before it
    }
    prepared.scene.sources.add(
        {std::string(kind_name<Formulation>()), rung.id, registry.find<Formulation>(rung.id)->origin});
    prepared.rungs.push_back({rung.id, rung.formulation->terms(), prepared.rung_equations.back().get()});
  }
}

/// The scene of these values, compiled.
Prepared compiled(SceneValues values, Scene scene, Registry& registry) {
  Prepared prepared{std::move(values), std::move(scene), nullptr, {}, {}};
  try {
    prepared.equations = compile_model(*prepared.scene.formulation, prepared.scene.model);
  } catch (const std::invalid_argument& e) {
    throw InputError(prepared.scene.file + ": formulation " + prepared.scene.formulation_name + ": " + e.what());
  }
  if (prepared.scene.formulation_name == "auto") {
    if (EventBook(prepared.model()).any())
      throw InputError(prepared.scene.file + ": /events: " + own_instants(prepared.model()) +
                       "; 'auto' compares formulations along the run and takes no such event: name one formulation");
    make_rungs(prepared, registry);
    if (prepared.rungs.empty()) throw InputError(prepared.scene.file + ": formulation auto: no formulation is found");
  }
  return prepared;
}

}  // namespace

Prepared prepare(SceneValues values, Registry& registry) {
  Scene scene = make_scene(values, registry);
  return compiled(std::move(values), std::move(scene), registry);
}

Prepared prepare(SceneValues values, Registry& registry, SceneParts& parts) {
  Scene scene = make_scene(values, registry, parts);
  return compiled(std::move(values), std::move(scene), registry);
}

void check_one_formulation(const Prepared& prepared, const std::string& who) {
  if (!prepared.escalates()) return;
  throw InputError(prepared.scene.file + ": /formulation: got 'auto', which changes the equations along a run; " + who +
                   " needs one formulation by name");
}

std::string use_threads(Prepared& prepared, std::size_t threads) {
  if (prepared.escalates()) return "the formulation changes along a run";
  BranchEquations branched = on_threads(prepared.equations, threads);
  if (branched.equations != nullptr) prepared.equations = std::move(branched.equations);
  return branched.refusal;
}

std::vector<Terms> terms_in_use(const Scene& scene) {
  std::vector<Terms> all{scene.formulation->terms()};
  for (const BodyNode& body : scene.model->bodies())
    if (body.terms) all.push_back(*body.terms);
  return all;
}

bool has_own_energy(const Scene& scene) { return scene.formulation->terms().truncation == Truncation::symmetric; }

RunOptions run_options(const Scene& scene) {
  RunOptions options;
  options.end = end_of_run(scene);
  options.output = scene.output;
  options.deflection_limit = scene.deflection_limit;
  options.events = scene.events;
  options.drift_limit = drift_limit(scene);
  options.own_energy = has_own_energy(scene);
  const Value* atol = scene.source.at("integrator").find("atol");
  constexpr double of_atol = 1e3;
  if (atol != nullptr) options.least_speed = std::max(options.least_speed, of_atol * atol->number());
  return options;
}

std::shared_ptr<const Formulation> make_formulation(Registry& registry, const std::string& id) {
  return make_with_defaults<Formulation>(registry, id, Value::map({}));
}

std::shared_ptr<const Integrator> make_integrator(Registry& registry, const std::string& id, Value options) {
  return make_with_defaults<Integrator>(registry, id, std::move(options));
}

std::shared_ptr<const Integrator> make_integrator(Registry& registry, const std::string& id, double tolerance) {
  if (const auto* plugin = registry.find<Integrator>(id)) require_tolerance(*plugin);
  return make_integrator(registry, id,
                         Value::map({{"rtol", Value(tolerance)}, {"atol", Value(absolute_tolerance(tolerance))}}));
}

Beyond compile_throughout(const Prepared& prepared, Registry& registry, const std::string& formulation) {
  const Scene& scene = prepared.scene;
  const auto& bodies = scene.model->bodies();
  if (std::none_of(bodies.begin(), bodies.end(), [](const BodyNode& b) { return b.terms.has_value(); }))
    return {formulation, scene.model, compile_model(*make_formulation(registry, formulation), scene.model), false};
  SceneValues values = prepared.values;
  for (const BodyNode& body : bodies) {
    const std::string& name = body.scene_name();
    if (body.terms) values.body_formulation(name, formulation, "every body in one formulation");
  }
  const Scene all = make_scene(values.choose_formulation(formulation, "every body in one formulation"), registry);
  return {formulation, all.model, compile_model(*all.formulation, all.model), false};
}

std::optional<Beyond> next_model_up(const Prepared& prepared, Registry& registry) {
  if (!flexible(prepared.model())) return {};
  const int rank = least_rank(prepared.scene);
  const std::vector<RankedFormulation> rungs = formulation_rungs(registry);
  for (const RankedFormulation& rung : rungs) {
    if (rung.standing.rank <= rank) continue;
    try {
      Beyond beyond = compile_throughout(prepared, registry, rung.id);
      beyond.highest = rung.id == rungs.back().id;
      return beyond;
    } catch (const std::invalid_argument&) {
      continue;  // a body without exact kinematics
    }
  }
  return {};
}

std::optional<std::string> next_rung(Registry& registry, const std::string& formulation) {
  const int rank = make_formulation(registry, formulation)->standing().rank;
  for (const RankedFormulation& rung : formulation_rungs(registry))
    if (rung.standing.rank > rank) return rung.id;
  return {};
}

std::string why_no_derivatives(const Prepared& prepared) {
  if (dynamic_cast<const ClosedLoops*>(prepared.equations.get()) != nullptr)
    return "equations whose constraints close loops have no derivatives: take differences";
  return "formulation '" + prepared.scene.formulation_name + "' has no derivatives: take differences";
}

bool flexible(const Model& model) { return std::any_of(model.bodies().begin(), model.bodies().end(), has_modes); }

}  // namespace withy::study
