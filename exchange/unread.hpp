/// \file
/// What stands in a model file and has no meaning there, or has one that is not read.
#pragma once

#include <string>
#include <vector>

#include "xml.hpp"

namespace withy::exchange {

/// Remarks, a sentence for each kind of element or attribute of <robot> that read_urdf takes no notice of, such as
/// misspelled ones and further <inertial>s of a link. Nothing is said of looks, collisions, transmissions,
/// calibrations, <gazebo>, <ros2_control>, and names with a prefix.
std::vector<std::string> unread_of_urdf(const Element& robot);
/// The same of the attributes of bodies, joints, geoms and <inertial>s in <mujoco> and its defaults that MJCF does not
/// have, as of versions to come.
std::vector<std::string> unread_of_mjcf(const Element& mujoco);

}  // namespace withy::exchange
