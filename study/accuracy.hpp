/// \file
/// The accuracy asked of a scene's outputs.
#pragma once

#include <optional>
#include <string>

#include "withy/study/measures.hpp"

namespace withy::study {

/// What a relative error of each output is a share of: the greatest way of the outputs of its measure [rad, m].
Distances scales(const Outputs& outputs, const Distances& ways);
/// The greatest error over its scale; what does not move has none.
double relative_error(const Outputs& outputs, const Distances& distances, const Distances& ways);

/// A share of the greatest way, or a distance, or one of each.
struct Accuracy {
  std::optional<double> share;   ///< of the greatest way of a measure's outputs
  std::optional<double> angle;   ///< [rad]
  std::optional<double> length;  ///< [m]

  /// Reads "1%", "0.01", "2 mm", "0.1 deg", or several of them with commas between. \throws InputError
  static Accuracy parse(const std::string& text);
  /// Greatest distance allowed of each output, given the ways that outputs go from their start; infinite where nothing
  /// is asked of it. What does not move may be off by 1e-9 of its unit.
  [[nodiscard]] Distances limits(const Outputs& outputs, const Distances& ways) const;
  /// \throws InputError where it asks nothing of any output
  void require_something_of(const Outputs& outputs) const;
  /// "1 %, 2 mm".
  [[nodiscard]] std::string text() const;
};

}  // namespace withy::study
