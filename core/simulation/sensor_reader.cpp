#include "withy/core/simulation/sensor_reader.hpp"

#include <utility>

namespace withy {

SensorReader::SensorReader(std::vector<SensorNode> sensors, const EquationsOfMotion& equations)
    : sensors_(std::move(sensors)) {
  std::vector<SectionPlace> sections;
  for (const SensorNode& node : sensors_) {
    const std::vector<Column> own = columns_of(node);
    parts_.push_back({own.size(), sections.size()});
    columns_.insert(columns_.end(), own.begin(), own.end());
    const std::vector<SectionPlace> asked = node.sensor->sections();
    sections.insert(sections.end(), asked.begin(), asked.end());
  }
  if (!sensors_.empty()) sensed_ = equations.make_sensed_state(sections);
}

bool SensorReader::read(const State& state, std::span<double> values) noexcept {
  if (sensed_ == nullptr) return true;
  if (!sensed_->observe(state)) return false;
  std::size_t next = 0;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const SensorInputs inputs{parts_[i].first_section, values.first(next)};
    sensors_[i].sensor->read(*sensed_, inputs, values.subspan(next, parts_[i].columns));
    next += parts_[i].columns;
  }
  return true;
}

}  // namespace withy
