#include "mjcf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "attributes.hpp"
#include "mjcf_geoms.hpp"
#include "mjcf_joints.hpp"
#include "unread.hpp"
#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

const std::set<std::string, std::less<>> without_mass_or_motion = {"geom",     "site",  "camera",    "light",
                                                                   "inertial", "joint", "freejoint", "body"};

class MjcfReader {
 public:
  MjcfReader(const Element& mujoco, bool mend_inertias, Diagnostics& diagnostics)
      : mujoco_(mujoco), mend_inertias_(mend_inertias), diagnostics_(diagnostics) {}

  Tree read() {
    if (const std::string* model = mujoco_.find("model")) tree_.name = *model;
    tree_.gravity_remark = "of <option>, or MuJoCo's default";
    for (const Element& e : mujoco_.children) {
      if (e.name == "compiler") compiler(e);
      if (e.name == "default") defaults_.add_global(e, tree_.remarks);
      if (e.name == "option") option(e);
    }
    refuse_includes(mujoco_);
    for (const char* left_out : {"actuator", "tendon", "equality", "contact", "deformable", "sensor", "keyframe"})
      for (const Element& e : mujoco_.children)
        if (e.name == left_out && !e.children.empty())
          tree_.remarks.push_back(
              fmt::format("<{}> with {} is left out", left_out, counted(e.children.size(), "element")));
    if (flags_.off("gravity")) {
      tree_.gravity.setZero();
      tree_.gravity_remark = "switched off by <flag> of <option>";
    }
    bool any = false;
    for (const Element& e : mujoco_.children) {
      if (e.name != "worldbody") continue;
      any = true;
      collect_names(e);
      children(e, -1, {});
    }
    if (!any) diagnostics_.error(mujoco_.place, "no <worldbody>");
    if (any && tree_.links.empty()) diagnostics_.error(mujoco_.place, "no <body> in <worldbody>");
    for (std::string& remark : unread_of_mjcf(mujoco_)) tree_.remarks.push_back(std::move(remark));
    if (diagnostics_.ok()) check_tree(tree_, diagnostics_);
    return std::move(tree_);
  }

 private:
  void refuse_includes(const Element& element) {
    for (const Element& e : element.children) {
      if (e.name == "include") diagnostics_.error(e.place, "<include> is not followed; put the files into one");
      refuse_includes(e);
    }
  }

  static std::string counted(std::size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  }

  void option(const Element& e) {
    const Attributes a(e, diagnostics_);
    tree_.gravity = a.vector("gravity", tree_.gravity);
    for (const char* key : {"density", "viscosity"})
      if (const double value = a.number(key, 0); value != 0)
        tree_.remarks.push_back(fmt::format("<option>: {} {} of a medium, and its forces, are left out", key, value));
    for (const Element& child : e.children)
      if (child.name == "flag") flags_.read(child, diagnostics_);
  }

  void compiler(const Element& e) {
    const Attributes a(e, diagnostics_);
    if (const std::string* angle = e.find("angle")) {
      if (*angle == "radian") angles_.unit = 1;
      if (*angle != "radian" && *angle != "degree")
        a.error("angle", fmt::format("got {}; need radian or degree", in_quotes(*angle)));
    }
    if (const std::string* sequence = e.find("eulerseq")) {
      angles_.euler = *sequence;
      if (sequence->size() != 3 || sequence->find_first_not_of("xyzXYZ") != std::string::npos) {
        a.error("eulerseq", fmt::format("got {}; need three letters of xyzXYZ", in_quotes(*sequence)));
        angles_.euler = "xyz";
      }
    }
    if (const std::string* from = e.find("inertiafromgeom")) {
      from_geoms_ = *from;
      if (*from != "auto" && *from != "true" && *from != "false")
        a.error("inertiafromgeom", fmt::format("got {}; need auto, true or false", in_quotes(*from)));
    }
    if (const std::string* where = e.find("coordinate"); where != nullptr && *where != "local")
      a.error("coordinate", "need local");
    for (const char* key : {"settotalmass", "inertiagrouprange", "boundmass", "boundinertia"})
      if (e.find(key) != nullptr) a.error(key, "changes masses in a way that is not read; take it out");
  }

  /// Names that the file gives, which those made up here must not take.
  void collect_names(const Element& element) {
    for (const Element& e : element.children) {
      const std::string* called = e.find("name");
      if (called != nullptr && e.name == "body") link_names_.insert(*called);
      if (called != nullptr && (e.name == "joint" || e.name == "freejoint")) joint_names_.insert(*called);
      collect_names(e);
    }
  }

  /// The name, with as many `_` behind it as make it one of its own.
  static std::string own(std::string name, std::set<std::string>& taken) {
    while (!taken.insert(name).second) name += '_';
    return name;
  }

  std::string body_name(const Element& e) {
    if (const std::string* called = e.find("name")) return *called;
    std::string by_line = fmt::format("body_{}", e.place.line);
    if (link_names_.insert(by_line).second) return by_line;
    return own(fmt::format("{}_at_{}", by_line, e.place.column), link_names_);
  }

  std::string joint_name(const Element& e, const std::string& otherwise) {
    const std::string* called = e.find("name");
    return called != nullptr ? *called : own(otherwise, joint_names_);
  }

  void children(const Element& element, int link, const std::string& around) {
    for (const Element& e : element.children) {
      if (e.name == "body") {
        body(e, link, around);
      } else if (e.name == "plugin") {
        tree_.remarks.push_back(fmt::format("<plugin> on line {}: its forces are left out", e.place.line));
      } else if (e.name != "include" && !without_mass_or_motion.contains(e.name)) {
        diagnostics_.error(e.place, fmt::format("<{}> is not read here; write its bodies out", e.name));
      }
    }
  }

  void body(const Element& e, int parent, const std::string& around_parent) {
    const std::string* childclass = e.find("childclass");
    const std::string around = childclass != nullptr ? *childclass : around_parent;
    const std::string name = body_name(e);
    check_orientation(e, diagnostics_);
    Pose at{angles_.rotation(e, diagnostics_), Attributes(e, diagnostics_).vector("pos", Vector3::Zero())};
    if (const std::string* mocap = e.find("mocap"); mocap != nullptr && *mocap == "true")
      tree_.remarks.push_back(fmt::format("body {}: mocap is left out, it stays where it is", in_quotes(name)));
    if (const double share = Attributes(e, diagnostics_).number("gravcomp", 0); share != 0 && !tree_.gravity.isZero(0))
      tree_.remarks.push_back(fmt::format("body {}: gravcomp {} is left out, its weight acts", in_quotes(name), share));
    std::vector<Element> joints;
    for (const Element& child : e.children)
      if (child.name == "joint" || child.name == "freejoint")
        joints.push_back(defaults_.completed(child, around, diagnostics_));
    const MassProperties mass = masses(e, name, around);
    for (std::size_t j = 0; j < std::max<std::size_t>(joints.size(), 1); ++j) {
      const bool last = j + 1 >= joints.size();
      Link link{last ? name : own(fmt::format("{}_{}", name, j + 1), link_names_), e.place, 0, Vector3::Zero(),
                Matrix3::Zero()};
      if (last) link.mass = mass.mass, link.center = mass.center, link.inertia = mass.inertia;
      Joint joint = joints.empty()
                        ? weld(e, name)
                        : moving(joints[j], name + "_joint" + (joints.size() > 1 ? fmt::format("_{}", j + 1) : ""));
      joint.parent = parent;
      joint.offset = at * Pose{Matrix3::Identity(), joint.point};
      parent = joint.child = static_cast<int>(tree_.links.size());
      at = {};  // the links between two joints have the frame of the body
      tree_.links.push_back(std::move(link));
      tree_.joints.push_back(std::move(joint));
    }
    children(e, parent, around);
  }

  Joint weld(const Element& e, const std::string& body_name) {
    Joint joint;
    joint.name = own("root_of_" + body_name, joint_names_);
    joint.place = e.place;
    return joint;
  }

  Joint moving(const Element& e, const std::string& otherwise) {
    return MjcfJoints{angles_, flags_, tree_.remarks, diagnostics_}.read(e, joint_name(e, otherwise));
  }

  /// Of <inertial>, else of geoms; or the other way around where <compiler> asks for it.
  MassProperties masses(const Element& e, const std::string& name, const std::string& around) {
    const Element* inertial = e.child("inertial");
    for (const Element& other : e.children)
      if (other.name == "inertial" && &other != inertial)
        diagnostics_.error(other.place, "a second <inertial> of one body; need one");
    MassProperties m;
    if (from_geoms_ == "true" || (from_geoms_ == "auto" && inertial == nullptr)) {
      for (const Element& geom : e.children)
        if (geom.name == "geom")
          if (const auto more = mass_of_geom(defaults_.completed(geom, around, diagnostics_), angles_, diagnostics_))
            m.add(*more);
    }
    return inertial != nullptr && m.mass == 0 ? of_inertial(*inertial, name) : m;
  }

  MassProperties of_inertial(const Element& inertial, const std::string& name) {
    check_orientation(inertial, diagnostics_);
    const Attributes a(inertial, diagnostics_);
    for (const char* key : {"mass", "pos"}) static_cast<void>(a.required(key));
    MassProperties m;
    m.mass = a.number("mass", 0);
    m.center = a.vector("pos", Vector3::Zero());
    if (const auto full = a.numbers("fullinertia", 6, 6)) {
      if (inertial.find("diaginertia") != nullptr || turns_itself(inertial))
        a.error("fullinertia",
                "has axes of its own, those of the body; need it without diaginertia and without an orientation");
      m.inertia = inertia_matrix((*full)[0], (*full)[1], (*full)[2], (*full)[3], (*full)[4], (*full)[5]);
    } else {
      m.inertia = a.vector("diaginertia", Vector3::Zero()).asDiagonal();
      if (inertial.find("diaginertia") == nullptr && m.mass > 0)
        tree_.remarks.push_back(
            fmt::format("body {}: its <inertial> has no inertia; its mass sits at a point", in_quotes(name)));
    }
    m.inertia = turned(angles_.rotation(inertial, diagnostics_), m.inertia);
    InertiaRule{mend_inertias_, diagnostics_, tree_.remarks}.settle(name, inertial.place, m.mass, m.inertia);
    return m;
  }

  const Element& mujoco_;
  bool mend_inertias_;
  Diagnostics& diagnostics_;
  Tree tree_;
  MjcfDefaults defaults_;
  MjcfAngles angles_;
  MjcfFlags flags_;
  std::set<std::string> link_names_, joint_names_;  ///< taken
  std::string from_geoms_ = "auto";
};

}  // namespace

Tree read_mjcf(const Element& mujoco, bool mend_inertias, Diagnostics& diagnostics) {
  return MjcfReader(mujoco, mend_inertias, diagnostics).read();
}

}  // namespace withy::exchange
