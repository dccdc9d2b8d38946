/// \file
/// What the page of modes shows.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/modes.hpp"

namespace withy {

/// What is swept, with its unit: "spin.axle [rpm]".
std::string swept_label(const study::Sweep& sweep);
/// Of each formulation its lowest branches over what is swept: frequencies, damping, the kinetic energy's shares in
/// each shape, and how like each shape is to the branch's first: MAC = |φ₀ᴴφ|² / (φ₀ᴴφ₀ φᴴφ), each speed weighted by
/// √M_ii. Where equal blades were seen from where the rotor does not turn, `blades` of a run has their number and their
/// branches, which have no shapes; of one configuration `floquet` has the exponents of a whole turn. \param count
/// branches a formulation, at least 10 where there are as many
nlohmann::ordered_json modes_page(const std::vector<study::ModesOf>& runs, const study::Sweep& sweep,
                                  std::size_t count);

}  // namespace withy
