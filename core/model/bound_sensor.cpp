#include "withy/core/model/bound_sensor.hpp"

#include <sstream>
#include <stdexcept>

#include "withy/core/model/model.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/plugin_call.hpp"

namespace withy {
namespace {

std::string sections_fault(const BoundSensor& sensor, const Model& model) {
  for (const SectionPlace& place : sensor.sections()) {
    std::ostringstream text;
    const auto body = static_cast<std::size_t>(place.body);
    if (place.body < 0 || body >= model.bodies().size()) {
      text << "it asks for a section of body " << place.body << ", and there are " << model.bodies().size();
    } else {
      const BodyNode& node = model.bodies()[body];
      const std::optional<BodyCut> cut = node.body->cut(place.x);
      const std::string fault = cut ? find_fault(*cut, node.body->shape().modes()) : "";
      if (!cut || !fault.empty())
        text << "it asks for the section at x = " << place.x << " m of body '" << node.name << "', which "
             << (cut ? "cannot be: " + fault : std::string("cannot be cut there"));
    }
    if (!text.str().empty()) return text.str();
  }
  return {};
}

}  // namespace

std::shared_ptr<const BoundSensor> bind_sensor(const Sensor& sensor, const Model& model,
                                               std::span<const SensorNode> before) {
  std::shared_ptr<const BoundSensor> bound =
      plugin_call("the sensor cannot be bound", [&] { return sensor.bind(model, before); });
  if (bound == nullptr) throw std::invalid_argument("the sensor cannot be bound and does not say why");
  plugin_call("the sensor does not say what it gives", [&] {
    if (const std::string fault = find_fault(bound->columns()); !fault.empty())
      throw std::invalid_argument("the sensor gives numbers that cannot be: " + fault);
    if (const std::string fault = sections_fault(*bound, model); !fault.empty())
      throw std::invalid_argument("the sensor cannot be read: " + fault);
  });
  return bound;
}

}  // namespace withy
