/// \file
/// Joints of MJCF, and what <option><flag> switches off.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "mjcf_defaults.hpp"
#include "tree.hpp"

namespace withy::exchange {

/// Forces that a model switches off: "gravity", "spring", "damper".
class MjcfFlags {
 public:
  /// \param flag <flag>; the later of two that disagree counts
  void read(const Element& flag, Diagnostics& diagnostics);
  [[nodiscard]] bool off(const std::string& force) const { return off_.contains(force); }

 private:
  std::set<std::string> off_;
};

/// Reads joints. What has no place in a scene, or is switched off, goes to the remarks.
struct MjcfJoints {
  const MjcfAngles& angles;
  const MjcfFlags& flags;
  std::vector<std::string>& remarks;
  Diagnostics& diagnostics;

  /// \param element <joint> or <freejoint> whose attributes are complete. \param name of the joint
  [[nodiscard]] Joint read(const Element& element, const std::string& name) const;

 private:
  void springs(const Attributes& a, double unit, Joint& joint) const;
  void relaxation(const Attributes& a, Joint& joint) const;
  [[nodiscard]] double acting(const Attributes& a, const Joint& joint, const char* key, const char* force) const;
  void leave_out(const Attributes& a, const Joint& joint, const char* key) const;
};

}  // namespace withy::exchange
