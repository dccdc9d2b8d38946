/// \file
/// The outputs that errors are measured on: the one measure of how far two runs of a scene are apart.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/tips.hpp"

namespace withy::study {

/// What an output is a distance of.
enum class Measure {
  angle,      ///< of a hinge [rad]; of orientations the angle between them
  slide,      ///< of a hinge [m]
  place,      ///< of a tip, in the world [m]
  deflection  ///< of a tip, in the frame of its body's root [m]
};
inline constexpr std::size_t measures = 4;
/// One number for each measure.
using PerMeasure = std::array<double, measures>;
/// "angle", "slide", "place", "deflection".
const char* measure_name(std::size_t measure);
/// "rad" or "m".
const char* measure_unit(std::size_t measure);

/// One number for each output, in the order of Outputs::list() [rad, m].
using Distances = std::vector<double>;

/// Something that a run gives at each of its outputs: a number, a vector or an orientation.
struct Output {
  enum class Shape { number, vector, orientation };
  std::string name;  ///< of the hinge, or as "link2.tip", "link2.tip.deflection"
  Measure measure = Measure::angle;
  Shape shape = Shape::number;
  std::size_t index = 0;       ///< of the hinge, or of the tip among tips(model)
  std::size_t coordinate = 0;  ///< first one among the hinge's
  std::size_t at = 0;          ///< first of its numbers in a reading
};

/// Outputs of a scene. Those of models with the same hinges and tips can be compared, whatever their modes.
class Outputs {
 public:
  /// Every hinge that no motion drives and the place of every tip; with names, what these name: hinges, `body.tip`,
  /// `body.tip.deflection`. \throws InputError where there is no such output, or nothing to measure.
  explicit Outputs(const Model& model, const std::vector<std::string>& names = {});
  /// Every hinge that has coordinates, driven or not, and the place of every tip; there may be none.
  static Outputs all(const Model& model);

  [[nodiscard]] const std::vector<Output>& list() const { return outputs_; }
  /// Each hinge and tip once.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(Measure measure) const;
  /// Numbers of a reading.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Raises the greatest distances by those of two readings; what is no number is infinitely far.
  void raise(std::span<const double> a, std::span<const double> b, Distances& greatest) const;
  /// Zero for each output.
  [[nodiscard]] Distances none() const { return Distances(outputs_.size(), 0.0); }
  /// The greatest of each measure.
  [[nodiscard]] PerMeasure per_measure(const Distances& distances) const;

 private:
  Outputs() = default;
  void add(Output output);
  void add_hinge(const Model& model, std::size_t hinge);
  void add_tip(const Tip& tip, std::size_t index, bool deflection);
  void add_named(const Model& model, const std::vector<Tip>& tips, const std::string& name);

  std::vector<Output> outputs_;
  std::size_t size_ = 0;
};

/// Reads outputs from states of one model. What is given must outlive it.
class OutputReader {
 public:
  OutputReader(const Outputs& outputs, const Model& model, const EquationsOfMotion& equations);
  /// The numbers of all outputs at y, as in State.
  [[nodiscard]] std::vector<double> read(std::span<const double> y);

 private:
  const Outputs& outputs_;
  const Model& model_;
  std::unique_ptr<Observation> seen_;
  std::vector<Tip> tips_;
};

/// Greatest distances between two runs, by hinge and by tip.
struct NamedDistances {
  /// Difference of coordinates [rad, m]; of orientations the angle [rad] between them, of a free hinge the greater of
  /// that and the distance [m].
  std::map<std::string, double> hinges;
  std::map<std::string, double> tips;  ///< distance in the world [m]
  double until = 0;                    ///< time [s] of the last output both have
  [[nodiscard]] double greatest_hinge() const;
  [[nodiscard]] double greatest_tip() const;
};
NamedDistances named(const Outputs& outputs, const Distances& distances, double until);

}  // namespace withy::study
