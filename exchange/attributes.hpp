/// \file
/// Numbers in the attributes of XML elements, checked, with their places.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "withy/core/spatial/pose.hpp"
#include "xml.hpp"

namespace withy::exchange {

/// Reads attributes; what is wrong goes to the diagnostics and is read as the default.
class Attributes {
 public:
  Attributes(const Element& element, Diagnostics& diagnostics) : element_(element), diagnostics_(diagnostics) {}

  /// The finite numbers of an attribute, between `least` and `most` of them; nothing where it is absent or wrong.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key, std::size_t least,
                                                           std::size_t most) const;
  [[nodiscard]] double number(std::string_view key, double otherwise) const;
  [[nodiscard]] Vector3 vector(std::string_view key, const Vector3& otherwise) const;
  /// A direction, scaled to unit length; zero is reported.
  [[nodiscard]] Vector3 direction(std::string_view key, const Vector3& otherwise) const;
  /// The text; empty after reporting that it is missing.
  [[nodiscard]] std::string required(std::string_view key) const;
  void error(std::string_view key, const std::string& what) const;

 private:
  const Element& element_;
  Diagnostics& diagnostics_;
};

/// Ixx … of an inertia about a point to one in a frame that is turned by R.
inline Matrix3 turned(const Matrix3& R, const Matrix3& inertia) { return R * inertia * R.transpose(); }
/// Elements in the order xx, yy, zz, xy, xz, yz.
Matrix3 inertia_matrix(double xx, double yy, double zz, double xy, double xz, double yz);
/// Empty where a distribution of mass may have this central inertia [kg m²], else what is wrong with it.
std::string inertia_problem(double mass, const Matrix3& inertia);

}  // namespace withy::exchange
