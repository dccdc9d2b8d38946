/// \file
/// Default classes of MJCF, and how its elements are turned.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "attributes.hpp"
#include "xml.hpp"

namespace withy::exchange {

/// Attributes by default class and element; a class has those of the classes around it. Of axisangle, euler, xyaxes and
/// zaxis the innermost counts alone, and before any `quat`, also one further inside, as in MuJoCo.
class MjcfDefaults {
 public:
  /// \param element <default> of the top level, with those inside. Whatever class it names is that of all elements
  ///   without one: MuJoCo takes it so up to 3.1.6, and refuses it since
  void add_global(const Element& element, std::vector<std::string>& remarks);
  /// The element with the attributes that its class gives it. \param around the class of `childclass`, or empty
  [[nodiscard]] Element completed(const Element& element, const std::string& around, Diagnostics& diagnostics) const;

 private:
  using OfElement = std::map<std::string, std::string>;
  void add(const Element& element, const std::string& name, const std::string& around);

  std::map<std::string, std::map<std::string, OfElement>> classes_;
  std::set<std::string> global_;  ///< other names of the class `main`
};

/// Whether an element says itself, in any form, how it is turned.
bool turns_itself(const Element& element);
/// Reports an element that gives its orientation in several forms, before defaults complete it.
void check_orientation(const Element& element, Diagnostics& diagnostics);

/// What <compiler> says of angles.
struct MjcfAngles {
  double unit = 3.14159265358979323846 / 180;  ///< [rad]
  std::string euler = "xyz";

  /// The rotation by axisangle, euler, xyaxes or zaxis, else by quat; identity where there is none of them.
  [[nodiscard]] Matrix3 rotation(const Element& element, Diagnostics& diagnostics) const;
};

}  // namespace withy::exchange
