#include "withy/core/plugin/mode_family.hpp"

#include <string>

#include "withy/core/plugin/default_values.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// The family's options; a name alone leaves all at their defaults.
Value options(const Value& family, const std::vector<ParameterSpec>& specs) {
  return family.kind() == Value::Kind::map ? family : default_values(specs, family.place());
}

const Value& name_of(const Value& family) { return family.kind() == Value::Kind::map ? family.at("name") : family; }

}  // namespace

std::unique_ptr<ModeFamily> make_mode_family(const Value& family, const MakeContext& context) {
  const Value& name = name_of(family);
  const Plugin<ModeFamily>* plugin = context.registry.find<ModeFamily>(name.text());
  if (plugin == nullptr) {
    context.diagnostics.error(name.place(), "no mode family '" + name.text() + "'");
    return nullptr;
  }
  return plugin->make(options(family, plugin->parameters), context);
}

std::unique_ptr<ShapeFunctions> make_shape_functions(const Value& family, const Value& count, const BeamData& beam,
                                                     const MakeContext& context) {
  const Value& name = name_of(family);
  const std::string id = "mode family '" + name.text() + "'";
  const auto made = make_mode_family(family, context);
  if (made == nullptr) return nullptr;
  const auto modes = static_cast<std::size_t>(count.number());
  if (modes > made->most()) {
    context.diagnostics.error(count.place(), "got " + std::to_string(modes) + " modes; " + id + " gives at most " +
                                                 std::to_string(made->most()));
    return nullptr;
  }
  auto functions = made->functions(beam, modes);
  if (functions == nullptr) {
    const char* strain = beam.strain == BeamData::Strain::bending   ? "bending"
                         : beam.strain == BeamData::Strain::torsion ? "torsion"
                                                                    : "extension and shear";
    context.diagnostics.error(name.place(), id + " has no functions for " + strain);
    return nullptr;
  }
  if (const std::string fault = find_fault(*functions, beam, modes); !fault.empty()) {
    context.diagnostics.error(name.place(), id + " made functions that cannot be: " + fault);
    return nullptr;
  }
  return functions;
}

}  // namespace withy
