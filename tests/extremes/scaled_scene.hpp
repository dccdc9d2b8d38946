/// \file
/// A scene in other units of mass, length and time: the same physics in other numbers.
#pragma once

#include <filesystem>

#include "campaign.hpp"

namespace withy::extremes {

/// Numbers are multiplied by 2^mass a kilogram, 2^length a metre, 2^time a second.
struct Gauge {
  int mass = 10;
  int length = 4;
  int time = 2;
  /// Factor of a quantity in this unit, as "N m^2": a power of two.
  [[nodiscard]] double factor(const std::string& unit) const;
};

/// Text of the scene in the units of the gauge, without its initial state: every number by the unit that its parameter
/// declares. Files of Standard Input Data from which bodies take their numbers are copied into `folder`, scaled, and
/// named instead. \throws sid::FormatError where a body's file is of another kind.
std::string scaled_text(const Scene& scene, Registry& registry, const Gauge& gauge,
                        const std::filesystem::path& folder);
/// Factors of the elements of y, times 2^(derivatives × −time) each. Modes of torsion are angles, others lengths.
std::vector<double> state_factors(const Model& model, const Gauge& gauge, int derivatives = 0);

}  // namespace withy::extremes
