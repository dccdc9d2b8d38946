/// \file
/// What loads on single rates of hinges share: the parameters that name a rate, and its place in a State.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// A rate as the scene names it.
struct RateName {
  std::string hinge;
  std::size_t component = 0;
};

inline ParameterSpec component_parameter() {
  return integer("component", "which of the hinge's rates, counted from 0").least(0).otherwise(0.0);
}

/// `hinge` and `component`, then the load's own.
inline std::vector<ParameterSpec> rate_parameters(std::vector<ParameterSpec> own) {
  std::vector<ParameterSpec> all{text("hinge", "hinge that it acts on").naming(ParameterSpec::Refers::hinge),
                                 component_parameter()};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

inline RateName rate_name(const Value& p) { return {p.text_at("hinge"), p.count_at("component")}; }

inline const Slot& hinge_slot(const Model& model, const std::string& hinge) {
  const int index = model.hinge(hinge);
  if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge + "'");
  return model.layout().hinges[static_cast<std::size_t>(index)];
}

/// The hinge of that name, which must have one coordinate.
/// \throws std::invalid_argument where the model has no such hinge.
inline const Slot& single_coordinate(const Model& model, const std::string& hinge) {
  const Slot& slot = hinge_slot(model, hinge);
  if (slot.positions != 1 || slot.speeds != 1)
    throw std::invalid_argument("hinge '" + hinge + "' has " + std::to_string(slot.speeds) +
                                " rates; a trajectory moves hinges with one coordinate");
  return slot;
}

/// Index of the rate among the speeds.
/// \throws std::invalid_argument where the model has no such rate.
inline std::size_t speed_index(const Model& model, const RateName& rate) {
  const Slot& slot = hinge_slot(model, rate.hinge);
  if (slot.speeds == 0)
    throw std::invalid_argument("hinge '" + rate.hinge +
                                "' holds its body still and has no rates; need one that moves");
  if (rate.component >= slot.speeds)
    throw std::invalid_argument("hinge '" + rate.hinge + "' has " + std::to_string(slot.speeds) +
                                " rates; there is no component " + std::to_string(rate.component) +
                                " (they count from 0)");
  return slot.speed + rate.component;
}

/// Index among the positions of the coordinate whose derivative the rate is.
/// \throws std::invalid_argument where it is the derivative of none, as an angular velocity beside a quaternion.
inline std::size_t position_index(const Model& model, const RateName& rate) {
  speed_index(model, rate);
  const auto node = static_cast<std::size_t>(model.hinge(rate.hinge));
  const HingeRate measured = hinge_rates(*model.hinges()[node].hinge)[rate.component];
  if (!measured.coordinate)
    throw std::invalid_argument("rate " + std::to_string(rate.component) + " of hinge '" + rate.hinge +
                                "' is the derivative of no coordinate; need an angle or a displacement");
  return model.layout().hinges[node].position + *measured.coordinate;
}

}  // namespace withy
