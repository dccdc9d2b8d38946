#include "mjcf_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "withy/scene/names.hpp"

namespace withy::exchange {

void MjcfFlags::read(const Element& flag, Diagnostics& diagnostics) {
  // Models for earlier versions of MuJoCo have `passive` for springs and dampers together.
  static const std::array<std::pair<const char*, std::vector<const char*>>, 4> known = {
      {{"gravity", {"gravity"}}, {"passive", {"spring", "damper"}}, {"spring", {"spring"}}, {"damper", {"damper"}}}};
  for (const auto& [key, forces] : known) {
    const std::string* text = flag.find(key);
    if (text == nullptr) continue;
    if (*text != "enable" && *text != "disable")
      Attributes(flag, diagnostics).error(key, fmt::format("got {}; need enable or disable", in_quotes(*text)));
    for (const char* force : forces) {
      if (*text == "disable") {
        off_.insert(force);
      } else {
        off_.erase(force);
      }
    }
  }
}

Joint MjcfJoints::read(const Element& element, const std::string& name) const {
  const Attributes a(element, diagnostics);
  const std::string* given = element.find("type");
  const std::string type = element.name == "freejoint" ? "free" : given != nullptr ? *given : "hinge";
  Joint joint;
  joint.name = name;
  joint.place = element.place;
  static const std::array<std::pair<const char*, const char*>, 4> types = {
      {{"hinge", "revolute"}, {"slide", "prismatic"}, {"ball", "spherical"}, {"free", "free"}}};
  const auto* const known = std::find_if(types.begin(), types.end(), [&](const auto& t) { return type == t.first; });
  if (known == types.end()) {
    a.error("type", fmt::format("got {}; need one of: hinge, slide, ball, free", in_quotes(type)));
    return joint;
  }
  joint.type = known->second;
  if (type != "free") joint.point = a.vector("pos", Vector3::Zero());
  const double unit = type == "slide" ? 1 : angles.unit;
  if (type == "hinge" || type == "slide") joint.axis = a.direction("axis", Vector3::UnitZ());
  springs(a, unit, joint);
  if (const auto range = type == "free" ? std::nullopt : a.numbers("range", 2, 2)) {
    const double at_zero = type == "ball" ? 0 : a.number("ref", 0);  // the file's coordinate where the scene's is zero
    const std::string words = fmt::format("its range {} to {} is not enforced", unit * ((*range)[0] - at_zero),
                                          unit * ((*range)[1] - at_zero));
    joint.remark = words + (type == "ball" ? ": it limits the whole angle" : ": see hinge-limit");
  }
  if (type == "ball" || type == "free") leave_out(a, joint, "armature");
  leave_out(a, joint, "frictionloss");
  return joint;
}

/// Spring and damper of hinges and slides; those of other joints have no load in a scene.
void MjcfJoints::springs(const Attributes& a, double unit, Joint& joint) const {
  joint.armature = a.number("armature", 0);
  if (joint.type != "revolute" && joint.type != "prismatic") {
    for (const char* key : {"damping", "stiffness"}) leave_out(a, joint, key);
    if (const auto given = a.numbers("springdamper", 2, 2); given && !((*given)[0] == 0 && (*given)[1] == 0))
      remarks.push_back(
          fmt::format("joint {}: springdamper {} {} is left out", in_quotes(joint.name), (*given)[0], (*given)[1]));
    return;
  }
  joint.free_position = unit * (a.number("springref", 0) - a.number("ref", 0));
  relaxation(a, joint);
  if (joint.relaxation) return;  // it overrides the two
  joint.stiffness = acting(a, joint, "stiffness", "spring");
  joint.damping = acting(a, joint, "damping", "damper");
}

void MjcfJoints::relaxation(const Attributes& a, Joint& joint) const {
  const auto given = a.numbers("springdamper", 2, 2);
  if (!given) return;
  const double time = (*given)[0], ratio = (*given)[1];
  if (time == 0 && ratio == 0) return;
  if (time <= 0 || ratio <= 0)
    return a.error("springdamper",
                   fmt::format("got {} {}; need a time constant and a damping ratio above 0, or 0 0", time, ratio));
  joint.relaxation = Relaxation{time, ratio, !flags.off("spring"), !flags.off("damper")};
  for (const char* force : {"spring", "damper"})
    if (flags.off(force))
      remarks.push_back(
          fmt::format("joint {}: the {} of springdamper is switched off by <flag>", in_quotes(joint.name), force));
}

/// The number of a force; 0, with a remark, where a flag switches it off.
double MjcfJoints::acting(const Attributes& a, const Joint& joint, const char* key, const char* force) const {
  const double value = a.number(key, 0);
  if (value == 0 || !flags.off(force)) return value;
  remarks.push_back(fmt::format("joint {}: {} {} is switched off by <flag>", in_quotes(joint.name), key, value));
  return 0;
}

void MjcfJoints::leave_out(const Attributes& a, const Joint& joint, const char* key) const {
  if (const double value = a.number(key, 0); value != 0)
    remarks.push_back(fmt::format("joint {}: {} {} is left out", in_quotes(joint.name), key, value));
}

}  // namespace withy::exchange
