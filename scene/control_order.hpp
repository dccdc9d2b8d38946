/// \file
/// The order in which loads are bound that name one another, and the outputs that they may measure.
#pragma once

#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// A load that is to be bound.
struct PendingLoad {
  std::string name;
  std::set<std::string> needs;  ///< loads of the scene that it measures or acts through
  std::unique_ptr<Load> load;
};

/// Names of loads of the scene that a checked load names under `of`, `to` or in its formula.
std::set<std::string> needed_loads(const Value& load, const std::set<std::string>& loads);

/// In an order in which every load stands behind those that it needs. Loads that go round in a circle are reported and
/// left out, and so are those that need a load which is not among them.
std::list<PendingLoad> in_order_of_need(std::list<PendingLoad> loads, const Checker& checker);

/// The scene's outputs, those without a sensor where it cannot be bound before the loads; reports nothing.
std::shared_ptr<const std::vector<SensorNode>> measurable(const Value& outputs, const Model& model,
                                                          const Document& document, const SceneNames& names,
                                                          Registry& registry);

}  // namespace withy
