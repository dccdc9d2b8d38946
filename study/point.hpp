/// \file
/// The models and integrations that studies go through: points, and what each changes in a scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/scene/scene.hpp"

namespace withy::study {

/// A model of a scene and how it is integrated.
struct Point {
  std::string formulation;
  /// Of bending modes, and of strains that it fits as well; empty: the scene's. `clamped-loaded` knows what each beam
  /// carries (tip_load.hpp), and is `clamped-free` where that is nothing.
  std::string family;
  int modes = 0;  ///< of each family of a body that has a number of them; 0: those of the scene
  std::string integrator;
  double tolerance = 0;           ///< relative; the absolute one is absolute_tolerance()
  std::vector<std::string> over;  ///< `path=value`
  /// Bodies whose formulation is another, with its name.
  std::vector<std::pair<std::string, std::string>> bodies{};

  /// The same for the same point, and fit for a file's name.
  [[nodiscard]] std::string key() const;
  /// "quadratic", "quadratic (boom, mast: ruthless)".
  [[nodiscard]] std::string formulation_text() const;
  /// "quadratic, 2 modes, dopri5 at 1e-06".
  [[nodiscard]] std::string text() const;
  /// Whether both are one model, however it is integrated.
  [[nodiscard]] bool same_model(const Point& other) const;
};

/// A hundredth of the relative tolerance, to six digits.
double absolute_tolerance(double relative);

/// A value of the scene that is gone over.
struct Variation {
  std::string path;
  std::vector<std::string> values;  ///< texts, as in a file
};

/// Values of each axis of a study.
struct Axes {
  std::vector<std::string> formulations;
  std::vector<std::string> families;  ///< of bending; empty text: the scene's
  std::vector<int> modes;             ///< of each family that a body has; 0: those of the scene
  std::vector<std::string> integrators;
  std::vector<double> tolerances;  ///< relative
  std::vector<Variation> over;
};
/// For axes that a user gives. \throws InputError where a number of modes or a tolerance cannot be, or a formulation is
/// `auto`.
void check_axes(const Axes& axes);
/// The product of the axes, formulations varying slowest.
std::vector<Point> points_of(const Axes& axes);

/// A value at a path of the scene.
struct Change {
  std::string path;
  Value value;
  /// "bodies.link1.bending_y.modes=2".
  [[nodiscard]] std::string text() const;
};

/// What makes the scene the point's, in the order in which it is to be set. Initial modal coordinates keep their
/// numbers, modes that are new start at rest; where the family is another they are those of the same shape.
/// Formulations that single bodies have become the point's.
std::vector<Change> changes_at(const Scene& scene, const Point& point, Registry& registry);
/// The values of the scene at the point.
/// \param scene made from these values
SceneValues values_at(SceneValues values, const Scene& scene, const Point& point, Registry& registry);

/// The values of the scene with `more` modes more of each that a body has; those that are new start at rest.
/// \param scene made from these values
SceneValues with_more_modes(SceneValues values, const Scene& scene, int more, Registry& registry);

}  // namespace withy::study
