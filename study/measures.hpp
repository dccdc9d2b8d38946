/// \file
/// The outputs that errors are measured on: the one measure of how far two runs of a scene are apart.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/tips.hpp"

namespace withy::study {

/// What an output is a distance of.
enum class Measure {
  angle,       ///< of a hinge [rad]; of orientations the angle between them
  slide,       ///< of a hinge [m]
  place,       ///< of a tip, in the world [m]
  deflection,  ///< of a tip, in the frame of its body's root [m]
  moment,      ///< that a motion needs on a speed it prescribes [N m]
  force,       ///< the same [N]
  sensor       ///< of an output that the scene names, or of a rate of a hinge, in its own unit
};
inline constexpr std::size_t measures = 7;
/// One number for each measure.
using PerMeasure = std::array<double, measures>;
/// "angle", "slide", "place", "deflection", "moment", "force", "sensor".
const char* measure_name(std::size_t measure);
/// "rad", "m", "N m" or "N"; of a sensor, which has its own, empty.
const char* measure_unit(std::size_t measure);

/// Of the integral over time of what has this unit: "N m s"; "s" of a number without one.
std::string unit_over_time(const std::string& unit);

/// One number for each output, in the order of Outputs::list() [rad, m, N m, N].
using Distances = std::vector<double>;

/// Something that a run gives at each of its outputs: a number, a vector or an orientation; or what a number of a
/// sensor has been over the run so far, at the readings. That is two numbers, the second the range that it is measured
/// by: how far the sensor's number has been from where it began, of an integral times the span.
struct Output {
  enum class Shape { number, vector, orientation, least, greatest, mean, rms, integral };
  std::string name;  ///< of the hinge, or as "link2.tip", "link2.tip.deflection", "axle.motion_effort"
  Measure measure = Measure::angle;
  Shape shape = Shape::number;
  std::size_t index = 0;  ///< of the hinge, or of the tip among measured_ends(model)
  /// First one among the hinge's coordinates, of efforts and rates among its speeds: models with other modes have them
  /// elsewhere. Of sensors the first of its numbers among those of all.
  std::size_t coordinate = 0;
  /// A range below this counts as this: a thousandth of a radian, of the body's length for deflections, of the longest
  /// body for slides and places. Efforts have none of their own: see `scales`.
  double floor = 0;
  std::string label = {};  ///< the name, told apart from others of that name: "float.slide", "cross.1"
  std::size_t at = 0;      ///< first of its numbers in a reading
  std::string unit = {};   ///< SI
  /// How many numbers it has in a reading.
  [[nodiscard]] std::size_t numbers() const;
  /// Whether it is a number for the whole run, known at its end.
  [[nodiscard]] bool over_a_run() const { return shape >= Shape::least; }
  bool is_rate = false;  ///< of a hinge: no sensor shows it
  /// Of sensors: the place of the sensor in the scene; rates of a hinge are as those of one sensor. What hardly moves
  /// beside others of its sensor and unit counts as moving a thousandth as much as they do.
  std::size_t group = 0;
};

/// Outputs of a scene. Those of models with the same hinges and tips can be compared, whatever their modes.
class Outputs {
 public:
  /// Every hinge that no motion drives, place and deflection of every tip, and the efforts that motions need; with
  /// names, what these name: hinges, `hinge.rate` and other columns of rates, `body.tip`, `body.tip.deflection`,
  /// `hinge.motion_effort`; outputs of the scene, whole or one component as `root.mz`, and what a component or a rate
  /// has been over the run as `root.mz.max` (`min`, `max`, `mean`, `rms`, `integral`). An orientation among all
  /// components of one is measured as the angle of the rotation between two.
  /// \param sensors of the scene, bound to the model
  /// \throws InputError where there is no such output, or nothing to measure.
  explicit Outputs(const Model& model, const std::vector<std::string>& names = {},
                   std::span<const SensorNode> sensors = {});
  /// The same with the hinges that motions drive; there may be none.
  static Outputs all(const Model& model);

  [[nodiscard]] const std::vector<Output>& list() const { return outputs_; }
  /// Each name once.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(Measure measure) const;
  /// Numbers of a reading.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Raises the greatest distances by those of two readings; what is no number is infinitely far. Of what numbers have
  /// been over the run the distance is that of the last readings: two runs may come to the same extreme one after the
  /// other.
  void raise(std::span<const double> a, std::span<const double> b, Distances& greatest) const;
  /// Raises the ranges that errors are measured by: how far a reading is from the first.
  void raise_ranges(std::span<const double> values, std::span<const double> first, Distances& ranges) const;
  /// Zero for each output.
  [[nodiscard]] Distances none() const { return Distances(outputs_.size(), 0.0); }
  /// The greatest of each measure.
  [[nodiscard]] PerMeasure per_measure(const Distances& distances) const;
  /// Length of the longest body [m]; 0 where none has a length.
  [[nodiscard]] double length() const { return length_; }

 private:
  explicit Outputs(double length) : length_(length) {}
  void add(Output output);
  void add_hinge(const Model& model, std::size_t hinge);
  void add_effort(const Model& model, std::size_t hinge);
  void add_all(const Model& model, const std::vector<Tip>& tips, bool driven);
  void add_tip(const Tip& tip, std::size_t index, bool deflection);
  void add_named(const Model& model, const std::vector<Tip>& tips, const std::string& name,
                 std::span<const SensorNode> sensors);
  void add_rates(const Model& model, const std::string& name, std::size_t sensors,
                 Output::Shape over = Output::Shape::number);
  void add_over(Output number, Output::Shape over);
  void add_sensors(const std::string& name, std::span<const SensorNode> sensors,
                   Output::Shape over = Output::Shape::number);

  std::vector<Output> outputs_;
  std::size_t size_ = 0;
  double length_ = 0;
};

/// Greatest distances between two runs, by name.
struct NamedDistances {
  /// Difference of coordinates [rad, m]; of orientations the angle [rad] between them, of a free hinge the greater of
  /// that and the distance [m].
  std::map<std::string, double> hinges;
  std::map<std::string, double> tips;         ///< distance in the world [m]
  std::map<std::string, double> deflections;  ///< of tips, in the frame of their body's root [m]
  std::map<std::string, double> moments;      ///< that motions need [N m]
  std::map<std::string, double> forces;       ///< the same [N]
  std::map<std::string, double> sensors;      ///< by the labels of single outputs, each in its unit
  double until = 0;                           ///< time [s] of the last output both have
  [[nodiscard]] std::map<std::string, double>& of(Measure measure);
  [[nodiscard]] double greatest_hinge() const;
  [[nodiscard]] double greatest_tip() const;
};
NamedDistances named(const Outputs& outputs, const Distances& distances, double until);

}  // namespace withy::study
