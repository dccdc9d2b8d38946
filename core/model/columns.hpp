/// \file
/// Names and units of the coordinates and rates of a hinge, as result tables show them.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// One number of a table.
struct Column {
  std::string name;
  std::string unit;  ///< SI; empty for modal coordinates
};

/// Coordinates of a hinge: `shoulder` [rad] where there is one, `base.qw` [1] … `base.z` [m] for quaternions and
/// positions, `joint.0` [rad], `joint.1` [m] … for other hinges of several coordinates.
std::vector<Column> coordinate_columns(const HingeNode& hinge);
/// Their rates: `shoulder.rate` [rad/s], `base.wx` [rad/s] … `base.vz` [m/s], `joint.rate.0` [rad/s] ….
std::vector<Column> rate_columns(const HingeNode& hinge);
/// What a motion that drives it has to give: `shoulder.motion_effort` [N m], `joint.motion_effort.0` [N] ….
std::vector<Column> motion_effort_columns(const HingeNode& hinge);
/// Of an effort on a speed: "N m" or "N"; empty where no hinge has that speed.
std::string unit_of_effort(const Model& model, std::size_t speed);

/// As tables spell a name: "mode[1]" is "mode.1".
std::string spelled_in_tables(const std::string& name);

/// What is wrong with the names of a body's modes beside the other columns of tables, or empty: a mode with the name of
/// a coordinate of the tip, as "tip.x", or of a number of a hinge that is named as the body is. Two columns of one name
/// can be written to no file of results.
/// \param body index in the model
std::string mode_name_fault(const Model& model, std::size_t body);

/// What a sensor gives, as `tip.x` [m]; `drive` [N m] where a number has no name of its own.
std::vector<Column> columns_of(const SensorNode& sensor);

}  // namespace withy
