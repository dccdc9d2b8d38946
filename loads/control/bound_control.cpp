#include "withy/loads/control/bound_control.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

/// The coordinate whose derivative a rate is, and the rate, by the names of their columns.
struct NamedRate {
  std::string coordinate, rate;
};

NamedRate named_rate(const Model& model, const RateName& name) {
  position_index(model, name);  // throws where it is the derivative of none
  const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(model.hinge(name.hinge))];
  const HingeRate rate = hinge_rates(*hinge.hinge)[name.component];
  return {coordinate_columns(hinge)[*rate.coordinate].name, rate_columns(hinge)[name.component].name};
}

/// The rate whose coordinate has this column.
std::string rate_of(const Model& model, const std::string& coordinate) {
  for (const HingeNode& hinge : model.hinges()) {
    const std::vector<HingeRate> rates = hinge_rates(*hinge.hinge);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      if (rates[i].coordinate && coordinate_columns(hinge)[*rates[i].coordinate].name == coordinate)
        return rate_columns(hinge)[i].name;
    }
  }
  throw std::invalid_argument("the derivative of signal '" + coordinate +
                              "' is not measured: it is no coordinate of a hinge; give a 'filter'");
}

std::vector<std::string> measured(const Model& model, const ControlEnds& ends) {
  std::vector<std::string> names;
  for (const std::string& name : ends.of) {
    names.push_back(name);
    if (ends.rate_too) names.push_back(rate_of(model, name));
  }
  if (ends.of.empty() && !ends.measures_nothing && !ends.rate_of_hinge) {
    const NamedRate own = named_rate(model, *ends.hinge);
    names.push_back(own.coordinate);
    if (ends.rate_too) names.push_back(own.rate);
  }
  if (ends.rate_of_hinge) {
    const auto speed = speed_index(model, *ends.hinge);  // throws where there is none
    const auto h = static_cast<std::size_t>(model.hinge(ends.hinge->hinge));
    names.push_back(rate_columns(model.hinges()[h])[speed - model.layout().hinges[h].speed].name);
  }
  names.insert(names.end(), ends.also.begin(), ends.also.end());
  return names;
}

/// What a load gives to others, which it tells first of its numbers; none where it tells nothing.
std::vector<Column> given_by(const LoadNode& node) {
  const LoadOutput* output = node.load->output();
  const auto* told = dynamic_cast<const LoadNumbers*>(node.load.get());
  if (output == nullptr || told == nullptr) return {};
  const std::vector<SensorColumn> numbers = told->numbers();
  std::vector<Column> columns;
  for (std::size_t i = 0; i < std::min(output->outputs(), numbers.size()); ++i)
    columns.push_back({output->outputs() == 1 ? node.name : node.name + "." + std::to_string(i), numbers[i].unit});
  return columns;
}

/// SI unit of a signal; "1" where it is not known.
std::string unit_of(const Model& model, const std::string& signal) {
  const auto find = [&](const std::vector<Column>& columns) -> std::string {
    for (const Column& c : columns)
      if (c.name == signal) return c.unit;
    return {};
  };
  for (const HingeNode& hinge : model.hinges())
    for (const auto& columns : {coordinate_columns(hinge), rate_columns(hinge)})
      if (std::string unit = find(columns); !unit.empty()) return unit;
  if (model.measured() != nullptr) {
    for (const SensorNode& node : *model.measured())
      if (node.sensor != nullptr)
        if (std::string unit = find(columns_of(node)); !unit.empty()) return unit;
  }
  for (const LoadNode& node : model.loads())
    if (std::string unit = find(given_by(node)); !unit.empty()) return unit;
  return "1";
}

/// Of what is commanded at a place.
std::string unit_of(const Model& model, const InputPlace& place) {
  if (place.speed < 0) return place.moment ? "N m" : "N";
  const std::string unit = unit_of_effort(model, static_cast<std::size_t>(place.speed));
  return unit.empty() ? "1" : unit;
}

/// A unit with its words replaced.
std::string in_words(std::string unit, const std::string& command, const std::string& signal) {
  for (const auto& [word, meaning] : {std::pair<std::string, std::string>("command", command), {"signal", signal}})
    if (const std::size_t at = unit.find(word); at != std::string::npos) unit.replace(at, word.size(), meaning);
  return unit;
}

std::vector<InputPlace> places_of(const Model& model, const ControlEnds& ends) {
  if (!ends.acts) return {};
  if (ends.to.empty()) return {{.speed = static_cast<int>(speed_index(model, *ends.hinge)), .frame = {}}};
  std::vector<InputPlace> all;
  for (const std::string& name : ends.to) {
    const auto named = [&](const LoadNode& node) { return node.name == name; };
    const auto node = std::find_if(model.loads().begin(), model.loads().end(), named);
    if (node == model.loads().end() || node->load->input() == nullptr)
      throw std::invalid_argument("'" + name + "' is no load of type input, through which a controller acts");
    all.push_back(node->load->input()->place());
  }
  return all;
}

void expect(std::size_t got, std::size_t needed, const char* what, const char* key) {
  if (got != needed)
    throw std::invalid_argument("got " + std::to_string(got) + " " + what + " ('" + key + "'); it has " +
                                std::to_string(needed));
}

}  // namespace

BoundControl::BoundControl(const Model& model, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
    : ends_(std::move(ends)),
      block_(std::move(block)),
      names_(measured(model, ends_)),
      places_(places_of(model, ends_)) {
  expect(names_.size(), block_->inputs(), "signals", "of");
  if (ends_.acts) expect(places_.size(), block_->outputs(), "places to act", "to");
  for (const InputPlace& place : places_)
    if (place.speed < 0) frames_.push_back(place.frame);
  const std::string signal = names_.empty() ? "1" : unit_of(model, names_.front());
  const std::string command =
      places_.empty() ? in_words(block_->unit_of_output(), "1", signal) : unit_of(model, places_.front());
  const auto unit = [&](const std::string& given) { return in_words(given, command, signal); };
  for (std::size_t i = 0; i < outputs(); ++i)
    numbers_.push_back({outputs() == 1 ? "command" : "command." + std::to_string(i),
                        i < places_.size() ? unit_of(model, places_[i]) : command});
  for (const ControlBlock::Shown& s : block_->shown()) numbers_.push_back({s.name, unit(s.unit)});
  const std::vector<std::string> states = block_->states();
  for (std::size_t i = 0; i < states.size(); ++i) numbers_.push_back({states[i], unit(block_->unit_of_state(i))});
}

void BoundControl::wrenches(double /*t*/, std::span<const FrameMotion> /*motions*/,
                            std::span<Wrench> wrenches) const noexcept {
  std::fill(wrenches.begin(), wrenches.end(), Wrench{});
}

void BoundControl::act(std::span<const double> v, std::span<double> efforts) const noexcept {
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (places_[i].speed >= 0) efforts[static_cast<std::size_t>(places_[i].speed)] += v[i];
}
void BoundControl::act_at_frames(std::span<const double> v, std::span<const FrameMotion> motions,
                                 std::span<Wrench> wrenches) const noexcept {
  std::size_t next = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const InputPlace& place = places_[i];
    if (place.speed >= 0) continue;
    const Vector3 acting = v[i] * place.direction;
    Vector3& part = place.moment ? wrenches[next].moment : wrenches[next].force;
    part += place.following ? Vector3(motions[next].R * acting) : acting;
    ++next;
  }
}

}  // namespace withy
