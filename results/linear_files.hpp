/// \file
/// Linear models as JSON and as arrays for MATLAB and NumPy.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "withy/results/array_files.hpp"
#include "withy/study/linear_model.hpp"

namespace withy {

/// What `withy linearize` prints.
nlohmann::ordered_json linear_model_json(const study::Configuration& configuration, const study::LinearModel& linear);
/// A, B, C, D, names, units and the period, as the JSON has them.
std::vector<NamedArray> linear_model_arrays(const study::LinearModel& linear);

/// Rows of a matrix as lists.
nlohmann::ordered_json rows_json(const Eigen::MatrixXd& matrix);

}  // namespace withy
