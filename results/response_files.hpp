/// \file
/// Frequency responses as text, JSON, table and pictures.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/results/svg_plot.hpp"
#include "withy/study/response.hpp"

namespace withy {

/// What `withy response --json` prints.
nlohmann::ordered_json response_json(const study::Configuration& configuration, const study::Response& response);
/// A line a frequency: Hz, gain, phase without jumps [deg], real and imaginary part.
std::string response_csv(const study::Response& response);
/// Gain and phase over frequency; of a reduced system as well.
Picture bode_picture(const study::Response& response, const std::string& title);
/// Gain over phase of the loop v = −k y, with the point that it must not pass, and the curves of equal closed loop.
Picture nichols_picture(const study::Response& response, const std::string& title);
/// The point on the first line, then what it rests on.
std::string response_text(const study::Configuration& configuration, const study::Response& response);
/// The files of a response in its folder: JSON, table, pictures and their page.
std::vector<std::string> response_content();
/// Writes them. \throws std::system_error
void write_response(const std::filesystem::path& folder, const study::Configuration& configuration,
                    const study::Response& response);

/// Phases [deg] of the values, each next to the one before: no jumps of 360.
std::vector<double> unwrapped_degrees(const std::vector<ResponseAt>& values);

}  // namespace withy
