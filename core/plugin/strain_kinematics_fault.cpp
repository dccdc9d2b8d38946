// Whether the second order that a strain kinematics gives can be one.
#include <cmath>
#include <sstream>

#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy {
namespace {

/// Of the greatest: far above the rounding of a few products, far below a term that is forgotten.
constexpr double slope_tolerance = 1e-10;

/// Fields that no two of are alike, in no direction.
SectionField some_field(int k) {
  const auto number = [k](int i) { return std::sin(1.0 + 2.3 * i + 5.1 * k); };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, {number(6), number(7), number(8)}};
}

std::string slope_fault(const char* name, const Vector3& slope, const Vector3& exchanged) {
  std::ostringstream text;
  const Eigen::IOFormat row(6, Eigen::DontAlignCols, " ", " ");
  if (!slope.allFinite()) {
    text << name << " gives (" << slope.transpose().format(row) << ")";
  } else if (!((slope - exchanged).norm() <= slope_tolerance * slope.norm())) {
    text << name << " is not symmetric: it gives (" << slope.transpose().format(row) << "), and of the same two fields "
         << "the other way round (" << exchanged.transpose().format(row) << ")";
  }
  return text.str();
}

}  // namespace

std::string find_fault(const StrainKinematics& kinematics) {
  if (kinematics.name().empty()) return "it has no name";
  if (kinematics.order() != StrainOrder::quadratic || kinematics.complete()) return {};
  const Vector3 theta(0.3, -0.2, 0.5);
  for (int k = 0; k < 3; ++k) {
    const SectionField i = some_field(2 * k), j = some_field(2 * k + 1);
    if (std::string fault =
            slope_fault("rotation_slope", kinematics.rotation_slope(i, j), kinematics.rotation_slope(j, i));
        !fault.empty())
      return fault;
    if (std::string fault = slope_fault("displacement_slope", kinematics.displacement_slope(i, j, theta),
                                        kinematics.displacement_slope(j, i, theta));
        !fault.empty())
      return fault;
  }
  return {};
}

}  // namespace withy
