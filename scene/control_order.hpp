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
#include "withy/core/plugin/value.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// A load that is to be bound.
struct PendingLoad {
  std::string name;
  std::set<std::string> needs;  ///< loads of the scene that it measures or acts through
  std::shared_ptr<const Load> load;
};

/// Names of loads of the scene that a checked load names under `of`, `to` or in its formula. A signal that is the
/// column of a hinge is none of a load. \param model with all hinges; null where the tree has faults
std::set<std::string> needed_loads(const Value& load, const std::set<std::string>& loads, const Model* model);

/// Reports signals that loads measure by a name that a hinge and a load have both. \param loads of the scene, as
/// checked \param model with all loads that can be bound
void refuse_names_of_two(const Value& loads, const Model& model, const Checker& checker);
/// The same of names that a load and a number of an output have both.
void refuse_names_of_load_and_output(const Value& loads, const Model& model, const std::vector<SensorNode>& outputs,
                                     const Checker& checker);

/// In an order in which every load stands behind those that it needs. Loads that go round in a circle are reported and
/// left out, and so are those that need a load which is not among them.
std::list<PendingLoad> in_order_of_need(std::list<PendingLoad> loads, const Checker& checker);

/// Loads that cannot be bound. Why is told when all outputs have been read: what rests on a part that is reported needs
/// no report of its own, and an output that a load measures is reported behind the loads, on which it may rest.
class UnboundLoads {
 public:
  /// Call in a handler of what binding it has thrown. \param load as checked
  void add(const std::string& name, const Value& load);
  [[nodiscard]] bool has(const std::string& name) const { return names_.contains(name); }
  /// Whether an output that cannot be bound names one of them, or an output that does: it is told with the load.
  bool concern(const std::string& name, const Value& output);
  /// Reports those that name none of `refused`, which all of them then belong to.
  void report(const Checker& checker, std::set<std::string>& refused);

 private:
  struct Unbound {
    std::string name;
    Value load;
    Place place;  ///< of what is wrong in it, or that of its name, without a line
    std::string problem;
  };
  std::vector<Unbound> loads_;
  std::set<std::string> names_;  ///< of the outputs too
};

/// Fills the names of loads and signals from what the scene says, and where a load measures anything gives the model
/// its outputs: those without a sensor cannot be bound before the loads. Reports nothing. \param model null where the
/// tree has faults
void name_signals(const Document& document, Model* model, SceneNames& names, Registry& registry);

/// Gives the model all its outputs in the place of those known before loads were bound, where loads measure. Reports
/// numbers that a sampled load measures and no output has.
void give_outputs(Model& model, const std::vector<SensorNode>& outputs, const Checker& checker);

}  // namespace withy
