/// \file
/// The linear model of small motions about a state, ẋ = A x + B u, y = C x, with names.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/configuration.hpp"

namespace withy::study {

struct LinearModel {
  std::vector<std::string> states;   ///< displacements of the free speeds, their rates, continuous states of loads
  std::vector<std::string> inputs;   ///< efforts on speeds [N m, N]
  std::vector<std::string> outputs;  ///< coordinates, rates, deflections and places of tips [rad, m, s]
  std::vector<double> output_values;
  Eigen::MatrixXd A, B, C;                                    ///< D is zero
  std::vector<std::pair<std::string, double>> accelerations;  ///< of the free speeds at the state
  bool equilibrium = false;                                   ///< nothing that is free moves or begins to
  std::string derivatives;                                    ///< how they were found
};

/// What goes in and comes out.
struct Ports {
  std::vector<std::string> inputs;   ///< hinges or speeds; `all` is every speed; empty: every hinge
  std::vector<std::string> outputs;  ///< names or their beginnings up to a dot; empty: every output
};

/// \throws InputError where there is no such input or output; std::domain_error where the mass matrix of what is free
/// is singular.
LinearModel linear_model(const Configuration& configuration, const Ports& ports);

}  // namespace withy::study
