/// \file
/// A load that measures signals and commands efforts: what all controllers share.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/control/control_block.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {

/// What the scene says of a controller's ends.
struct ControlEnds {
  std::vector<std::string> of;    ///< signals; empty: the coordinate that `hinge` names
  bool measures_nothing = false;  ///< not even that
  bool rate_too = false;          ///< behind each signal, which is a coordinate then, the rate that is its derivative
  bool rate_of_hinge = false;     ///< behind all signals the rate that `hinge` names
  std::vector<std::string> to;    ///< loads of type input; empty: the rate that `hinge` names
  bool acts = true;               ///< false: its command is for loads that measure it
  std::vector<std::string> also;  ///< measured behind all else
  std::optional<RateName> hinge;  ///< the rate it acts on, or is about
  double sample = 0;              ///< [s]; 0: continuous in time
  std::size_t delay = 0;          ///< samples between a measurement and its effort
};

/// `of`, `to`, `hinge`, `component`, `sample` and `delay`, then the controller's own.
std::vector<ParameterSpec> control_parameters(std::vector<ParameterSpec> own);
/// What `control_parameters` has read; nothing after a reported error.
std::optional<ControlEnds> read_ends(const Value& p, const MakeContext& context);
/// Of a block that others measure: it acts on nothing where the scene names no place. \param signals that it measures
std::optional<ControlEnds> read_signal_ends(const Value& p, const MakeContext& context, std::size_t signals);
/// The load of these ends around a block.
std::unique_ptr<Load> make_control(ControlEnds ends, std::shared_ptr<const ControlBlock> block);

}  // namespace withy
