/// \file
/// What a controller tells of itself: its command, its error, its states.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {
namespace {

class BoundControlSensor final : public BoundSensor {
 public:
  BoundControlSensor(std::size_t load, std::vector<SensorColumn> columns, std::vector<std::size_t> places)
      : load_(load), columns_(std::move(columns)), places_(std::move(places)) {}
  std::vector<SensorColumn> columns() const override { return columns_; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    std::fill(values.begin(), values.end(), 0.0);
    auto* const loads = dynamic_cast<SensedLoads*>(&state);
    if (loads == nullptr) return;  // of equations that sense no loads: none has a run
    const std::span<const double> all = loads->numbers(load_);
    for (std::size_t i = 0; i < places_.size(); ++i) values[i] = all[places_[i]];
  }

 private:
  std::size_t load_;
  std::vector<SensorColumn> columns_;
  std::vector<std::size_t> places_;  ///< among all numbers of the load
};

class ControlSensor final : public Sensor {
 public:
  ControlSensor(std::string load, std::vector<std::string> show) : load_(std::move(load)), show_(std::move(show)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const auto named = [&](const LoadNode& node) { return node.name == load_; };
    const auto node = std::find_if(model.loads().begin(), model.loads().end(), named);
    if (node == model.loads().end()) throw std::invalid_argument("there is no load '" + load_ + "'");
    const auto* told = dynamic_cast<const LoadNumbers*>(node->load.get());
    const std::vector<SensorColumn> all = told == nullptr ? std::vector<SensorColumn>{} : told->numbers();
    if (all.empty())
      throw std::invalid_argument("load '" + load_ + "' is no controller and has no limit: there is nothing to show");
    std::vector<SensorColumn> columns;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto names = [&](const std::string& name) { return is_named(all[i].component, name); };
      const bool asked = show_.empty() || std::any_of(show_.begin(), show_.end(), names);
      if (!asked) continue;
      columns.push_back(all[i]);
      places.push_back(i);
    }
    for (const std::string& name : show_) check(name, all);
    return std::make_unique<BoundControlSensor>(static_cast<std::size_t>(node - model.loads().begin()),
                                                std::move(columns), std::move(places));
  }

 private:
  /// "error" names "error.elbow", too.
  static bool is_named(const std::string& component, const std::string& name) {
    return component == name || component.starts_with(name + '.');
  }
  void check(const std::string& name, const std::vector<SensorColumn>& all) const {
    std::vector<std::string> known;
    for (const SensorColumn& c : all) known.push_back(c.component);
    const auto is = [&](const std::string& component) { return is_named(component, name); };
    if (std::none_of(known.begin(), known.end(), is))
      throw std::invalid_argument(fmt::format("load '{}' has no '{}' to show; known: {}", load_, name,
                                              fmt::join(known.begin(), known.end(), ", ")));
  }
  std::string load_;
  std::vector<std::string> show_;
};

std::unique_ptr<Sensor> make_control_sensor(const Value& p, const MakeContext& /*context*/) {
  std::vector<std::string> show;
  if (const Value* given = p.find("show"))
    for (const Value& item : given->items()) show.push_back(item.text());
  return std::make_unique<ControlSensor>(p.text_at("of"), std::move(show));
}

}  // namespace

void enroll_control_sensor(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "control",
       .summary = "What a controller commands, its tracking error, its margins to limits, and its states",
       .parameters =
           {text("of", "the controller").naming(ParameterSpec::Refers::load),
            texts("show", "which of its numbers: command, error, margin, names of states; all where left out").optional()},
       .make = &make_control_sensor});
}

}  // namespace withy
