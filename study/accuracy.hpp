/// \file
/// The accuracy asked of a scene's outputs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/measures.hpp"

namespace withy::study {

/// What a relative error of each output is a share of: its own range, or where it hardly moves its floor. An effort's
/// floor is a thousandth of the greatest kinetic energy over a radian, or over the length of the longest body.
/// The same goes for what sensors show in these units; of all that they show, a thousandth of what the same sensor's
/// other numbers of that unit move is a floor too, and 1e-7 of the unit.
/// \param ranges greatest distances of the outputs from their start
/// \param energy greatest kinetic energy of the same run [J]
Distances scales(const Outputs& outputs, const Distances& ranges, double energy);
/// The greatest error over its scale; what has none does not count.
double relative_error(const Distances& distances, const Distances& scales);
/// What the floors are, in a sentence.
const char* floors_text();

/// A share of each output's own range, or a distance, or one of each.
struct Accuracy {
  std::optional<double> share;   ///< of each output's scale
  std::optional<double> angle;   ///< [rad]
  std::optional<double> length;  ///< [m]

  /// Reads "1%", "0.01", "2 mm", "0.1 deg", or several of them with commas between. \throws InputError
  static Accuracy parse(const std::string& text, const std::string& option = "accuracy");
  /// Greatest distance allowed of each output, given what shares are of; infinite where nothing is asked of it. What
  /// has no scale may be off by 1e-9 of its unit.
  [[nodiscard]] Distances limits(const Outputs& outputs, const Distances& scales) const;
  /// \throws InputError where it asks nothing of any output
  void require_something_of(const Outputs& outputs) const;
  /// "1 %, 2 mm".
  [[nodiscard]] std::string text() const;
  /// One that allows this many times as much, rounded up to two digits; a share to 100 % at most.
  [[nodiscard]] Accuracy times(double factor) const;
  /// As parse() reads it: "1%,2mm".
  [[nodiscard]] std::string option() const;
};

/// Relative errors, as "1%" or "0.01". \throws InputError naming the option where one is none
std::vector<double> read_shares(const std::vector<std::string>& texts, const std::string& option);

}  // namespace withy::study
