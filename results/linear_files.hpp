/// \file
/// Linear models as JSON and as arrays for MATLAB and NumPy.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/results/array_files.hpp"
#include "withy/study/linear_model.hpp"

namespace withy {

/// What of a model that is of one instant turns, or changes with time (LinearModel), by names.
nlohmann::ordered_json turning_json(const study::LinearModel& linear);
/// What `withy linearize` prints.
nlohmann::ordered_json linear_model_json(const study::Configuration& configuration, const study::LinearModel& linear);
/// A, B, C, D, names, units and the period, as the JSON has them.
std::vector<NamedArray> linear_model_arrays(const study::LinearModel& linear);
/// The files of a linear model in its folder, for JSON, MATLAB and NumPy.
std::vector<std::string> linear_model_content();
/// Writes them. \param content of linear.json \throws std::system_error
void write_linear_model(const std::filesystem::path& folder, const nlohmann::ordered_json& content,
                        const study::LinearModel& linear);

/// Rows of a matrix as lists.
nlohmann::ordered_json rows_json(const Eigen::MatrixXd& matrix);

}  // namespace withy
