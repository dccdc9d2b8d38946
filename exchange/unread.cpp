#include "unread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

namespace withy::exchange {
namespace {

using NameSet = std::set<std::string_view>;

/// What an element may have. Its children are looked at where they are in the table themselves.
struct KnownElement {
  NameSet attributes;
  NameSet once;             ///< children, of which the first counts
  NameSet any;              ///< children, as many as there are
  bool others_too = false;  ///< children are judged elsewhere
};
using KnownElements = std::map<std::string_view, KnownElement>;

const KnownElements& urdf_elements() {
  static const KnownElements all = {
      {"robot", {{"name", "version"}, {}, {"link", "joint", "material", "transmission", "gazebo", "ros2_control"}}},
      {"link", {{"name", "type"}, {"inertial"}, {"visual", "collision"}}},
      {"inertial", {{}, {"origin", "mass", "inertia"}, {}}},
      {"joint",
       {{"name", "type"},
        {"origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "safety_controller", "mimic"},
        {}}},
      {"origin", {{"xyz", "rpy", "quat_xyzw"}, {}, {}}},
      {"mass", {{"value"}, {}, {}}},
      {"inertia", {{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}, {}}},
      {"parent", {{"link"}, {}, {}}},
      {"child", {{"link"}, {}, {}}},
      {"axis", {{"xyz"}, {}, {}}},
      {"dynamics", {{"damping", "friction"}, {}, {}}},
      {"limit", {{"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"}, {}, {}}},
      {"mimic", {{"joint", "multiplier", "offset"}, {}, {}}}};
  return all;
}

const KnownElements& mjcf_elements() {
  static const KnownElements all = {
      {"mujoco", {{"model"}, {}, {}, true}},
      {"default", {{"class"}, {}, {}, true}},
      {"worldbody", {{}, {}, {}, true}},
      {"body",
       {{"name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mocap", "gravcomp", "sleep",
         "simple", "user"},
        {},
        {},
        true}},
      {"inertial",
       {{"pos", "quat", "mass", "diaginertia", "axisangle", "xyaxes", "zaxis", "euler", "fullinertia"}, {}, {}, true}},
      {"joint",
       {{"name",
         "class",
         "type",
         "group",
         "pos",
         "axis",
         "springdamper",
         "limited",
         "actuatorfrclimited",
         "solreflimit",
         "solimplimit",
         "solreffriction",
         "solimpfriction",
         "stiffness",
         "range",
         "actuatorfrcrange",
         "actuatorgravcomp",
         "margin",
         "ref",
         "springref",
         "armature",
         "damping",
         "frictionloss",
         "user"},
        {},
        {},
        true}},
      {"freejoint", {{"name", "group", "align"}, {}, {}, true}},
      {"geom",
       {{"name",     "class",  "type",     "contype",   "conaffinity", "condim",     "group",
         "priority", "size",   "material", "friction",  "mass",        "density",    "shellinertia",
         "solmix",   "solref", "solimp",   "margin",    "gap",         "surfacevel", "adhesion",
         "fromto",   "pos",    "quat",     "axisangle", "xyaxes",      "zaxis",      "euler",
         "hfield",   "mesh",   "fitscale", "rgba",      "fluidshape",  "fluidcoef",  "user"},
        {},
        {},
        true}}};
  return all;
}

/// Of other programs: "xacro:arg", "xmlns", "xmlns:drake".
bool is_foreign(std::string_view name) { return name == "xmlns" || name.find(':') != std::string_view::npos; }

class UnreadFinder {
 public:
  explicit UnreadFinder(const KnownElements& elements) : elements_(elements) {}

  void look_at(const Element& element) {
    const KnownElement& known = elements_.at(element.name);
    for (const auto& [key, value] : element.attributes)
      if (!known.attributes.contains(key) && !is_foreign(key))
        note(fmt::format("the attribute {} of <{}> is left out", key, element.name), element);
    NameSet seen;
    for (const Element& child : element.children) {
      if (is_foreign(child.name)) continue;
      const bool once = known.once.contains(child.name);
      if (once && !seen.insert(child.name).second) {
        note(fmt::format("a second <{}> in one <{}> is left out", child.name, element.name), child);
      } else if (!once && !known.others_too && !known.any.contains(child.name)) {
        note(fmt::format("<{}> in <{}> is left out", child.name, element.name), child);
      } else if (elements_.contains(child.name)) {
        look_at(child);
      }
    }
  }

  [[nodiscard]] std::vector<std::string> remarks() const {
    std::vector<std::string> all;
    for (const Kind& kind : kinds_)
      all.push_back(kind.what + (kind.count == 1 ? fmt::format(", on line {}", kind.line)
                                                 : fmt::format(", {} times, first on line {}", kind.count, kind.line)));
    return all;
  }

 private:
  struct Kind {
    std::string what;
    int line = 0, count = 0;
  };

  void note(const std::string& what, const Element& where) {
    auto found = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& kind) { return kind.what == what; });
    if (found == kinds_.end()) found = kinds_.insert(kinds_.end(), {what, where.place.line, 0});
    ++found->count;
  }

  const KnownElements& elements_;
  std::vector<Kind> kinds_;
};

}  // namespace

std::vector<std::string> unread_of_urdf(const Element& robot) {
  UnreadFinder finder(urdf_elements());
  finder.look_at(robot);
  return finder.remarks();
}

std::vector<std::string> unread_of_mjcf(const Element& mujoco) {
  UnreadFinder finder(mjcf_elements());
  finder.look_at(mujoco);
  return finder.remarks();
}

}  // namespace withy::exchange
