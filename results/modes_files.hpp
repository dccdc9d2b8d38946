/// \file
/// Steady states, modes and linear models as JSON, table and picture.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/formulation_modes.hpp"

namespace withy {

/// Outcome, efforts on what is held, and the state in the form of state files.
nlohmann::ordered_json steady_json(const Model& model, const SteadyState& steady, const Held& held);
/// An element of "runs" in modes.json.
nlohmann::ordered_json modes_json(const study::ModesOf& run);
/// How far a result is from that of the next model up; null where there is none.
nlohmann::ordered_json against_json(const std::optional<study::AgainstNext>& against);
/// A line a formulation, value and branch.
std::string modes_csv(const std::vector<study::ModesOf>& runs, const std::string& label);
/// Frequencies over the value, and where something grows the rates of growth and of decay, down to four times the
/// greatest growth.
std::string modes_picture(const std::vector<study::ModesOf>& runs, const std::string& title, const std::string& label,
                          std::size_t count);

/// Whether equal blades were seen from where the rotor does not turn, at any value.
bool sees_blades(const std::vector<study::ModesOf>& runs);
/// The modes of equal blades seen from where the rotor does not turn: a line a formulation, value and mode.
std::string blades_csv(const std::vector<study::ModesOf>& runs, const std::string& label);
/// Their frequencies over the value, a curve a branch; of a rotor's rate with those of one turn and of the passing
/// blades; growth as in modes_picture.
std::string blades_picture(const std::vector<study::ModesOf>& runs, const std::string& title, const study::Sweep& sweep,
                           std::size_t count);

/// The content of modes.json.
nlohmann::ordered_json modes_study_json(const std::string& scene, const study::Sweep& sweep,
                                        const study::ModesFound& found);
/// Writes modes.json with this content, modes.csv, of a sweep modes.svg, of equal blades blades.csv and blades.svg too,
/// and the page.
void write_modes(const std::filesystem::path& folder, const std::vector<study::ModesOf>& runs,
                 const nlohmann::ordered_json& content, const std::string& title, const study::Sweep& sweep,
                 std::size_t count);

}  // namespace withy
