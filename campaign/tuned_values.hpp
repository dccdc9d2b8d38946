/// \file
/// Values of a scene that are fitted, and the coordinates that a fit sees of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "withy/study/point.hpp"
#include "withy/study/prepared.hpp"

namespace withy::campaign {

/// A value of the scene that is fitted. A fit sees its coordinate z: the value is start·eᶻ where the scene takes no
/// other sign, so that a change by 1 is one by a factor of e whatever the unit; else start + scale·z.
struct TunedValue {
  std::string path;      ///< "bodies.link1.bending_y.stiffness"
  std::string unit;      ///< of the numbers here: the one that the scene writes, else SI; empty of ratios
  bool written = false;  ///< the scene writes the unit
  double start = 0;      ///< the scene's
  bool logarithmic = false;
  double scale = 1;             ///< size of start; of 0 half of the bounds' distance, without them 1
  double least = 0, most = 0;   ///< bounds; infinite where there are none
  double lower = 0, upper = 0;  ///< the same of z

  [[nodiscard]] double value(double z) const;
  [[nodiscard]] double coordinate(double value) const;
  /// dvalue/dz.
  [[nodiscard]] double slope(double z) const;
};

/// Reads "path", "path=2..3", "path=2 mm..3 mm", "path=..3" for numbers of the scene.
/// \param problems gets what is wrong
std::vector<TunedValue> read_tuned(const std::vector<std::string>& texts, const study::Prepared& scene,
                                   Registry& registry, std::vector<std::string>& problems);

/// The scene with other values, one number for each.
SceneValues with_values(const SceneValues& scene, std::span<const TunedValue> tuned, std::span<const double> values);

/// What of the scene's file changes with these values. Elements of a list change with it as a whole.
std::vector<study::Change> changes_of(const SceneValues& scene, std::span<const TunedValue> tuned,
                                      std::span<const double> values);

}  // namespace withy::campaign
