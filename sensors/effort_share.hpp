/// \file
/// Whose efforts a sensor tells: of loads, of motions, of both, or of one load.
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

struct EffortShare {
  std::optional<int> load;  ///< as SensedState::load_efforts; none: of no load
  bool motion = false;
};

inline ParameterSpec effort_share_parameter() {
  return text("of", "loads and motions together, the loads, the motions, or one load by its name")
      .one_of({"all", "loads", "motion"})
      .naming(ParameterSpec::Refers::load)
      .otherwise("all");
}

/// \throws std::invalid_argument where the model has no such load.
inline EffortShare effort_share(const Model& model, const std::string& of) {
  EffortShare share;
  if (of == "all" || of == "loads") share.load = EquationsOfMotion::all_loads;
  share.motion = of == "all" || of == "motion";
  if (share.load || share.motion) return share;
  const auto found =
      std::find_if(model.loads().begin(), model.loads().end(), [&](const LoadNode& l) { return l.name == of; });
  if (found == model.loads().end()) throw std::invalid_argument("there is no load '" + of + "'");
  share.load = static_cast<int>(found - model.loads().begin());
  return share;
}

}  // namespace withy
