#include "withy/study/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <unordered_set>

#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/mode_basis.hpp"
#include "withy/study/tip_load.hpp"
#include "withy/study/unfit.hpp"

namespace withy::study {
namespace {

/// A basis that is complete for any clamped beam, whatever it carries. Where that is much, the tip's static shapes and
/// modes with a fixed tip need fewer than polynomials, and the fastest of n has a frequency like n², not n⁴.
constexpr const char* static_shapes = "craig-bampton";
/// What stands for all formulations where no body is flexible: the one of scenes that name none.
constexpr const char* plain_formulation = "quadratic";

/// Calls with every number of modes that is not zero, and where the family beside it stands.
template <class Function>
void for_each_family(const Scene& scene, Registry& registry, Function&& function) {
  for (const BodyModes& body : scene.modes)
    for (const ModeCount& count : body.counts) {
      const std::string path = count.modes > 0 ? family_path(scene, body.body, count, registry) : "";
      if (const Value* family = family_at(scene, body.body, path)) function(count, *family);
    }
}

/// Whether another basis of clamped beams means the same beams: all that bend are clamped at the root and free at the
/// tip, and those that are bent at the start have a shape along themselves. Damping is no matter: a ratio is that of
/// the modes which the body has by itself, whatever functions they are found in.
bool families_are_exchangeable(const Scene& scene, Registry& registry) {
  bool fit = true;
  for_each_family(scene, registry, [&](const ModeCount& count, const Value& family) {
    fit = fit && (count.family_path.empty() || spans_cantilevers(family, registry));
  });
  const Layout& layout = scene.model->layout();
  for (const BodyNode& node : scene.model->bodies()) {
    const Slot* const slot = layout.body(node.name);
    if (slot == nullptr) continue;
    bool rests = true;
    for (std::size_t i = 0; i < slot->positions; ++i) rests = rests && scene.initial.y[slot->position + i] == 0;
    for (std::size_t i = 0; i < slot->speeds; ++i)
      rests = rests && scene.initial.y[layout.positions + slot->speed + i] == 0;
    const std::vector<double> none(slot->speeds);
    fit = fit && (rests || (!node.segment && same_shape(*node.body, none, *node.body)));
  }
  return fit;
}

/// Whether a beam that bends carries something at its tip.
bool loaded_somewhere(const Scene& scene) {
  const std::vector<Matrix6> loads = tip_loads(*scene.model, scene.initial);
  const auto& bodies = scene.model->bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].body->shape().modes() > 0 && !bodies[b].segment && !loads[b].isZero(0)) return true;
  return false;
}

/// Whether a body with modes has a property that is a table along it.
bool varies_somewhere(const Scene& scene) {
  return std::any_of(scene.modes.begin(), scene.modes.end(),
                     [&](const BodyModes& body) { return varies(scene, body.body); });
}

/// Families that may need fewer modes than the scene's own, where they mean the same beams.
std::vector<const char*> other_families(const Scene& scene) {
  const bool loaded = loaded_somewhere(scene);
  std::vector<const char*> others{loaded ? static_shapes : polynomials};
  if (loaded || varies_somewhere(scene)) others.push_back(vibration_modes);
  if (loaded) others.push_back(loaded_modes);
  return others;
}

/// The id that a family's value names.
std::string id_of(const Value& family) {
  return family.kind() == Value::Kind::text ? family.text() : family.text_at("name");
}

/// Those that there are: some come with libraries that need not be installed.
std::vector<std::string> usual_integrators(Registry& registry) {
  std::vector<std::string> ids = {"dopri5", "dop853", "imex", "radau", "cvode"};
  std::erase_if(ids, [&](const std::string& id) {
    try {
      return registry.find<Integrator>(id) == nullptr;
    } catch (const PluginError&) {
      return true;
    }
  });
  return ids;
}

void check(const Axes& axes, Registry& registry) {
  check_axes(axes);
  for (const std::string& f : axes.formulations) {
    if (!make_formulation(registry, f)->standing().studied)
      throw OptionError("formulations",
                        "'" + f + "' is never advised: it is there to be compared. See withy trade for its error");
  }
  constexpr double any = 1e-3;
  for (const std::string& i : axes.integrators) static_cast<void>(make_integrator(registry, i, any));
}

}  // namespace

Axes usual_axes() { return {{}, {}, {}, {}, {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}, {}}; }

Axes trade_axes(Axes asked, const Scene& scene, Registry& registry) {
  check_axes(asked);
  if (asked.formulations.empty()) asked.formulations = studied_formulations(registry);
  if (asked.families.empty()) asked.families = {""};
  if (asked.modes.empty()) asked.modes = {1, 2, 3};
  if (scene.modes.empty()) asked.modes = {0};
  if (asked.integrators.empty()) asked.integrators = {"dopri5", "imex"};
  if (asked.tolerances.empty()) asked.tolerances = {1e-4, 1e-6};
  return asked;
}

Candidates candidates_for(const Prepared& prepared, Registry& registry, Axes asked) {
  Candidates c{std::move(asked), {}, {}};
  if (c.modes.empty()) {
    c.modes = {1, 2, 3, 4};
    c.more_modes = {5, 6, 7, 8};
    c.most_modes = {9, 10, 11, 12, 13, 14, 15, 16};
  }
  if (c.formulations.empty()) {
    c.formulations = studied_formulations(registry);
    // Strict forms cannot close loops.
    if (!loops_of(prepared.model()).empty()) take_out_unfit(prepared.scene.model, registry, c.formulations);
  }
  if (c.integrators.empty()) c.integrators = usual_integrators(registry);
  check(c, registry);
  const Scene& scene = prepared.scene;
  if (!flexible(prepared.model())) c.formulations = {plain_formulation};  // without modes all are the same
  bool any = false;
  std::vector<const char*> others = other_families(scene), had = others;
  for_each_family(scene, registry, [&](const ModeCount& count, const Value& family) {
    if (count.family_path.empty() && !spans_cantilevers(family, registry)) return;
    any = true;
    std::erase_if(had, [&](const char* other) { return id_of(family) != other; });
  });
  std::erase_if(others, [&](const char* other) { return std::find(had.begin(), had.end(), other) != had.end(); });
  if (scene.modes.empty()) {
    c.modes = {0};
    c.more_modes.clear();
    c.most_modes.clear();
  }
  if (!any) c.families = {""};
  if (c.families.empty()) {
    c.families = {""};
    if (families_are_exchangeable(scene, registry)) c.families.insert(c.families.end(), others.begin(), others.end());
  }
  std::sort(c.tolerances.begin(), c.tolerances.end(), std::greater<>());
  std::sort(c.modes.begin(), c.modes.end());
  return c;
}

ReferenceFamilies reference_families(const Candidates& candidates, const Prepared& prepared) {
  const auto& all = candidates.families;
  const auto among = [&](const char* family) { return std::find(all.begin(), all.end(), family) != all.end(); };
  const Model& model = prepared.model();
  const bool loaded = std::any_of(model.hinges().begin(), model.hinges().end(), [&](const HingeNode& hinge) {
    return hinge.parent >= 0 && model.bodies()[static_cast<std::size_t>(hinge.parent)].body->shape().modes() > 0;
  });
  const bool varies = varies_somewhere(prepared.scene);
  // Where it is not among them it is the scene's own family.
  const char* const of_the_beam = among(vibration_modes) ? vibration_modes : "";
  const char* const of_even_ones = among(static_shapes) ? static_shapes : among(polynomials) ? polynomials : "";
  std::vector<std::string> others = all;
  if (loaded) {
    const char* const knows = varies ? of_the_beam : loaded_modes;
    std::erase_if(others,
                  [&](const std::string& family) { return family != knows && (!varies || family != of_even_ones); });
  }
  // Functions of even beams may come near a beam that varies so evenly that their series seem to lead to the truth.
  return {varies ? of_the_beam : of_even_ones, std::move(others)};
}

std::vector<std::string> flexible_bodies(const Scene& scene) {
  std::unordered_set<std::string> flexible;
  for (const BodyNode& b : scene.model->bodies())
    if (b.body->shape().modes() > 0) flexible.insert(b.scene_name());
  std::vector<std::string> names;
  for (const auto& [name, body] : scene.source.at("bodies").members())
    if (flexible.contains(name)) names.push_back(name);
  return names;
}

void require_a_run(const Scene& scene) {
  if (!scene.end || *scene.end > scene.initial.time) return;  // without an end others say so
  throw InputError(
      fmt::format("{}: /time/end: the run ends at {:g} s, where it begins: nothing moves that an error could be of",
                  scene.file, *scene.end));
}

}  // namespace withy::study
