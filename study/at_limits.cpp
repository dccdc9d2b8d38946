#include "withy/study/at_limits.hpp"

#include <fmt/format.h>

#include <utility>

#include "withy/core/model/limit_sensor.hpp"
#include "withy/core/simulation/renewal.hpp"
#include "withy/core/simulation/sensor_reader.hpp"

namespace withy::study {

std::vector<std::string> at_limits(const Configuration& c, const State& state) {
  const Model& model = c.prepared().model();
  std::vector<SensorNode> sensors;
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (std::shared_ptr<const BoundSensor> sensor = limit_sensor(model, l))
      sensors.push_back({model.loads()[l].name, std::move(sensor)});
  std::vector<std::string> reached;
  if (sensors.empty()) return reached;
  const EquationsOfMotion& equations = *c.prepared().equations;
  Renewal renewal(model, equations);
  // What sampled loads tell may be of a sample at another state, from which this one was found.
  const State told = c.sampled() ? told_at(model, renewal, state) : state;
  std::vector<double> beyond(sensors.size());
  if (!SensorReader(sensors, equations).read(told, beyond)) return reached;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    if (beyond[i] >= 0) reached.push_back(sensors[i].name);
  return reached;
}

std::string at_limits_text(const std::vector<std::string>& loads) {
  if (loads.empty()) return {};
  const bool one = loads.size() == 1;
  return fmt::format("'{}' {} at {} limit here: small motions are those with what {} there, as if {} loop were open.",
                     fmt::join(loads, "', '"), one ? "is" : "are", one ? "its" : "their",
                     one ? "it gives" : "they give", one ? "its" : "their");
}

}  // namespace withy::study
