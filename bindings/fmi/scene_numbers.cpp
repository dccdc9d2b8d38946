#include "withy/bindings/fmi/scene_numbers.hpp"

#include <algorithm>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/scene/grammar.hpp"

namespace withy::fmi {
namespace {

using Specs = std::vector<ParameterSpec>;

class Collector {
 public:
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
        if (each.kind() == Value::Kind::map) members(path + '.' + name, each, spec.members);
  }
  void add(const std::string& path, const Value& value, const ParameterSpec& spec) {
    if (value.kind() != Value::Kind::number) return;
    // An open end is none that a description of variables could have.
    numbers.push_back({path.substr(1), spec.unit, spec.meaning, value.number(),
                       spec.exclusive_minimum ? std::nullopt : spec.minimum, spec.maximum});
  }
};

/// Of all parts of a kind: `bodies`, `loads` ….
template <class Interface>
void add_parts(Collector& out, const Value& source, const char* key, const Specs& common, Registry& registry) {
  const Value* parts = source.find(key);
  if (parts == nullptr || parts->kind() != Value::Kind::map) return;
  for (const auto& [name, part] : parts->members()) {
    if (part.kind() != Value::Kind::map) continue;
    Specs specs = common;
    const Value* type = part.find("type");
    const Plugin<Interface>* plugin =
        type != nullptr && type->kind() == Value::Kind::text ? registry.find<Interface>(type->text()) : nullptr;
    if (plugin != nullptr) specs.insert(specs.end(), plugin->parameters.begin(), plugin->parameters.end());
    out.members(std::string(".") + key + '.' + name, part, specs);
  }
}

}  // namespace

std::vector<SceneNumber> scene_numbers(const Scene& scene, Registry& registry) {
  Collector out;
  Specs gravity = grammar::scene_members();
  std::erase_if(gravity, [](const ParameterSpec& s) { return s.key != "gravity"; });
  out.members("", scene.source, gravity);
  add_parts<Body>(out, scene.source, "bodies", grammar::body_members(), registry);
  add_parts<Hinge>(out, scene.source, "hinges", grammar::hinge_members(), registry);
  add_parts<Load>(out, scene.source, "loads", grammar::load_members(), registry);
  add_parts<Motion>(out, scene.source, "motions", grammar::motion_members(), registry);
  const Plugin<Integrator>* integrator = registry.find<Integrator>(scene.integrator_name);
  const Value* chosen = scene.source.find("integrator");
  if (integrator != nullptr && chosen != nullptr) out.members(".integrator", *chosen, integrator->parameters);
  return std::move(out.numbers);
}

}  // namespace withy::fmi
