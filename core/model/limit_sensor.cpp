#include "withy/core/model/limit_sensor.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/sampled_part.hpp"

namespace withy {
namespace {

class LimitSensor final : public BoundSensor {
 public:
  LimitSensor(std::size_t load, std::vector<std::size_t> margins) : load_(load), margins_(std::move(margins)) {}
  std::vector<SensorColumn> columns() const override { return {{"beyond_limit", "1"}}; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    values[0] = -std::numeric_limits<double>::max();
    auto* const loads = dynamic_cast<SensedLoads*>(&state);
    if (loads == nullptr) return;  // of equations that sense no loads: none has a run
    const std::span<const double> all = loads->numbers(load_);
    for (const std::size_t margin : margins_) values[0] = std::max(values[0], -all[margin]);
  }

 private:
  std::size_t load_;
  std::vector<std::size_t> margins_;  ///< among the numbers of the load
};

/// "margin", "rate_margin", "margin.elbow".
bool is_margin(const std::string& component) {
  const std::string first = component.substr(0, component.find('.'));
  return first == "margin" || first.ends_with("_margin");
}

}  // namespace

std::shared_ptr<const BoundSensor> limit_sensor(const Model& model, std::size_t load) {
  const auto* told = dynamic_cast<const LoadNumbers*>(model.loads()[load].load.get());
  if (told == nullptr) return nullptr;
  const std::vector<SensorColumn> numbers = told->numbers();
  std::vector<std::size_t> margins;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (is_margin(numbers[i].component)) margins.push_back(i);
  if (margins.empty()) return nullptr;
  return std::make_shared<LimitSensor>(load, std::move(margins));
}

}  // namespace withy
