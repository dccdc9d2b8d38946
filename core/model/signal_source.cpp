#include "withy/core/model/signal_source.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "withy/core/model/columns.hpp"

namespace withy {
namespace {

using Kind = SignalSource::Kind;

/// What a load gives, by its name.
std::vector<std::string> names_of(const LoadNode& node) {
  const std::size_t count = node.load->output() == nullptr ? 0 : node.load->output()->outputs();
  if (count == 1) return {node.name};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(node.name + "." + std::to_string(i));
  return names;
}

std::span<const SensorNode> measured(const Model& model) {
  return model.measured() == nullptr ? std::span<const SensorNode>() : std::span(*model.measured());
}

std::vector<std::string> known(const Model& model) {
  std::vector<std::string> all;
  for (const HingeNode& hinge : model.hinges()) {
    for (const Column& c : coordinate_columns(hinge)) all.push_back(c.name);
    for (const Column& c : rate_columns(hinge)) all.push_back(c.name);
  }
  for (const SensorNode& node : measured(model))
    for (const Column& c : node.sensor == nullptr ? std::vector<Column>{} : columns_of(node)) all.push_back(c.name);
  for (const LoadNode& node : model.loads())
    for (const std::string& name : names_of(node)) all.push_back(name);
  return all;
}

std::string listed(const std::vector<std::string>& all) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 30); ++i) text += (i == 0 ? "" : ", ") + all[i];
  return all.size() > 30 ? text + " ..." : text;
}

std::optional<std::size_t> place_of(const std::string& name, const std::vector<Column>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return i;
  return {};
}

/// Nothing where no hinge has a column of this name.
std::optional<SignalSource> hinge_source(const Model& model, const std::string& name) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    if (const auto i = place_of(name, coordinate_columns(model.hinges()[h])))
      return SignalSource{Kind::position, slot.position + *i};
    if (const auto i = place_of(name, rate_columns(model.hinges()[h])))
      return SignalSource{Kind::rate, slot.speed + *i};
  }
  return {};
}

/// Nothing where no load gives a number of this name.
std::optional<SignalSource> load_source(const Model& model, const std::string& name) {
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const std::vector<std::string> given = names_of(model.loads()[l]);
    const auto at = std::find(given.begin(), given.end(), name);
    if (at != given.end()) return SignalSource{Kind::load, l, static_cast<std::size_t>(at - given.begin())};
  }
  return {};
}

}  // namespace

UnknownSignal::UnknownSignal(std::string called, std::vector<std::string> there_are)
    : std::invalid_argument("no signal '" + called + "'; known: " + listed(there_are)),
      name(std::move(called)),
      known(std::move(there_are)) {}

SignalSource find_signal(const Model& model, const std::string& name) {
  if (const auto source = hinge_source(model, name)) return *source;
  if (const auto source = load_source(model, name)) return *source;
  std::size_t first = 0;
  for (const SensorNode& node : measured(model)) {
    if (node.sensor == nullptr) {
      if (name.substr(0, name.find('.')) == node.name) return {Kind::unbound};
      continue;
    }
    const std::vector<Column> columns = columns_of(node);
    if (const auto i = place_of(name, columns)) return {Kind::output, first + *i};
    first += columns.size();
  }
  throw UnknownSignal(name, known(model));
}

bool is_of_hinge_and_load(const Model& model, const std::string& name) {
  return hinge_source(model, name) && load_source(model, name);
}

bool is_of_load(const Model& model, const std::string& name) { return load_source(model, name).has_value(); }

}  // namespace withy
