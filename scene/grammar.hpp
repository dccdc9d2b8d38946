/// \file
/// The parts of a scene that belong to no plugin, specified as plugins specify theirs: the reader checks against these
/// and the schema prints them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/parameters.hpp"

namespace withy::grammar {

inline constexpr std::string_view default_formulation = "quadratic";
inline constexpr std::string_view default_integrator = "dopri5";

/// Members of a scene that hold plain values: format, name, gravity, time, limits, events.
const std::vector<ParameterSpec>& scene_members();
/// Keys of a scene that hold plugins or states.
std::vector<std::string> special_keys();

/// Members that every body, hinge, load, motion and sensor has beside its plugin's own.
const std::vector<ParameterSpec>& body_members();
const std::vector<ParameterSpec>& hinge_members();
const std::vector<ParameterSpec>& load_members();
const std::vector<ParameterSpec>& motion_members();
/// Members of a constraint beside those of the hinge that closes the loop.
const std::vector<ParameterSpec>& constraint_members();
const std::vector<ParameterSpec>& sensor_members();
/// The name of a chosen formulation or integrator beside the plugin's own options.
ParameterSpec choice_name(std::string_view kind, std::string_view otherwise);
/// The name of a mode family beside the plugin's own options.
ParameterSpec family_name();
ParameterSpec formulation_name();
/// A formulation with its name: `{kinematics: …, truncation: …}` is short for the formulation `general` with these.
Value named_formulation(Value given);
/// The type of a motion beside the plugin's own options.
ParameterSpec motion_type();
/// Position and orientation of a frame.
const std::vector<ParameterSpec>& pose_members();

}  // namespace withy::grammar
