/// \file
/// Derivatives of what loads do through their continuous states.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Of all loads together, z their continuous states in the order of State. Displacements δ as in Tangents.
struct ContinuousTangents {
  Eigen::MatrixXd effort_by_position, effort_by_speed;  ///< speeds × speeds
  Eigen::MatrixXd effort_by_state;                      ///< speeds × z
  Eigen::MatrixXd rate_by_position, rate_by_speed;      ///< z × speeds
  Eigen::MatrixXd rate_by_state;                        ///< z × z
  Eigen::MatrixXd rate_by_acceleration;                 ///< z × speeds
};

/// At (t, y), and rates with the accelerations a: exactly where ContinuousPart::add_derivatives does so and rates do
/// not change with a, else by central differences, and `differenced` of the load becomes true. \param displace moves y
/// by a displacement along one speed \param of_wrenches efforts on all speeds of the loads' wrenches, which see the
/// state that is given while the tree stays where it is at y: what the motion of frames does is the recursion's. Empty
/// where no such load acts at a frame.
ContinuousTangents continuous_tangents(const Model& model, double t, std::span<const double> y,
                                       std::span<const double> a,
                                       const std::function<void(std::span<double>, std::size_t, double)>& displace,
                                       const std::function<Eigen::VectorXd(std::span<const double>)>& of_wrenches,
                                       std::vector<bool>& differenced);

}  // namespace withy
