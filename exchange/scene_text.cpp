#include "scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace withy::exchange {

std::string in_one_line(const Vector3& v) { return fmt::format("[{}, {}, {}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0); }

std::string quaternion_text(const Matrix3& R) {
  Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return fmt::format("[{}, {}, {}, {}]", q.w(), q.x() + 0.0, q.y() + 0.0, q.z() + 0.0);
}

namespace {

/// "{position: …, orientation: …}" without what is nothing; empty where both are.
std::string pose_members(const Pose& pose) {
  std::string text;
  if (!pose.p.isZero(0)) text = "position: " + in_one_line(pose.p);
  if (pose.R != Matrix3::Identity()) text += (text.empty() ? "" : ", ") + ("orientation: " + quaternion_text(pose.R));
  return text;
}

class SceneWriter {
 public:
  SceneWriter(const Tree& tree, const FlexibleLinks& flexible, const std::string& source)
      : tree_(tree), flexible_(flexible), source_(std::filesystem::path(source).filename().string()) {}

  std::string text() {
    out_ = fmt::format(
        "# Made by `withy import` from {}{}. Edit it as any scene.\n"
        "# Metres, kilograms, radians; a body has the frame of its link in that file{}.\n",
        source_, flexible_.file.empty() ? "" : " and " + std::filesystem::path(flexible_.file).filename().string(),
        flexible_.file.empty() ? "" : ", a flexible one has x along its beam");
    for (const std::string& remark : tree_.remarks) out_ += "# " + remark + "\n";
    out_ += fmt::format("format: withy/1\nname: {}\ngravity: {}{}\ntime: {{end: 10, output: 0.01}}\n\nbodies:\n",
                        in_one_line(Value(tree_.name.empty() ? source_ : tree_.name)), in_one_line(tree_.gravity),
                        tree_.gravity_remark.empty() ? "" : "   # " + tree_.gravity_remark);
    for (std::size_t i = 0; i < tree_.links.size(); ++i) {
      const auto beam = flexible_.of_link.find(static_cast<int>(i));
      if (beam == flexible_.of_link.end()) {
        rigid(static_cast<int>(i));
      } else {
        flexible(static_cast<int>(i), beam->second);
      }
    }
    out_ += "\nhinges:\n";
    for (const Joint& joint : tree_.joints) hinge(joint);
    springs();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const Joint& joint_of(int link) const {
    return *std::find_if(tree_.joints.begin(), tree_.joints.end(), [&](const Joint& j) { return j.child == link; });
  }

  void rigid(int index) {
    const Link& link = tree_.links[static_cast<std::size_t>(index)];
    const Matrix3& I = link.inertia;
    out_ +=
        fmt::format("  {}:   # {}:{}\n    type: rigid\n    mass: {}\n", link.name, source_, link.place.line, link.mass);
    if (!link.center.isZero(0)) out_ += "    center_of_mass: " + in_one_line(link.center) + "\n";
    if (!I.isZero(0))
      out_ +=
          fmt::format("    inertia: [{}, {}, {}, {}, {}, {}]\n", I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    if (const Joint& joint = joint_of(index); !joint.point.isZero(0))
      out_ += fmt::format("    frames: {{{}: {{position: {}}}}}\n", frame_name(joint), in_one_line(joint.point));
  }

  void flexible(int index, const FlexibleLink& flexible) {
    const Link& link = tree_.links[static_cast<std::size_t>(index)];
    out_ +=
        fmt::format("  {}:   # {}:{}, {} kg when rigid; a beam by {}:{}\n    type: beam\n    length: {}\n", link.name,
                    source_, link.place.line, link.mass, std::filesystem::path(flexible_.file).filename().string(),
                    flexible.parameters.place().line, flexible.length);
    for (const auto& [key, value] : flexible.parameters.members())
      out_ += "    " + key + ": " + in_one_line(value) + "\n";
    out_ += "    frames:\n";
    const Joint& own = joint_of(index);
    const Pose link_in_beam = flexible.beam.inverse();
    frame(frame_name(own), link_in_beam * Pose{Matrix3::Identity(), own.point}, 0);
    for (const Joint& joint : tree_.joints) {
      if (joint.parent != index) continue;
      Pose at = link_in_beam * joint.offset;
      double x = std::clamp(at.p.x(), 0.0, flexible.length);
      if (flexible.length - x <= 1e-9 * flexible.length) x = flexible.length;
      at.p.x() -= x;
      if (at.p.norm() <= 1e-15 * flexible.length) at.p.setZero();
      frame(frame_name(joint), at, x);
    }
  }

  void frame(const std::string& name, const Pose& pose, double x) {
    const std::string members = pose_members(pose);
    out_ += fmt::format("      {}: {{at: {}{}{}}}\n", name, x, members.empty() ? "" : ", ", members);
  }

  /// The frame where a joint attaches, on either side.
  static std::string frame_name(const Joint& joint) {
    static const std::set<std::string, std::less<>> stations = {"root", "tip", "left", "right"};
    return stations.contains(joint.name) ? "at_" + joint.name : joint.name;
  }

  void hinge(const Joint& joint) {
    std::string parent = "world", child = tree_.links[static_cast<std::size_t>(joint.child)].name, rest;
    const bool on_beam = flexible_.of_link.contains(joint.parent);
    if (joint.parent >= 0) parent = tree_.links[static_cast<std::size_t>(joint.parent)].name;
    if (on_beam) parent += '.' + frame_name(joint);
    if (flexible_.of_link.contains(joint.child) || !joint.point.isZero(0)) child += '.' + frame_name(joint);
    if (joint.type == "revolute" || joint.type == "prismatic") rest += ", axis: " + in_one_line(joint.axis);
    if (joint.type == "planar") rest += ", normal: " + in_one_line(joint.axis) + along(joint.axis);
    if (joint.has_reflected_inertia()) rest += fmt::format(", reflected_inertia: {}", joint.armature);
    const std::string members = on_beam ? "" : pose_members(joint.offset);
    if (!members.empty()) rest += ", offset: {" + members + "}";
    out_ += fmt::format("  {}: {{type: {}, parent: {}, child: {}{}}}   # {}:{}{}\n", joint.name, joint.type, parent,
                        child, rest, source_, joint.place.line, joint.remark.empty() ? "" : "; " + joint.remark);
  }

  /// Across a normal along x, where the hinge's own choice, x, would not do.
  static std::string along(const Vector3& normal) { return std::abs(normal.x()) > 0.9 ? ", along: [0, 1, 0]" : ""; }

  void springs() {
    std::string all;
    std::set<std::string> taken;
    for (const Joint& joint : tree_.joints) {
      if (joint.stiffness == 0 && joint.damping == 0) continue;
      // Names have 64 letters at most.
      std::string name = joint.name.substr(0, 57) + "_spring";
      for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_spring{}", joint.name.substr(0, 52), i);
      all += fmt::format("  {}: {{type: hinge-spring, hinge: {}, stiffness: {}, damping: {}", name, joint.name,
                         joint.stiffness, joint.damping);
      if (joint.free_position != 0) all += fmt::format(", free_position: {}", joint.free_position);
      all += "}\n";
    }
    if (!all.empty()) out_ += "\nloads:\n" + all;
  }

  const Tree& tree_;
  const FlexibleLinks& flexible_;
  std::string source_;
  std::string out_;
};

}  // namespace

std::string scene_text(const Tree& tree, const FlexibleLinks& flexible, const std::string& source) {
  return SceneWriter(tree, flexible, source).text();
}

}  // namespace withy::exchange
