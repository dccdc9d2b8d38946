#include "withy/bindings/fmi/scene_numbers.hpp"

#include <algorithm>
#include <string_view>
#include <type_traits>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/units.hpp"

namespace withy::fmi {
namespace {

using Specs = std::vector<ParameterSpec>;

/// Whether a rate of a hinge moves its child along, and does not turn it.
bool slides(const Model& model, const std::string& hinge, std::size_t component) {
  const int index = model.hinge(hinge);
  if (index < 0) return false;
  const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[static_cast<std::size_t>(index)].hinge);
  return component < rates.size() && !rates[component].angular;
}

std::size_t component_of(const Value& map) {
  const Value* component = map.find("component");
  return component != nullptr && component->kind() == Value::Kind::number && component->number() >= 0
             ? static_cast<std::size_t>(component->number())
             : 0;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// Parameters of what acts on a hinge, with the units where it slides or turns. Those of maps by hinges go by their
/// own.
Specs at_hinge(Specs specs, bool slides) {
  for (ParameterSpec& spec : specs) {
    spec.unit = unit_at_hinge(spec.unit, slides);
    if (spec.kind == ParameterSpec::Kind::map) spec.members = at_hinge(std::move(spec.members), slides);
  }
  return specs;
}

/// Parameters of a controller that are stated as for the error of an angle, where its signal is none: of a length, else
/// without a unit.
Specs of_signal(Specs specs, const std::string& unit) {
  for (ParameterSpec& spec : specs)
    if (spec.key != "phase" && spec.unit.find("rad") != std::string::npos)
      spec.unit = unit == "m" ? replaced(spec.unit, "rad", "m") : "1";
  return specs;
}

class Collector {
 public:
  explicit Collector(const Model& model) : model_(model) {}

  std::vector<SceneNumber> numbers;

  void members(const std::string& path, const Value& map, const Specs& specs) {
    for (const ParameterSpec& spec : specs)
      if (const Value* value = map.find(spec.key)) member(path + '.' + spec.key, *value, spec);
  }

 private:
  void member(const std::string& path, const Value& value, const ParameterSpec& spec) {
    using enum ParameterSpec::Kind;
    if (spec.kind == number && value.kind() == Value::Kind::number) add(path, value, spec);
    if (spec.kind == vector && value.kind() == Value::Kind::list && value.items().size() == spec.count)
      for (std::size_t i = 0; i < spec.count; ++i) add(path + '.' + std::to_string(i), value.items()[i], spec);
    if (value.kind() != Value::Kind::map) return;
    if (spec.kind == map) members(path, value, spec.members);
    if (spec.kind == named)
      for (const auto& [name, each] : value.members())
        if (each.kind() == Value::Kind::map) members(path + '.' + name, each, of_hinge(spec, name, each));
  }
  /// Of a map that is named after a hinge, by that hinge.
  [[nodiscard]] Specs of_hinge(const ParameterSpec& spec, const std::string& name, const Value& map) const {
    return at_hinge(spec.members, spec.key == "hinges" && slides(model_, name, component_of(map)));
  }
  void add(const std::string& path, const Value& value, const ParameterSpec& spec) {
    if (value.kind() != Value::Kind::number) return;
    // An open end is none that a description of variables could have.
    numbers.push_back({path.substr(1), spec.unit, spec.meaning, value.number(),
                       spec.exclusive_minimum ? std::nullopt : spec.minimum, spec.maximum});
  }

  const Model& model_;
};

/// The units of what parts act on and measure.
struct Measured {
  const Model& model;
  const SignalUnits& units;

  /// Of the first signal or input that a part names; empty where it names none.
  [[nodiscard]] std::string unit_at(const Value& part, const char* key) const {
    const Value* names = part.find(key);
    if (names == nullptr || names->kind() != Value::Kind::list || names->items().empty()) return {};
    const auto found = units.find(names->items().front().text());
    return found == units.end() ? "1" : found->second;
  }
  /// A controller's parameters, by the hinge or input that it drives and the signal that it measures.
  [[nodiscard]] Specs of_controller(const Value& part, Specs specs, bool slides_along) const {
    const std::string signal = unit_at(part, "of");
    if (signal.empty()) return at_hinge(std::move(specs), slides_along);
    specs = at_hinge(std::move(specs), false);
    if (slides_along || unit_at(part, "to") == "N")
      for (ParameterSpec& spec : specs) spec.unit = replaced(spec.unit, "N m", "N");
    return signal == "rad" ? specs : of_signal(std::move(specs), signal);
  }
  [[nodiscard]] Specs operator()(const Value& part, const std::string& type, Specs specs) const {
    const Value* hinge = part.find("hinge");
    const bool along_hinge =
        hinge != nullptr && hinge->kind() == Value::Kind::text && slides(model, hinge->text(), component_of(part));
    if (type == "pid") return of_controller(part, std::move(specs), along_hinge);
    if (type == "actuator") return at_hinge(std::move(specs), along_hinge || unit_at(part, "to") == "N");
    return at_hinge(std::move(specs), along_hinge);
  }
};

template <class Interface>
constexpr bool acts_on_hinges = std::is_same_v<Interface, Load> || std::is_same_v<Interface, Motion>;

/// Of all parts of a kind: `bodies`, `loads` ….
template <class Interface>
void add_parts(Collector& out, const Value& source, const char* key, const Specs& common, Registry& registry,
               const Measured& measured) {
  const Value* parts = source.find(key);
  if (parts == nullptr || parts->kind() != Value::Kind::map) return;
  for (const auto& [name, part] : parts->members()) {
    if (part.kind() != Value::Kind::map) continue;
    Specs specs = common;
    const Value* type = part.find("type");
    const Plugin<Interface>* plugin =
        type != nullptr && type->kind() == Value::Kind::text ? registry.find<Interface>(type->text()) : nullptr;
    if (plugin != nullptr) specs.insert(specs.end(), plugin->parameters.begin(), plugin->parameters.end());
    if constexpr (std::is_same_v<Interface, Hinge>) specs = at_hinge(std::move(specs), slides(measured.model, name, 0));
    out.members(std::string(".") + key + '.' + name, part,
                plugin != nullptr && acts_on_hinges<Interface> ? measured(part, plugin->id, specs) : specs);
  }
}

}  // namespace

std::vector<SceneNumber> scene_numbers(const Scene& scene, Registry& registry, const SignalUnits& units) {
  Collector out(*scene.model);
  const Measured measured{*scene.model, units};
  Specs gravity = grammar::scene_members();
  std::erase_if(gravity, [](const ParameterSpec& s) { return s.key != "gravity"; });
  out.members("", scene.source, gravity);
  add_parts<Body>(out, scene.source, "bodies", grammar::body_members(), registry, measured);
  add_parts<Hinge>(out, scene.source, "hinges", grammar::hinge_members(), registry, measured);
  add_parts<Load>(out, scene.source, "loads", grammar::load_members(), registry, measured);
  add_parts<Motion>(out, scene.source, "motions", grammar::motion_members(), registry, measured);
  const Plugin<Integrator>* integrator = registry.find<Integrator>(scene.integrator_name);
  const Value* chosen = scene.source.find("integrator");
  if (integrator != nullptr && chosen != nullptr) out.members(".integrator", *chosen, integrator->parameters);
  return std::move(out.numbers);
}

}  // namespace withy::fmi
