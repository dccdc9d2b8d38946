/// \file
/// The page of a study that is told by plots over one axis: its words, and its pictures to be asked.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/results/svg_plot.hpp"

namespace withy {

/// The data of such a page. Curves of more points than a plot is wide are drawn by the least and the greatest of each
/// stretch.
/// \param words what the command says, as its lines
nlohmann::ordered_json figures_json(const std::string& words, const std::vector<Picture>& pictures);
/// Writes the page; nothing where this build has none. \throws std::system_error
void write_figures_page(const std::filesystem::path& file, const std::string& title, const std::string& words,
                        const std::vector<Picture>& pictures);

}  // namespace withy
