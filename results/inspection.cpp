#include "withy/results/inspection.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/tree/rigid_inertia.hpp"
#include "withy/results/certificate_json.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/json_text.hpp"
#include "withy/study/formulation_meaning.hpp"
#include "withy/study/indicators.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// What the scene says of one of its bodies, hinges or loads under `key`; empty where it says nothing.
std::string said(const Scene& scene, const char* group, const std::string& name, const char* key) {
  const Value* const all = scene.source.find(group);
  const Value* const one = all != nullptr ? all->find(name) : nullptr;
  const Value* const text = one != nullptr ? one->find(key) : nullptr;
  return text != nullptr ? text->text() : std::string();
}

/// The formulation that a body has of its own, by name or by its two choices; empty where it has the scene's.
std::string own_formulation(const Scene& scene, const std::string& body) {
  const Value* const one = scene.source.at("bodies").find(body);
  const Value* const own = one != nullptr ? one->find("formulation") : nullptr;
  return own != nullptr && own->kind() != Value::Kind::null ? study::formulation_title(*own) : std::string();
}

/// Plugin id of a body, hinge or load: "beam".
std::string type_of(const Scene& scene, const char* group, const std::string& name) {
  return said(scene, group, name, "type");
}

/// Where a hinge is fixed on its parent: "world", "link1.tip". A weld between segments names the segment.
std::string parent_of(const Model& model, const HingeNode& hinge) {
  if (hinge.parent < 0) return "world";
  const BodyNode& parent = model.bodies()[static_cast<std::size_t>(hinge.parent)];
  const BodyNode& child = model.bodies()[static_cast<std::size_t>(hinge.child)];
  const bool inside = parent.segment && child.segment && parent.segment->whole == child.segment->whole;
  return (inside ? parent.name : parent.scene_name()) + '.' +
         parent.frames[static_cast<std::size_t>(hinge.parent_frame)].name;
}

/// ", reflected inertia 0.3 kg m²"; empty where there is none.
std::string reflected_text(const HingeNode& hinge) {
  if (hinge.reflected_inertia == 0) return {};
  return fmt::format(", reflected inertia {:.6g} {}", hinge.reflected_inertia,
                     hinge_rates(*hinge.hinge).front().angular ? "kg m²" : "kg");
}

Json bodies_json(const Scene& scene) {
  const Model& model = *scene.model;
  Json bodies = Json::array();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& body = model.bodies()[b];
    const HingeNode& hinge = model.hinges()[b];
    const std::string own = own_formulation(scene, body.scene_name());
    // The welds between segments are not in the scene.
    const std::string hinge_type = type_of(scene, "hinges", hinge.name);
    bodies.push_back({{"name", body.name},
                      {"type", type_of(scene, "bodies", body.scene_name())},
                      {"mass", rigid_inertia(body.body->shape()).mass},
                      {"modes", body.body->shape().mode_names},
                      {"remarks", body.body->remarks()},
                      {"formulation", own.empty() ? study::formulation_title(scene) : own},
                      {"hinge",
                       {{"name", hinge.name},
                        {"type", hinge_type.empty() ? "weld" : hinge_type},
                        {"parent", parent_of(model, hinge)},
                        {"child_frame", body.frames[static_cast<std::size_t>(hinge.child_frame)].name},
                        {"speeds", hinge.hinge->speeds()},
                        {"reflected_inertia", hinge.reflected_inertia}}}});
  }
  return bodies;
}

/// Loops with the count of their equations at the state, and the degrees of freedom that they leave; null of trees.
Json loops_json(const study::Prepared& prepared, const State& state) {
  const auto* loops = dynamic_cast<const ClosedLoops*>(prepared.equations.get());
  if (loops == nullptr) return {};
  const Model& model = prepared.model();
  Work work = prepared.equations->make_work();
  std::size_t free = model.layout().speeds;
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.driven(h)) free -= model.layout().hinges[h].speeds;
  Json all = Json::array();
  for (const LoopCount& count : loops->counts(state.y, work)) {
    free -= count.independent;
    all.push_back({{"name", count.name},
                   {"hinge", said(prepared.scene, "constraints", count.name, "hinge")},
                   {"a", said(prepared.scene, "constraints", count.name, "a")},
                   {"b", said(prepared.scene, "constraints", count.name, "b")},
                   {"equations", count.equations},
                   {"independent", count.independent}});
  }
  const Value* closing = prepared.scene.source.find("closing");
  return {{"list", std::move(all)},
          {"degrees_of_freedom", free},
          {"remark", closing != nullptr ? Json(closing->text()) : Json()}};
}

/// Directions along which less than this of the coordinates' own inertia is left are shown.
constexpr double nearly_massless = 1e-2;

/// Null where there is no matrix, or a larger one than runs look at.
Json mass_matrix_json(const study::Prepared& prepared, const State& state) {
  const std::size_t size = prepared.model().layout().speeds;
  if (size == 0 || size > largest_examined) return {};
  const DenseSystem system = prepared.equations->system(state.time, state.y);
  const Conditioning c = conditioning(system);
  const AttainableAccuracy a = attainable_accuracy(system);
  Json massless = Json::array();
  for (const MasslessDirection& d : massless_directions(prepared.model(), system, nearly_massless))
    massless.push_back({{"made_up_of", d.owners}, {"inertia_left", d.share}, {"frequency", d.frequency}});
  const std::optional<Removal> removal =
      massless.empty() ? std::optional<Removal>() : best_removal(prepared.model(), system);
  return {{"condition", c.condition},
          {"condition_times_epsilon", c.condition * std::numeric_limits<double>::epsilon()},
          {"scaled_condition", a.condition},
          {"attainable_accuracy", a.accuracy},
          {"determinant_sign", c.determinant_sign},
          {"smallest_eigenvalue", c.smallest_eigenvalue},
          {"nearly_massless", std::move(massless)},
          {"without_mode", removal ? Json{{"mode", removal->mode}, {"scaled_condition", removal->condition}} : Json()}};
}

}  // namespace

Json inspection_json(const study::Prepared& prepared, const State& given, Registry& registry,
                     const std::vector<LoadedPlugin>& plugins) {
  const Scene& scene = prepared.scene;
  const State state = begun(prepared.model(), *prepared.equations, given);
  Json j;
  j["scene"] = scene.file;
  j["name"] = scene.name;
  const study::FormulationWords formulation = study::formulation_words_of(scene, registry);
  j["formulation"] = {{"name", formulation.name}, {"title", formulation.title}, {"meaning", formulation.meaning}};
  j["integrator"] = value_json(scene.source.at("integrator"));
  j["bodies"] = bodies_json(scene);
  j["loads"] = Json::array();
  for (const LoadNode& load : prepared.model().loads())
    if (dynamic_cast<const LoopClosure*>(load.load.get()) == nullptr && load.name != name_of_event_states &&
        hosted_motion(*load.load) == nullptr)
      j["loads"].push_back({{"name", load.name}, {"type", type_of(scene, "loads", load.name)}});
  if (Json loops = loops_json(prepared, state); !loops.is_null()) j["constraints"] = std::move(loops);
  j["motions"] = Json::array();
  for (const MotionNode& motion : prepared.model().motions())
    j["motions"].push_back({{"name", motion.name},
                            {"type", type_of(scene, "motions", motion.name)},
                            {"hinge", prepared.model().hinges()[static_cast<std::size_t>(motion.hinge)].name}});
  j["outputs"] = Json::array();
  for (const SensorNode& sensor : scene.outputs) {
    Json components = Json::array();
    for (const SensorColumn& column : sensor.sensor->columns())
      components.push_back({{"component", column.component}, {"unit", column.unit}});
    j["outputs"].push_back({{"name", sensor.name},
                            {"type", type_of(scene, "outputs", sensor.name)},
                            {"components", std::move(components)}});
  }
  j["coordinates"] = prepared.model().layout().speed_names;
  j["families"] = families_json(study::families_of(scene));
  j["compiled"] = prepared.equations->savings();
  j["mass_matrix"] = mass_matrix_json(prepared, state);
  j["indicators"] = indicators_json(study::indicators_at(prepared, state));
  j["plugins"] = Json::array();
  for (const LoadedPlugin& p : plugins) j["plugins"].push_back({{"name", p.name}, {"file", p.file}});
  return j;
}

namespace {

/// What a line of the tree stands for: a body, or all segments of one that was cut.
struct Branch {
  int held = 0;  ///< the body that the scene's hinge holds
  std::size_t segments = 1;
  double mass = 0;
  std::size_t modes = 0;
};

/// Branches by the index of the body held, and of which branch each body is part.
std::map<int, Branch> branches(const Model& model, std::vector<int>& branch_of) {
  std::map<int, Branch> all;
  branch_of.resize(model.bodies().size());
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& body = model.bodies()[b];
    // Parents come first: the first segment seen is the one that the others hang on.
    int held = static_cast<int>(b);
    for (const int other : body.segment ? model.segments(body.segment->whole) : std::vector<int>{})
      held = std::min(held, other);
    branch_of[b] = held;
    Branch& branch = all[held];
    branch.held = held;
    branch.segments = body.segment ? body.segment->count : 1;
    branch.mass += rigid_inertia(body.body->shape()).mass;
    branch.modes += body.body->shape().mode_names.size();
  }
  return all;
}

/// The tree without recursion: chains may be long.
std::string tree_text(const Scene& scene) {
  const Model& model = *scene.model;
  std::vector<int> branch_of;
  const std::map<int, Branch> all = branches(model, branch_of);
  std::map<int, std::vector<int>> children;
  for (const auto& [held, branch] : all) {
    const int parent = model.hinges()[static_cast<std::size_t>(held)].parent;
    children[parent < 0 ? -1 : branch_of[static_cast<std::size_t>(parent)]].push_back(held);
  }
  struct Entry {
    int body;
    std::size_t level;
    std::string indent;
    bool last;
  };
  // Deeper levels are numbered instead of indented: a line is a line, however long the chain.
  constexpr std::size_t most_indented = 16;
  std::vector<Entry> open;
  const auto push_children = [&](int parent, std::size_t level, const std::string& indent) {
    const auto& below = children[parent];
    for (std::size_t i = below.size(); i-- > 0;) open.push_back({below[i], level, indent, i + 1 == below.size()});
  };
  std::string out = "world\n";
  push_children(-1, 1, "");
  while (!open.empty()) {
    const Entry e = open.back();
    open.pop_back();
    const Branch& branch = all.at(e.body);
    const BodyNode& body = model.bodies()[static_cast<std::size_t>(e.body)];
    const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(e.body)];
    const std::string own = own_formulation(scene, body.scene_name());
    out += fmt::format("{}{} {}{}: {}{}, {:.6g} kg{}   [{}: {} at {}{}{}]\n", e.indent, e.last ? "└─" : "├─",
                       e.level > most_indented ? fmt::format("(level {}) ", e.level) : "", body.scene_name(),
                       type_of(scene, "bodies", body.scene_name()),
                       branch.segments > 1 ? fmt::format(" in {} segments", branch.segments) : "", branch.mass,
                       branch.modes > 0 ? fmt::format(", {} mode{}", branch.modes, branch.modes > 1 ? "s" : "") : "",
                       hinge.name, type_of(scene, "hinges", hinge.name), parent_of(model, hinge), reflected_text(hinge),
                       own.empty() ? "" : ", formulation " + own);
    push_children(e.body, e.level + 1, e.level < most_indented ? e.indent + (e.last ? "   " : "│  ") : e.indent);
  }
  return out;
}

/// "dopri5, rtol 1e-06, atol 1e-09".
std::string integrator_text(const Json& integrator) {
  std::string out;
  for (const auto& [key, value] : integrator.items()) {
    const std::string text = plain_text(value);
    out += key == "name" ? text : ", " + key + ' ' + text;
  }
  return out;
}

/// What each constraint closes, and what remains.
std::string loops_text(const Json& loops) {
  std::string out;
  for (const Json& loop : loops["list"])
    out += fmt::format("\nconstraint {}: {} of {} and {}; the loop closes {} equations, {} independent\n",
                       loop["name"].get<std::string>(), loop["hinge"].get<std::string>(), loop["a"].get<std::string>(),
                       loop["b"].get<std::string>(), loop["equations"].get<std::size_t>(),
                       loop["independent"].get<std::size_t>());
  out += fmt::format("  {} degrees of freedom remain\n", loops["degrees_of_freedom"].get<std::size_t>());
  if (!loops["remark"].is_null()) out += "  " + loops["remark"].get<std::string>() + '\n';
  return out;
}

/// Each output with its components.
std::string outputs_text(const Json& outputs) {
  std::string out;
  for (const Json& output : outputs) {
    out += fmt::format("\noutput {}: {}", output["name"].get<std::string>(), output["type"].get<std::string>());
    const char* join = "\n  ";
    for (const Json& c : output["components"]) {
      out += fmt::format("{}{}[{}]", join, c["component"].get<std::string>(), c["unit"].get<std::string>());
      join = " ";
    }
    out += '\n';
  }
  return out;
}

/// Condition, sign and weak directions of the mass matrix.
std::string matrix_text(const Json& m) {
  std::string out;
  const int sign = m["determinant_sign"].get<int>();
  out += fmt::format(
      "\nmass matrix M at this state\n  condition {:.4g}, with each coordinate in the unit of its own inertia "
      "{:.4g}; digits "
      "lost: accelerations are good to {:.1g}\n  det M is {}; smallest eigenvalue of its symmetric part {:.4g}\n",
      m["condition"].get<double>(), m["scaled_condition"].get<double>(), m["attainable_accuracy"].get<double>(),
      sign > 0 ? "positive" : (sign < 0 ? "negative" : "zero"), m["smallest_eigenvalue"].get<double>());
  for (const Json& d : m["nearly_massless"])
    out +=
        fmt::format("  nearly massless: {}; {:.2g} of their inertia is left, {:.4g} rad/s\n",
                    d["made_up_of"].get<std::string>(), d["inertia_left"].get<double>(), d["frequency"].get<double>());
  if (!m["without_mode"].is_null())
    out +=
        fmt::format("  without {} the condition is {:.2g}; modes that know the load: docs/ill-conditioning.md\n",
                    m["without_mode"]["mode"].get<std::string>(), m["without_mode"]["scaled_condition"].get<double>());
  return out;
}

/// Against the limits of the formulation, at this state alone.
std::string limits_at_text(const Json& indicators) {
  std::string out;
  for (const Json& i : indicators)
    out += fmt::format("  {}: {:.2g}, limit {:.3g}\n", i["what"].get<std::string>(), i["value"].get<double>(),
                       i["limit"].get<double>());
  return out.empty() ? out : "\nvalidity at this state, before anything has moved\n" + out;
}

}  // namespace

std::string inspection_text(const Scene& scene, const Json& j) {
  const Json& formulation = j["formulation"];
  std::string out = fmt::format("{} ({})\nformulation {}: {}\nintegrator {}\n\n", j["name"].get<std::string>(),
                                j["scene"].get<std::string>(), formulation["title"].get<std::string>(),
                                formulation["meaning"].get<std::string>(), integrator_text(j["integrator"]));
  out += tree_text(scene);
  const auto list = [&](const std::string& head, const char* key) {
    out += '\n' + head + '\n';
    for (const Json& item : j[key]) out += "  " + item.get<std::string>() + '\n';
  };
  list(fmt::format("{} coordinates", j["coordinates"].size()), "coordinates");
  if (const auto families = study::families_of(scene); !families.empty())
    out += "\nmodes\n  " + families_text(families) + '\n';
  list("compiled", "compiled");
  for (const Json& body : j["bodies"]) {
    if (body["remarks"].empty()) continue;
    out += fmt::format("\nof body {}\n", body["name"].get<std::string>());
    for (const Json& remark : body["remarks"]) out += "  " + remark.get<std::string>() + '\n';
  }
  for (const Json& load : j["loads"])
    out += fmt::format("\nload {}: {}\n", load["name"].get<std::string>(), load["type"].get<std::string>());
  for (const Json& motion : j["motions"])
    out += fmt::format("\nmotion {}: {} of hinge {}\n", motion["name"].get<std::string>(),
                       motion["type"].get<std::string>(), motion["hinge"].get<std::string>());
  if (j.contains("constraints")) out += loops_text(j["constraints"]);
  out += outputs_text(j["outputs"]);
  if (!j["mass_matrix"].is_null()) out += matrix_text(j["mass_matrix"]);
  out += limits_at_text(j["indicators"]);
  out += "\nplugins loaded\n";
  for (const Json& p : j["plugins"])
    out += fmt::format("  {}  {}\n", p["name"].get<std::string>(), p["file"].get<std::string>());
  return out;
}

}  // namespace withy
