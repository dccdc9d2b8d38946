/// \file
/// Errors of natural frequencies about steady states, as a value of the scene changes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/modes.hpp"
#include "withy/study/point.hpp"

namespace withy::study {

/// What frequencies of a scene are asked for.
struct FrequencyQuestion {
  std::vector<Point> points;
  Sweep sweep;  ///< at least two values
  Holding holding;
  std::size_t count = 2;  ///< modes that are looked at
};

/// Frequencies of models of one scene against a reference: the first of `reference_formulations` that every body can be
/// in, with one mode more than any model. A mode bears the name of a coordinate: it is the one of whose |δ_i|² M_ii
/// this coordinate has the greatest share.
class FrequencyStudy {
 public:
  /// `base` and `registry` must outlive it. \throws InputError, SceneError, PluginError
  FrequencyStudy(const Prepared& base, Registry& registry, FrequencyQuestion question);

  /// The lowest modes of the reference, none of them rigid, named after what dominates them at the sweep's second value
  /// (at its first a symmetry of the scene at rest may mix them).
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// |ω / ω of the reference − 1|; infinite where the model has no steady state, or the mode grows.
  /// \throws InputError where the reference has no such frequency.
  double error(const Point& point, const std::string& name, double value);
  /// Of the reference [rad/s].
  double reference_frequency(const std::string& name, double value);
  [[nodiscard]] const Point& reference() const { return reference_; }
  /// The least value of those looked at where the reference's equations of small motions change as hinges turn: its
  /// frequencies there are those of one angle. Nothing where they do at none.
  [[nodiscard]] std::optional<double> frozen_from() const;
  /// The greatest error of the named frequencies of the reference with one mode less, at the sweep's ends.
  double reference_error();

 private:
  [[nodiscard]] ModesAt find(const Point& point, double value) const;
  const ModesAt& reference_at(double value);

  const Prepared& base_;
  Registry& registry_;
  FrequencyQuestion question_;
  Point reference_;
  std::map<double, ModesAt> references_;
  std::map<std::pair<std::string, double>, ModesAt> found_;  ///< of points, by their text and value
  std::vector<std::string> names_;
};

}  // namespace withy::study
