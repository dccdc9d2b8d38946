#include "withy/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <list>
#include <optional>
#include <set>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/model/bound_sensor.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/plugin/file_notes.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/simulation/sensor_probe.hpp"
#include "withy/scene/asked_outputs.hpp"
#include "withy/scene/constraints.hpp"
#include "withy/scene/control_order.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/events.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/names_alone.hpp"
#include "withy/scene/scene_parts.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/scene/span.hpp"
#include "withy/scene/start.hpp"
#include "withy/scene/tree.hpp"

namespace withy {
namespace {

/// \throws std::invalid_argument where a load acts at a frame that the model has not.
void check_frames(const Model& model, const LoadNode& node) {
  const std::string who = "load '" + node.name + "'";
  plugin_call(who + " does not say where it acts", [&] {
    for (const FrameIndex& at : node.load->frames())
      if (!has_place(model, at))
        throw std::invalid_argument(who + " acts at " + frame_in_words(model, at) + ", which the scene has not");
  });
}

/// Checks one document and makes the scene of it.
class SceneBuilder {
 public:
  SceneBuilder(const Document& document, Registry& registry, SceneSources& sources, SceneParts* parts,
               Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics), parts_(parts), checker_(document, registry, diagnostics) {
    checker_.note(&sources);
    checker_.remember(parts);
    if (parts != nullptr) parts->begin();
  }

  /// Complete only if no problem was reported.
  Scene build() {
    const Value& root = document_.root;
    const std::vector<ParameterSpec>& members = grammar::scene_members();
    if (!checker_.is_map(root, [&] { return "a map with " + listed(keys_of(members)); })) return std::move(scene_);
    const Value plain = split(root, members);
    scene_.source = Value::map({}, root.place());
    checker_.read_members(plain, {&members}, scene_.source);
    read_plain_values();
    scene_.formulation = choose<Formulation>("formulation", grammar::default_formulation, scene_.formulation_name);
    scene_.integrator = choose<Integrator>("integrator", grammar::default_integrator, scene_.integrator_name);
    const Value* given_events = scene_.source.find("events");
    SceneEvents events(given_events == nullptr ? Value::map({}) : *given_events, document_, checker_);
    Value hinges = part("hinges");
    events.loosen(hinges);
    SceneTree tree = build_tree(part("bodies"), hinges, root, gravity_, checker_);
    scene_.source.set("bodies", std::move(tree.bodies));
    events.fasten(tree.hinges);
    scene_.source.set("hinges", std::move(tree.hinges));
    scene_.modes = std::move(tree.modes);
    checker_.know(&tree.names);
    known(0, tree.names);
    add_constraints_to(tree);
    add_motions(tree.model.get());
    if (tree.model != nullptr) events.expect_locks(*tree.model);
    name_signals(document_, tree.model.get(), tree.names, checker_.registry());
    known(1, tree.names);
    add_loads(tree.model.get(), events);
    if (const Value* loads = scene_.source.find("loads"); loads != nullptr && tree.model != nullptr)
      refuse_names_of_two(*loads, *tree.model, checker_);
    name_loads(tree);
    add_motion_laws(tree.model.get());
    known(2, tree.names);
    add_outputs(tree);
    unbound_.report(checker_, refused_);
    if (const Value* loads = scene_.source.find("loads"); loads != nullptr && tree.model != nullptr)
      refuse_names_of_load_and_output(*loads, *tree.model, scene_.outputs, checker_);
    if (tree.model != nullptr && diagnostics_.ok()) give_outputs(*tree.model, scene_.outputs, checker_);
    if (tree.model != nullptr && diagnostics_.ok())
      events.add_to(*tree.model, scene_.outputs, scene_.events);
    else
      check_event_names(document_, tree.names, checker_);
    if (tree.model != nullptr && diagnostics_.ok())
      set_start(*tree.model, document_, checker_, scene_);
    else
      check_start_names(document_, tree.names, checker_);
    if (tree.model != nullptr && diagnostics_.ok()) set_span(*tree.model, document_, checker_, scene_);
    scene_.model = std::move(tree.model);
    return std::move(scene_);
  }

 private:
  /// Names are complete for a stage of making the scene.
  void known(std::size_t stage, const SceneNames& names) {
    if (parts_ != nullptr) parts_->know(stage, names);
  }

  /// The members that hold plain values; unknown keys are reported.
  Value split(const Value& root, const std::vector<ParameterSpec>& members) {
    const std::vector<std::string> special = grammar::special_keys();
    std::vector<std::string> known = keys_of(members);
    known.insert(known.end(), special.begin(), special.end());
    Value plain = Value::map({}, root.place());
    for (const auto& [key, value] : root.members()) {
      if (std::find(special.begin(), special.end(), key) != special.end()) continue;
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        checker_.key_error(value.place().path, fmt::format("unknown key {}{}", in_quotes(key), suggestion(key, known)));
      } else {
        plain.members().emplace_back(key, value);
      }
    }
    return plain;
  }

  void read_plain_values() {
    const Value& source = scene_.source;
    if (const Value* name = source.find("name")) {
      scene_.name = name->text();
      if (has_controls(scene_.name))
        diagnostics_.error(name->place(), fmt::format("got {}, with control characters, which a terminal acts on; need "
                                                      "text of one line",
                                                      in_quotes(scene_.name)));
    }
    if (const Value* gravity = source.find("gravity")) {
      const std::vector<double> g = gravity->numbers();
      gravity_ = {g[0], g[1], g[2]};
    }
    if (const Value* time = source.find("time")) scene_.output = time->number_at("output");
    if (const Value* limits = source.find("limits")) scene_.deflection_limit = limits->number_at("deflection");
  }

  /// A map under a key of the scene; an empty one, after reporting, where there is none.
  const Value& part(const std::string& key) {
    const Value* given = document_.root.find(key);
    const Place place = given == nullptr ? document_.key_place("/" + key) : given->place();
    if (given == nullptr && (key == "bodies" || key == "hinges")) {
      diagnostics_.error(place, fmt::format("missing; need a map of {}", key));
    }
    Value& none = none_.emplace_back(Value::map({}, place));
    if (given == nullptr || !checker_.is_map(*given, "a map of names")) return none;
    if (key == "bodies" && given->members().empty()) diagnostics_.error(place, "got none; need at least one body");
    return given->kind() == Value::Kind::map ? *given : none;
  }

  template <class Interface>
  std::shared_ptr<const Interface> choose(const std::string& key, std::string_view otherwise, std::string& name) {
    const Value* given = document_.root.find(key);
    const Value empty = Value::map({}, document_.key_place("/" + key));
    Made<Interface> made;
    const auto value = check_plugin_map<Interface>(given == nullptr ? empty : *given, "name",
                                                   {grammar::choice_name(key, otherwise)}, checker_, made);
    if (!value) return nullptr;
    name = made.plugin->id;
    scene_.source.set(key, *value);
    return make_or_recall(*made.plugin, *value, checker_);
  }

  /// Checks the plugins named under a key of the scene and makes them; `add` gives each to the model if there is one.
  template <class Interface, class Add>
  void add_parts(const std::string& key, const std::vector<ParameterSpec>& members, bool to_model, Add&& add) {
    const Value& parts = part(key);
    Value checked = Value::map({}, parts.place());
    for (const auto& [name, given] : parts.members()) {
      const std::string path = "/" + key + "/" + name;
      const bool asked = key == "outputs" && says_its_name(document_.root, name, given);
      if (const std::string problem = asked ? "" : name_problem(name); !problem.empty()) {
        checker_.key_error(path, fmt::format("got name {}; {}", in_quotes(name), problem));
      }
      Made<Interface> made;
      refused_.insert(name);
      const auto value = check_plugin_map(given, "type", members, checker_, made);
      if (!value) continue;
      auto object = make_or_recall(*made.plugin, *value, checker_);
      const Value& kept = checked.members().emplace_back(name, std::move(made.value)).second;
      if (object == nullptr || !to_model) continue;
      refused_.erase(name);
      try {
        add(name, kept, std::move(object));
      } catch (const std::invalid_argument& e) {
        if (unbound_.concern(name, kept)) continue;
        // What rests on a part that is reported needs no report of its own.
        if (!mentions(kept, refused_)) checker_.key_error(path, e.what());
        refused_.insert(name);
      }
    }
    scene_.source.set(key, std::move(checked));
  }

  void add_constraints_to(SceneTree& tree) {
    if (document_.root.find("constraints") == nullptr) return;
    const Value& constraints = part("constraints");
    const Value* loads = document_.root.find("loads");
    for (const auto& [name, given] : constraints.members())
      if (loads != nullptr && loads->kind() == Value::Kind::map && loads->has(name))
        checker_.key_error("/constraints/" + name, fmt::format("got name {}, which is that of a load; constraints "
                                                               "need their own",
                                                               in_quotes(name)));
    scene_.source.set("constraints", add_constraints(constraints, tree, checker_));
    if (tree.model == nullptr) return;
    for (const auto& [name, given] : constraints.members()) refused_.insert(name);
    for (const LoopClosure* loop : loops_of(*tree.model)) refused_.erase(loop->name());
  }

  void add_loads(Model* model, SceneEvents& events) {
    std::list<PendingLoad> loads;
    std::set<std::string> names;
    if (const Value* given = document_.root.find("loads"))
      for (const auto& [name, load] : given->members()) names.insert(name);
    add_parts<Load>(
        "loads", grammar::load_members(), model != nullptr,
        [&](const std::string& name, const Value& value, std::shared_ptr<const Load> load) {
          loads.push_back({name, needed_loads(value, names, model), events.with_forms(name, std::move(load))});
        });
    // What a load needs that is reported, or what goes round in a circle with it, needs no report of its own.
    for (const PendingLoad& pending : loads) refused_.insert(pending.name);
    for (const PendingLoad& pending : in_order_of_need(std::move(loads), checker_)) {
      refused_.erase(pending.name);
      try {
        model->add_load(pending.name, *pending.load);
        check_frames(*model, model->loads().back());
      } catch (const std::invalid_argument&) {
        unbound_.add(pending.name, *scene_.source.at("loads").find(pending.name));
      }
    }
  }

  /// The loads that other values may refer to, right or wrong; those that close loops are constraints.
  void name_loads(SceneTree& tree) const {
    tree.names.loads = {};
    if (const Value* loads = document_.root.find("loads"))
      for (const auto& [name, given] : loads->members())
        if (refused_.contains(name) || unbound_.has(name)) tree.names.loads.add(name);
    for (const LoadNode& load : tree.model != nullptr ? tree.model->loads() : std::vector<LoadNode>{})
      if (dynamic_cast<const LoopClosure*>(load.load.get()) == nullptr) tree.names.loads.add(load.name);
  }

  void add_motions(Model* model) {
    add_parts<Motion>("motions", grammar::motion_members(), model != nullptr,
                      [&](const std::string& name, const Value& value, std::shared_ptr<const Motion> motion) {
                        model->add_motion(name, value.text_at("hinge"), std::move(motion));
                      });
  }
  /// Behind the loads, which know nothing of them: what hosts set of motions.
  void add_motion_laws(Model* model) {
    const Value* loads = document_.root.find("loads");
    for (const MotionNode& node : model != nullptr ? model->motions() : std::vector<MotionNode>{}) {
      const auto* by_load = dynamic_cast<const MotionByLoad*>(node.motion.get());
      if (by_load == nullptr) continue;
      if (loads != nullptr && loads->kind() == Value::Kind::map && loads->has(node.name)) {
        checker_.key_error("/motions/" + node.name,
                           fmt::format("got name {}, which is that of a load; hosts know inputs by their names",
                                       in_quotes(node.name)));
        continue;
      }
      try {
        model->add_load(node.name, *by_load->load(model->hinges()[static_cast<std::size_t>(node.hinge)].name));
      } catch (const std::invalid_argument& e) {
        checker_.key_error("/motions/" + node.name, e.what());
      }
    }
  }

  /// Sensors. Their names stand beside those of the tree in results and options.
  void add_outputs(const SceneTree& tree) {
    const Value* outputs = document_.root.find("outputs");
    for (const auto& [name, given] : outputs != nullptr ? outputs->members() : std::vector<Value::Member>{}) {
      const char* taken = tree.names.hinges.has(name)   ? "hinge"
                          : tree.names.bodies.has(name) ? "body"
                          : is_column_of_all(name)      ? "column that every table has"
                                                        : nullptr;
      if (taken == nullptr) continue;
      checker_.key_error("/outputs/" + name, fmt::format("got name {}, which is that of a {}; outputs need their own",
                                                         in_quotes(name), taken));
    }
    std::optional<SensorProbe> probe;  // where there are any
    add_parts<Sensor>("outputs", grammar::sensor_members(), tree.model != nullptr,
                      [&](const std::string& name, const Value&, const std::shared_ptr<const Sensor>& sensor) {
                        auto bound = bind_sensor(*sensor, *tree.model, scene_.outputs);
                        if (!probe) probe.emplace(*tree.model);
                        if (const std::string fault = probe->fault_of(*bound); !fault.empty())
                          throw std::invalid_argument("the sensor cannot be read: " + fault);
                        scene_.outputs.push_back({name, std::move(bound)});
                      });
  }

  const Document& document_;
  Diagnostics& diagnostics_;
  SceneParts* parts_;  ///< null: nothing is remembered
  Checker checker_;
  Scene scene_;
  Vector3 gravity_ = Vector3::Zero();
  std::list<Value> none_;  ///< in the place of parts that there are not
  UnboundLoads unbound_;
  std::set<std::string> refused_;  ///< loads, motions, constraints and outputs that are reported already
};

Scene make(const SceneValues& values, Registry& registry, SceneParts* parts) {
  Diagnostics diagnostics = values.problems();
  SceneSources sources;
  const FileNotes notes([&](const std::string& file, std::string_view bytes) {
    sources.add(FileUsed{file, withy::sha256(bytes)});
  });
  FloatingPointGuard arithmetic;  // of everything that a plugin is asked: shapes, stations, what binds loads
  Scene scene = SceneBuilder(values.document(), registry, sources, parts, diagnostics).build();
  arithmetic.check("a plugin of this scene");
  if (!diagnostics.ok()) throw SceneError(values.file(), diagnostics.errors(), values.origins());
  scene.file = values.file();
  scene.folder = values.document().whole_directory;
  scene.sha256 = values.sha256();
  scene.sources = std::move(sources);
  scene.settings = values.settings();
  return scene;
}

}  // namespace

std::string Scene::folder_now() const {
  return withy::directory_now(std::filesystem::path(file).parent_path().string(), folder);
}

Scene make_scene(const SceneValues& values, Registry& registry) { return make(values, registry, nullptr); }

Scene make_scene(const SceneValues& values, Registry& registry, SceneParts& parts) {
  return make(values, registry, &parts);
}

Scene parse_scene(std::string_view text, const std::string& file, Registry& registry, const SceneOptions& options) {
  return make_scene(SceneValues::parse(text, file).apply(options), registry);
}

Scene read_scene(const std::string& file, Registry& registry, const SceneOptions& options) {
  return make_scene(SceneValues::read(file).apply(options), registry);
}

}  // namespace withy
