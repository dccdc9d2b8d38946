/// \file
/// Loads that name one another and measure outputs: their order, and what they may measure.
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
  std::shared_ptr<const Load> load;
};

/// Names of loads of the scene that a checked load names under `of`, `to` or in its formula.
std::set<std::string> needed_loads(const Value& load, const std::set<std::string>& loads);

/// In an order in which every load stands behind those that it needs. Loads that go round in a circle are reported and
/// left out, and so are those that need a load which is not among them.
std::list<PendingLoad> in_order_of_need(std::list<PendingLoad> loads, const Checker& checker);

/// Fills the names of loads and signals from what the scene says, and where a load measures anything gives the model
/// its outputs: those without a sensor cannot be bound before the loads. Reports nothing. \param model null where the
/// tree has faults
void name_signals(const Document& document, Model* model, SceneNames& names, Registry& registry);

/// Gives the model all its outputs in the place of those known before loads were bound, where loads measure. Reports
/// numbers that a sampled load measures and no output has.
void give_outputs(Model& model, const std::vector<SensorNode>& outputs, const Checker& checker);

}  // namespace withy
