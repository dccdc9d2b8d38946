#include "urdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "attributes.hpp"
#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// <origin xyz rpy>; identity where there is none.
Pose origin_of(const Element& parent, Diagnostics& diagnostics) {
  const Element* origin = parent.child("origin");
  if (origin == nullptr) return {};
  const Attributes a(*origin, diagnostics);
  const Vector3 rpy = a.vector("rpy", Vector3::Zero());
  const Matrix3 R = (Eigen::AngleAxisd(rpy[2], Vector3::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3::UnitY()) *
                     Eigen::AngleAxisd(rpy[0], Vector3::UnitX()))
                        .toRotationMatrix();
  return {R, a.vector("xyz", Vector3::Zero())};
}

Link urdf_link(const Element& element, const InertiaRule& rule) {
  Diagnostics& diagnostics = rule.diagnostics;
  Link link{Attributes(element, diagnostics).required("name"), element.place, 0, Vector3::Zero(), Matrix3::Zero()};
  const Element* inertial = element.child("inertial");
  if (inertial == nullptr) return link;
  const Pose at = origin_of(*inertial, diagnostics);
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
  rule.settle(link.name, inertial->place, link.mass, link.inertia);
  return link;
}

const std::map<std::string, std::string, std::less<>> joint_types = {
    {"revolute", "revolute"}, {"continuous", "revolute"}, {"prismatic", "prismatic"},
    {"fixed", "weld"},        {"floating", "free"},       {"planar", "planar"}};

/// Axis, damper, and in words what a scene does not take over.
void describe_joint(const Element& element, Joint& joint, Tree& tree, Diagnostics& diagnostics) {
  const Element *axis = element.child("axis"), *dynamics = element.child("dynamics"), *limit = element.child("limit");
  if (axis != nullptr && joint.type != "weld" && joint.type != "free")
    joint.axis = Attributes(*axis, diagnostics).direction("xyz", Vector3::UnitX());
  if (limit != nullptr && *element.find("type") != "continuous") {
    const Attributes a(*limit, diagnostics);
    if (limit->find("lower") != nullptr || limit->find("upper") != nullptr)
      joint.remark = fmt::format("its range {} to {} is not enforced: see hinge-limit", a.number("lower", 0),
                                 a.number("upper", 0));
    const bool angular = joint.type != "prismatic";
    for (const auto& [key, unit] :
         {std::pair("effort", angular ? "N m" : "N"), std::pair("velocity", angular ? "rad/s" : "m/s")})
      if (const double most = a.number(key, 0); most != 0)
        joint.remark +=
            fmt::format("{}{} of {} {} at most is not enforced", joint.remark.empty() ? "" : "; ", key, most, unit);
  }
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
                 Diagnostics& diagnostics) {
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
  joint.offset = origin_of(element, diagnostics);
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
  std::map<std::string, int> links;
  for (const Element& e : robot.children) {
    if (e.name.starts_with("xacro:")) {
      diagnostics.error(e.place, "a macro; expand the file with xacro first");
    } else if (e.name == "link") {
      tree.links.push_back(urdf_link(e, {mend_inertias, diagnostics, tree.remarks}));
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
      tree.joints.push_back(urdf_joint(*holding[i], child, links, tree, diagnostics));
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
  if (diagnostics.ok() && is_world(tree, root, free_base)) take_world_out(tree, root);
  check_tree(tree, diagnostics);
  return tree;
}

}  // namespace withy::exchange
