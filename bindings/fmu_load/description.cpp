#include "withy/bindings/fmu_load/description.hpp"

#include <charconv>

#include "withy/bindings/fmu_load/archive.hpp"
#include "withy/exchange/xml.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy::fmu_load {
namespace {

using exchange::Element;

std::string attribute(const Element& e, const char* name, const char* otherwise = "") {
  const std::string* given = e.find(name);
  return given == nullptr ? otherwise : *given;
}

bool holds(const Element& e, const char* name) {
  const std::string value = attribute(e, name);
  return value == "true" || value == "1";
}

template <class Number>
std::optional<Number> number_in(const std::string& text) {
  Number value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return {};
  return value;
}

FmuVariable variable_of(const Element& e, int version) {
  FmuVariable v{attribute(e, "name"), 0, e.name, attribute(e, "causality", "local")};
  const auto reference = number_in<std::uint32_t>(attribute(e, "valueReference"));
  if (!reference) throw FmuError("variable '" + v.name + "' has no value reference");
  v.reference = *reference;
  v.array = e.child("Dimension") != nullptr;
  if (version == 2)
    for (const Element& type : e.children)
      if (type.name != "Annotations") v.type = type.name;
  return v;
}

}  // namespace

FmuDescription read_description(const std::string& text) {
  Element root;
  try {
    root = exchange::read_xml(text, "modelDescription.xml");
  } catch (const SceneError& e) {
    throw FmuError(e.what());
  }
  FmuDescription d;
  const std::string version = attribute(root, "fmiVersion");
  if (root.name != "fmiModelDescription" || !(version == "2.0" || version.starts_with("3.")))
    throw FmuError("is of version '" + version + "' of the standard; need FMI 2.0 or 3.0");
  d.version = version == "2.0" ? 2 : 3;
  const Element* simulated = root.child("CoSimulation");
  if (simulated == nullptr)
    throw FmuError("is not for co-simulation: its model description has no CoSimulation, which brings the solver");
  if (holds(*simulated, "needsExecutionTool")) throw FmuError("needs the tool that made it, to run in");
  d.token = attribute(root, d.version == 2 ? "guid" : "instantiationToken");
  d.identifier = attribute(*simulated, "modelIdentifier");
  const bool two = d.version == 2;
  d.keeps_states = holds(*simulated, two ? "canGetAndSetFMUstate" : "canGetAndSetFMUState") &&
                   holds(*simulated, two ? "canSerializeFMUstate" : "canSerializeFMUState");
  d.once_only = holds(*simulated, "canBeInstantiatedOnlyOncePerProcess");
  if (const Element* experiment = root.child("DefaultExperiment"))
    if (const auto step = number_in<double>(attribute(*experiment, "stepSize")); step && *step > 0) d.step = step;
  if (const Element* variables = root.child("ModelVariables"))
    for (const Element& e : variables->children) d.variables.push_back(variable_of(e, d.version));
  return d;
}

}  // namespace withy::fmu_load
