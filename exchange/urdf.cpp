#include "urdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "attributes.hpp"
#include "unread.hpp"
#include "withy/core/spatial/direction.hpp"
#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// What the reading of parts of a robot has in common.
struct UrdfReading {
  InertiaRule rule;
  int minor = 0;  ///< of the version 1.x that the file says it has

  [[nodiscard]] Diagnostics& diagnostics() const { return rule.diagnostics; }
  void remark(std::string text) const { rule.remarks.push_back(std::move(text)); }
};

/// The x of version 1.x. Versions 1.0 to 1.2 are known; other ones may give what is read here another meaning.
int minor_version(const Element& robot, Diagnostics& diagnostics) {
  const std::string* text = robot.find("version");
  if (text == nullptr) return 0;
  for (int minor = 0; minor <= 2; ++minor)
    if (*text == fmt::format("1.{}", minor)) return minor;
  Attributes(robot, diagnostics).error("version", fmt::format("got {}; need 1.0, 1.1 or 1.2", in_quotes(*text)));
  return 0;
}

Matrix3 by_angles(const Vector3& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Vector3::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3::UnitX()))
      .toRotationMatrix();
}

/// By `quat_xyzw`, which version 1.1 has in the place of `rpy`, and earlier ones take no notice of.
Matrix3 rotation_of(const Element& origin, const UrdfReading& reading) {
  const Attributes a(origin, reading.diagnostics());
  const bool has_quaternion = origin.find("quat_xyzw") != nullptr;
  if (has_quaternion && reading.minor < 1)
    reading.remark(
        fmt::format("quat_xyzw on line {} is left out: URDF has it from version 1.1 on, and the file's "
                    "version is 1.0",
                    origin.place.line));
  if (!has_quaternion || reading.minor < 1) return by_angles(a.vector("rpy", Vector3::Zero()));
  if (origin.find("rpy") != nullptr) a.error("quat_xyzw", "the element has rpy too; need one of them");
  const auto q = a.numbers("quat_xyzw", 4, 4);
  if (!q) return Matrix3::Identity();
  const auto unit = unit_along(Eigen::Vector4d((*q)[3], (*q)[0], (*q)[1], (*q)[2]));
  if (unit) return rotation_from_quaternion((*unit)[0], (*unit)[1], (*unit)[2], (*unit)[3]);
  a.error("quat_xyzw", "got 0 0 0 0; need a quaternion");
  return Matrix3::Identity();
}

/// <origin> of an element; identity where there is none.
Pose origin_of(const Element& parent, const UrdfReading& reading) {
  const Element* origin = parent.child("origin");
  if (origin == nullptr) return {};
  return {rotation_of(*origin, reading), Attributes(*origin, reading.diagnostics()).vector("xyz", Vector3::Zero())};
}

Link urdf_link(const Element& element, const UrdfReading& reading) {
  Diagnostics& diagnostics = reading.diagnostics();
  Link link{Attributes(element, diagnostics).required("name"), element.place, 0, Vector3::Zero(), Matrix3::Zero()};
  const Element* inertial = element.child("inertial");
  if (inertial == nullptr) return link;
  const Pose at = origin_of(*inertial, reading);
  link.center = at.p;
  const Element *mass = inertial->child("mass"), *inertia = inertial->child("inertia");
  if (mass == nullptr || inertia == nullptr || mass->find("value") == nullptr) {
    diagnostics.error(inertial->place, "need <mass value=…/> and <inertia ixx=… …/>");
    return link;
  }
  link.mass = Attributes(*mass, diagnostics).number("value", 0);
  const Attributes a(*inertia, diagnostics);
  for (const char* key : {"ixx", "iyy", "izz"}) static_cast<void>(a.required(key));
  const auto n = [&](const char* key) { return a.number(key, 0); };
  link.inertia = turned(at.R, inertia_matrix(n("ixx"), n("iyy"), n("izz"), n("ixy"), n("ixz"), n("iyz")));
  reading.rule.settle(link.name, inertial->place, link.mass, link.inertia);
  return link;
}

const std::map<std::string, std::string, std::less<>> joint_types = {
    {"revolute", "revolute"}, {"continuous", "revolute"}, {"prismatic", "prismatic"},
    {"fixed", "weld"},        {"floating", "free"},       {"planar", "planar"}};

void add_to(std::string& remark, const std::string& more) { remark += (remark.empty() ? "" : "; ") + more; }

/// The bounds of a joint's motion and drive, in words.
std::string limits_in_words(const Element& limit, const std::string& type, Diagnostics& diagnostics) {
  std::string words;
  const Attributes a(limit, diagnostics);
  if (type != "continuous" && (limit.find("lower") != nullptr || limit.find("upper") != nullptr))
    words =
        fmt::format("its range {} to {} is not enforced: see hinge-limit", a.number("lower", 0), a.number("upper", 0));
  struct Bound {
    const char *key, *angular, *straight;
  };
  for (const Bound& bound : {Bound{"effort", " N m", " N"},
                             {"velocity", " rad/s", " m/s"},
                             {"acceleration", " rad/s^2", " m/s^2"},
                             {"deceleration", " rad/s^2", " m/s^2"},
                             {"jerk", " rad/s^3", " m/s^3"}}) {
    const std::string* text = limit.find(bound.key);
    if (text == nullptr || *text == "inf") continue;
    const double most = a.number(bound.key, 0);
    if (most == 0) continue;
    const bool several = type == "planar" || type == "floating";
    const char* unit = several ? "" : type == "prismatic" ? bound.straight : bound.angular;
    add_to(words, fmt::format("{} of {}{} at most is not enforced", bound.key, most, unit));
  }
  return words;
}

/// Axis, damper, and in words what a scene does not take over.
void describe_joint(const Element& element, Joint& joint, Tree& tree, Diagnostics& diagnostics) {
  const Element *axis = element.child("axis"), *dynamics = element.child("dynamics"), *limit = element.child("limit");
  if (axis != nullptr && joint.type != "weld" && joint.type != "free")
    joint.axis = Attributes(*axis, diagnostics).direction("xyz", Vector3::UnitX());
  if (limit != nullptr && joint.type != "weld")
    joint.remark = limits_in_words(*limit, *element.find("type"), diagnostics);
  if (element.child("safety_controller") != nullptr && joint.type != "weld")
    add_to(joint.remark, "its safety_controller is left out");
  if (dynamics != nullptr) {
    const Attributes a(*dynamics, diagnostics);
    const double damping = joint.type == "weld" ? 0 : a.number("damping", 0);
    if (joint.type == "revolute" || joint.type == "prismatic") {
      joint.damping = damping;
    } else if (damping != 0) {
      tree.remarks.push_back(
          fmt::format("joint {}: damping {} is left out, hinge-spring damps a hinge of one motion alone",
                      in_quotes(joint.name), damping));
    }
    if (const double friction = a.number("friction", 0); friction != 0)
      tree.remarks.push_back(
          fmt::format("joint {}: friction {} is left out; add a load hinge-friction, which needs a scale of the rate",
                      in_quotes(joint.name), friction));
    if (damping < 0) Attributes(*dynamics, diagnostics).error("damping", "got a negative damping; need at least 0");
  }
  if (element.child("mimic") != nullptr)
    tree.remarks.push_back(fmt::format("joint {}: <mimic> is left out, the joint is free", in_quotes(joint.name)));
}

/// The index of the link that <parent link=…/> or <child link=…/> names; −1 after reporting that there is none.
int link_named(const Element& joint, const char* which, const std::map<std::string, int>& links,
               Diagnostics& diagnostics) {
  const Element* element = joint.child(which);
  if (element == nullptr) {
    diagnostics.error(joint.place, fmt::format("missing: <{} link=…/>", which));
    return -1;
  }
  const Attributes a(*element, diagnostics);
  const std::string name = a.required("link");
  const auto found = links.find(name);
  if (found != links.end()) return found->second;
  if (!name.empty()) {
    std::vector<std::string> all;
    for (const auto& [known, index] : links) all.push_back(known);
    const std::string guess = nearest(name, all);
    a.error("link", fmt::format("there is no link {}{}", in_quotes(name),
                                guess.empty() ? "" : "; did you mean '" + guess + "'?"));
  }
  return -1;
}

/// Joints by the link that they hold; reports links that two hold.
std::vector<const Element*> holders(const Element& robot, const std::map<std::string, int>& links,
                                    Diagnostics& diagnostics) {
  std::vector<const Element*> holding(links.size(), nullptr);
  for (const Element& e : robot.children) {
    if (e.name != "joint") continue;
    const int child = link_named(e, "child", links, diagnostics);
    if (child < 0) continue;
    const Element*& holder = holding[static_cast<std::size_t>(child)];
    if (holder != nullptr)
      diagnostics.error(e.place, fmt::format("the link {} is the child of the joint on line {} too; need a tree",
                                             in_quotes(*e.child("child")->find("link")), holder->place.line));
    holder = &e;
  }
  return holding;
}

Joint urdf_joint(const Element& element, int child, const std::map<std::string, int>& links, Tree& tree,
                 const UrdfReading& reading) {
  Diagnostics& diagnostics = reading.diagnostics();
  const Attributes a(element, diagnostics);
  Joint joint;
  joint.name = a.required("name");
  joint.place = element.place;
  joint.child = child;
  joint.parent = link_named(element, "parent", links, diagnostics);
  const std::string type = a.required("type");
  const auto known = joint_types.find(type);
  if (known != joint_types.end()) {
    joint.type = known->second;
  } else if (!type.empty()) {
    a.error("type", fmt::format("got {}; need one of: revolute, continuous, prismatic, fixed, floating, planar",
                                in_quotes(type)));
  }
  joint.offset = origin_of(element, reading);
  if (known != joint_types.end()) describe_joint(element, joint, tree, diagnostics);
  return joint;
}

/// Whether the root is the world and no link of its own. It is one where it is to float, unless all on it floats.
bool is_world(const Tree& tree, int root, bool free_base) {
  const Link& base = tree.links[static_cast<std::size_t>(root)];
  if (base.name != "world" || base.mass != 0 || tree.links.size() == 1) return false;
  return !free_base || std::all_of(tree.joints.begin(), tree.joints.end(),
                                   [&](const Joint& j) { return j.parent != root || j.type == "free"; });
}

/// Takes the link "world" out: its joints hang on the world then.
void take_world_out(Tree& tree, int root) {
  tree.links.erase(tree.links.begin() + root);
  tree.joints.erase(tree.joints.begin() + root);
  for (Joint& joint : tree.joints) {
    if (joint.parent == root) joint.parent = -1;
    if (joint.parent > root) --joint.parent;
    if (joint.child > root) --joint.child;
  }
}

/// The one link that no joint holds; −1 after reporting that there is none, or several.
int root_of(const Tree& tree, const std::vector<const Element*>& holding, const Element& robot,
            Diagnostics& diagnostics) {
  std::vector<std::string> roots;
  int root = -1;
  for (std::size_t i = 0; i < holding.size(); ++i) {
    if (holding[i] != nullptr) continue;
    root = static_cast<int>(i);
    roots.push_back(tree.links[i].name);
  }
  if (roots.size() == 1) return root;
  diagnostics.error(
      robot.place, roots.empty() ? "every link is the child of a joint: the joints make a circle; need a tree"
                                 : "several links have no joint that holds them: " + listed(roots) + "; need one root");
  return -1;
}

/// Reports links that do not hang on the root: their joints make a circle.
void check_circles(const Tree& tree, Diagnostics& diagnostics) {
  for (const Joint& joint : tree.joints) {
    int above = joint.parent;
    for (std::size_t steps = 0; above >= 0 && steps <= tree.links.size(); ++steps)
      above = tree.joints[static_cast<std::size_t>(above)].parent;
    if (above >= 0) diagnostics.error(joint.place, "the joints above this one make a circle; need a tree");
  }
}

}  // namespace

Tree read_urdf(const Element& robot, bool free_base, bool mend_inertias, Diagnostics& diagnostics) {
  Tree tree;
  if (const std::string* name = robot.find("name")) tree.name = *name;
  tree.gravity_remark = "URDF has none: that of the Earth along -z";
  const UrdfReading reading{{mend_inertias, diagnostics, tree.remarks}, minor_version(robot, diagnostics)};
  std::map<std::string, int> links;
  for (const Element& e : robot.children) {
    if (e.name.starts_with("xacro:")) {
      diagnostics.error(e.place, "a macro; expand the file with xacro first");
    } else if (e.name == "link") {
      tree.links.push_back(urdf_link(e, reading));
      if (!links.emplace(tree.links.back().name, static_cast<int>(tree.links.size()) - 1).second)
        diagnostics.error(e.place, "a second link of the name " + in_quotes(tree.links.back().name));
    }
  }
  if (tree.links.empty()) diagnostics.error(robot.place, "no <link>");
  if (!diagnostics.ok()) return tree;
  const auto holding = holders(robot, links, diagnostics);
  const int root = root_of(tree, holding, robot, diagnostics);
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const int child = static_cast<int>(i);
    if (holding[i] != nullptr) {
      tree.joints.push_back(urdf_joint(*holding[i], child, links, tree, reading));
    } else {
      Joint base;
      base.name = "base_of_" + tree.links[i].name;
      base.place = tree.links[i].place;
      base.type = free_base ? "free" : "weld";
      base.child = child;
      tree.joints.push_back(base);
    }
  }
  if (!diagnostics.ok()) return tree;
  check_circles(tree, diagnostics);
  for (std::string& remark : unread_of_urdf(robot)) tree.remarks.push_back(std::move(remark));
  if (!diagnostics.ok()) return tree;
  if (is_world(tree, root, free_base)) take_world_out(tree, root);
  check_tree(tree, diagnostics);
  return tree;
}

}  // namespace withy::exchange
