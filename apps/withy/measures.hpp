/// \file
/// The outputs that errors are measured on, and the accuracy asked of them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy::app {

/// Outputs of one measure share a scale: the greatest way that any of them goes.
enum class Measure {
  angle,      ///< of a hinge [rad]; of orientations the angle between them
  slide,      ///< of a hinge [m]
  place,      ///< of a tip, in the world [m]
  deflection  ///< of a tip, against its body's root [m]
};
inline constexpr std::size_t measures = 4;
/// One number for each measure.
using PerMeasure = std::array<double, measures>;
/// "angle", "slide", "place", "deflection".
const char* measure_name(std::size_t measure);
/// "rad" or "m".
const char* measure_unit(std::size_t measure);

/// What is asked: a share of the greatest way, or a distance, or one of each.
struct Accuracy {
  std::optional<double> share;   ///< of the greatest way of a measure's outputs
  std::optional<double> angle;   ///< [rad]
  std::optional<double> length;  ///< [m]
  /// Reads "1%", "0.01", "2 mm", "0.1 deg", or several of them with commas between. \throws InputError
  static Accuracy parse(const std::string& text);
  /// Greatest distance allowed of each measure, given the ways; infinite where nothing is asked of it. What does not
  /// move has 1e-9 of its unit.
  [[nodiscard]] PerMeasure limits(const PerMeasure& ways) const;
  [[nodiscard]] std::string text() const;
};

/// The outputs by name; values of models with the same tree can be compared, whatever their modes and formulation.
class MeasuredOutputs {
 public:
  /// \param names hinges, `body.tip`, `body.tip.deflection`; empty: every hinge that no motion drives and every tip.
  /// \throws InputError where there is no such output.
  MeasuredOutputs(const Model& model, const std::vector<std::string>& names);
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(Measure measure) const;
  /// Appends the outputs at y to the values.
  void read(const Model& model, const EquationsOfMotion& equations, std::span<const double> y,
            std::vector<double>& values) const;
  /// Numbers that one reading appends.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Raises the greatest distances by those of two readings.
  void compare(std::span<const double> a, std::span<const double> b, PerMeasure& greatest) const;

 private:
  enum class Shape { number, vector, orientation };
  struct Output {
    std::string name;
    Measure measure;
    Shape shape;
    std::size_t index;       ///< of the hinge, or of the tip among tips(model)
    std::size_t coordinate;  ///< first one among the hinge's
    std::size_t at;          ///< first of its numbers in a reading
  };
  void add_hinge(const Model& model, std::size_t hinge);
  void add(Output output);

  std::vector<Output> outputs_;
  std::size_t size_ = 0;
};

}  // namespace withy::app
