#include "withy/core/model/held_numbers.hpp"

#include <algorithm>

#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/switched_load.hpp"

namespace withy {
namespace {

/// How many there are: inputs, events and the forms of loads have parts of a written state of their own.
std::size_t held_count(const LoadNode& load) {
  if (load.slot.count == 0 || load.load->input() != nullptr || load.name == name_of_event_states) return 0;
  return load.slot.count - (dynamic_cast<const LoadOfForms*>(load.load.get()) != nullptr ? 1 : 0);
}

}  // namespace

std::optional<std::size_t> place_of_begun(const Model& model) {
  const auto& loads = model.loads();
  if (std::none_of(loads.begin(), loads.end(), [](const LoadNode& load) { return held_count(load) > 0; })) return {};
  return model.layout().size() - 2;
}

std::span<double> held_numbers(const LoadNode& load, std::span<double> y) {
  return y.subspan(load.slot.first, held_count(load));
}

std::span<const double> held_numbers(const LoadNode& load, std::span<const double> y) {
  return y.subspan(load.slot.first, held_count(load));
}

}  // namespace withy
