/// \file
/// Default classes of MJCF, and how its elements are turned.
#pragma once

#include <map>
#include <string>

#include "attributes.hpp"
#include "xml.hpp"

namespace withy::exchange {

/// Attributes by default class and element; a class has those of the classes around it.
class MjcfDefaults {
 public:
  /// \param element <default>, with those inside
  void add(const Element& element, const std::string& around = {});
  /// The element with the attributes that its class gives it. \param around the class of `childclass`, or empty
  [[nodiscard]] Element completed(const Element& element, const std::string& around, Diagnostics& diagnostics) const;

 private:
  using OfElement = std::map<std::string, std::string>;
  std::map<std::string, std::map<std::string, OfElement>> classes_;
};

/// What <compiler> says of angles.
struct MjcfAngles {
  double unit = 3.14159265358979323846 / 180;  ///< [rad]
  std::string euler = "xyz";

  /// The rotation by quat, axisangle, euler, xyaxes or zaxis; identity where there is none of them.
  [[nodiscard]] Matrix3 rotation(const Element& element, Diagnostics& diagnostics) const;
};

}  // namespace withy::exchange
