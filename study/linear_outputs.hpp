/// \file
/// Outputs of linear models: what every model has, by exact derivatives, and sensors, by differences.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/study/small_motions.hpp"

namespace withy::study {

/// An output: a sensor's component, or y = value + row · (δ, δu) of all speeds.
struct LinearOutput {
  Column column;
  int sensed = -1;  ///< index among the sensors' columns; −1: it has a row
  double value = 0;
  Eigen::RowVectorXd row = {};
  std::string in_tables = {};  ///< what result tables call it, where that is another name
};

/// The outputs asked for, as Ports::outputs. \throws InputError where there is no such output
std::vector<LinearOutput> linear_outputs(const Configuration& configuration, const std::vector<std::string>& names);

/// Rows of C of outputs that have rows.
Eigen::RowVectorXd row_of_free(const LinearOutput& output, const std::vector<Eigen::Index>& free);

/// Derivatives of what all sensors show.
struct SensedDerivatives {
  Eigen::VectorXd values;
  Eigen::MatrixXd by_state;  ///< columns × size
  /// One a column: greatest change of an element at the last refinement, over the greatest of its unit.
  Eigen::VectorXd uncertainty;
};
/// By central differences of eighth order. \throws std::domain_error as SmallMotions::sensed
SensedDerivatives sensed_derivatives(SmallMotions& motions);
/// Derivative with respect to a number that makes states.
template <class StateAt>
Eigen::VectorXd sensed_slope(SmallMotions& motions, StateAt&& state_at, double step) {
  return adaptive_difference([&](double h) -> Eigen::VectorXd { return motions.sensed(state_at(h)); }, step).slope;
}

}  // namespace withy::study
