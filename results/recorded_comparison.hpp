/// \file
/// Comparisons that leave a folder behind: each run with its results, a picture and a page for each value gone over.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "withy/results/comparison_report.hpp"
#include "withy/results/provenance.hpp"
#include "withy/study/control.hpp"
#include "withy/study/point.hpp"

namespace withy {

struct ComparisonQuestion {
  std::vector<std::string> formulations;
  std::string reference;             ///< formulation that the others' errors are measured against
  std::vector<std::string> outputs;  ///< that errors are measured on; empty: all of the usual ones
  study::Variation over;             ///< gone over; path empty and one value: the scene as it is
};

/// What the comparison leaves in its folder, compare.json included.
std::vector<std::string> comparison_content(const ComparisonQuestion& question);

/// Where the pages of a comparison are, or its pictures where there are no pages: a line.
std::string comparison_places(const std::filesystem::path& folder, const study::Variation& over);

/// Compares at each value, and ends early where the user interrupts: what was compared up to there.
/// \param folder empty: nothing is kept \param provenance of a run by its scene \param control of a run by its
/// formulation \throws SceneError, InputError, PluginError; std::system_error where something cannot be written
std::vector<ComparisonAt> record_comparison(const std::filesystem::path& folder, const SceneValues& values,
                                            Registry& registry, const ComparisonQuestion& question,
                                            const std::function<Provenance(const Scene&)>& provenance,
                                            const std::function<study::Control(const std::string&)>& control);

}  // namespace withy
