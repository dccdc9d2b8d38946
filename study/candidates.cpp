#include "withy/study/candidates.hpp"

#include <algorithm>
#include <functional>

#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// A basis that is complete for any clamped beam, whatever it carries.
constexpr const char* polynomials = "orthogonal-polynomials";

/// Calls with each strain of each beam that has modes: body's map, strain's map.
template <class Function>
void for_each_strain(const Scene& scene, Function&& function) {
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    if (body.text_at("type") != "beam") continue;
    for (const char* strain : {"bending_y", "bending_z", "torsion"}) {
      const Value* s = body.find(strain);
      const Value* modes = s != nullptr ? s->find("modes") : nullptr;
      if (modes != nullptr && modes->number() > 0) function(body, *s, std::string(strain));
    }
  }
}

std::string family_of(const Value& strain) {
  const Value* family = strain.find("family");
  if (family == nullptr) return {};
  return family->kind() == Value::Kind::text ? family->text() : family->text_at("name");
}

/// Whether another basis of clamped beams means the same beams: all are clamped at the root and free at the tip, their
/// damping is not that of single modes, and no modal coordinate has a value at the start.
bool families_are_exchangeable(const Scene& scene) {
  bool fit = true;
  for_each_strain(scene, [&](const Value& body, const Value& strain, const std::string& kind) {
    const std::string family = family_of(strain);
    const Value* damping = body.find("damping_ratio");
    fit = fit && (kind == "torsion" || family == "clamped-free" || family == "clamped-loaded" ||
                  family == "craig-bampton" || family == polynomials);
    fit = fit && (damping == nullptr || damping->number() == 0);
  });
  const Layout& layout = scene.model->layout();
  for (const Slot& body : layout.bodies) {
    for (std::size_t i = 0; i < body.positions; ++i) fit = fit && scene.initial.y[body.position + i] == 0;
    for (std::size_t i = 0; i < body.speeds; ++i) fit = fit && scene.initial.y[layout.positions + body.speed + i] == 0;
  }
  return fit;
}

bool has_plates(const Scene& scene) {
  const auto& bodies = scene.source.at("bodies").members();
  return std::any_of(bodies.begin(), bodies.end(), [](const auto& b) { return b.second.text_at("type") == "plate"; });
}

void check(const Axes& axes, Registry& registry) {
  check_axes(axes);
  for (const std::string& f : axes.formulations) {
    if (f == "inconsistent")
      throw InputError(
          "formulations: 'inconsistent' is never advised: it has the cost of consistent without its terms. "
          "See withy trade for its error");
    if (registry.find<Formulation>(f) == nullptr) throw InputError("no formulation '" + f + "'");
  }
  for (const std::string& i : axes.integrators)
    if (registry.find<Integrator>(i) == nullptr) throw InputError("no integrator '" + i + "'");
}

}  // namespace

Axes usual_axes() {
  return {{"ruthless", "linear", "consistent", "quadratic", "exact"},
          {},
          {1, 2, 3, 4},
          {"dopri5", "dop853", "imex"},
          {1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
          {}};
}

Candidates candidates_for(const Prepared& prepared, Registry& registry, Axes c) {
  check(c, registry);
  const Scene& scene = prepared.scene;
  if (!flexible(prepared.model())) c.formulations = {"quadratic"};  // all are the same without a flexible body
  bool beams = false, polynomial_already = true;
  for_each_strain(scene, [&](const Value&, const Value& strain, const std::string& kind) {
    beams = true;
    if (kind != "torsion") polynomial_already = polynomial_already && family_of(strain) == polynomials;
  });
  if (!beams && !has_plates(scene)) c.modes = {0};
  if (!beams) c.families = {""};
  if (c.families.empty()) {
    c.families = {""};
    if (!polynomial_already && families_are_exchangeable(scene)) c.families.emplace_back(polynomials);
  }
  std::sort(c.tolerances.begin(), c.tolerances.end(), std::greater<>());
  std::sort(c.modes.begin(), c.modes.end());
  return c;
}

std::string reference_family(const Candidates& candidates) {
  const auto& all = candidates.families;
  return std::find(all.begin(), all.end(), polynomials) != all.end() ? polynomials : "";
}

std::vector<std::string> flexible_bodies(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    const std::string& of = name;
    const auto is_part = [&](const BodyNode& b) {
      return b.body->shape().modes() > 0 && (b.segment ? b.segment->whole : b.name) == of;
    };
    const auto& nodes = scene.model->bodies();
    if (std::any_of(nodes.begin(), nodes.end(), is_part)) names.push_back(name);
  }
  return names;
}

}  // namespace withy::study
