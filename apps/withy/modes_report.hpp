/// \file
/// What `withy modes` shows: tables, CSV, JSON and a picture of modes at one configuration or along a sweep.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/core/analysis/modes.hpp"

namespace withy::app {

/// The modes at one configuration.
struct ModesAt {
  double value = 0;  ///< of what is swept
  std::vector<Mode> modes;
  std::vector<std::string> names;  ///< of the speeds
  std::string problem;             ///< why there are none; empty where there are
  nlohmann::ordered_json steady;   ///< the steady state, null where the state was taken as it is
};

/// One formulation, all values.
struct ModesOf {
  std::string formulation;
  std::vector<ModesAt> points;
};

/// Name of the coordinate that dominates a mode, as "link1.bending_y[1]".
std::string dominating(const ModesAt& at, const Mode& mode);
/// Whether it grows, beyond what rounding leaves of the greatest eigenvalue.
bool unstable(const ModesAt& at, const Mode& mode);
/// Frequencies, damping, growth and shapes of one configuration.
std::string modes_text(const ModesOf& run, std::size_t count);
/// A row a value, a column a branch; unstable ones marked.
std::string sweep_text(const ModesOf& run, const std::string& label, std::size_t count);
nlohmann::ordered_json modes_json(const ModesOf& run);
/// A line a formulation, value and branch.
std::string modes_csv(const std::vector<ModesOf>& runs, const std::string& label);
/// Frequencies, and where something grows the rates of growth, over the value.
std::string modes_svg(const std::vector<ModesOf>& runs, const std::string& title, const std::string& label,
                      std::size_t count);

}  // namespace withy::app
