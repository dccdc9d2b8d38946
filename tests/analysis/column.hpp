/// \file
/// Columns that fall: the load at which the tangent stiffness of the straight beam is singular.
#pragma once

#include <Eigen/Dense>
#include <sstream>

#include "blade.hpp"

namespace withy::test {

/// The lowest load in [low, high] at which the tangent stiffness of the straight beam is singular; 0: none.
template <class TextOfLoad>
double critical_load(TextOfLoad&& text, const std::string& formulation, double low, double high) {
  const auto determinant = [&](double load) {
    AnalysedScene c(text(load), formulation);
    const Held held(c.layout().speeds, false);
    const Tangents t = c.dynamics->tangents(0, c.state.y, Eigen::VectorXd::Zero(c.speeds()));
    return t.by_position.determinant();
  };
  const double start = determinant(low);
  if (determinant(high) * start > 0) return 0;
  for (int i = 0; i < 34; ++i) {
    const double middle = 0.5 * (low + high);
    (determinant(middle) * start > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Along −x on a beam that stands along x.
inline std::string column(double g, int modes, double mass_per_length, double tip,
                          const std::string& family = "clamped-free") {
  std::ostringstream s;
  s.precision(17);
  s << "format: withy/1\ntime: {end: 1}\ngravity: [" << -g << ", 0, 0]\nbodies:\n  mast: {type: beam, length: 1, "
    << "mass_per_length: " << mass_per_length << ", bending_y: {stiffness: 1, modes: " << modes
    << ", family: " << family << "}}\n";
  if (tip > 0) s << "  top: {type: rigid, mass: " << tip << "}\n";
  s << "hinges:\n  foot: {type: weld, parent: world, child: mast}\n";
  if (tip > 0) s << "  end: {type: weld, parent: mast.tip, child: top}\n";
  return s.str();
}

}  // namespace withy::test
