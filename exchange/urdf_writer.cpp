#include <fmt/format.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "urdf.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/model.hpp"

namespace withy::exchange {
namespace {

/// Angles about fixed x, y, z. The last is of what the first two leave, so that all three fit together at a pitch of
/// 90 degrees too.
Vector3 roll_pitch_yaw(const Matrix3& R) {
  const double roll = std::atan2(R(2, 1), R(2, 2)), s = std::sin(roll), c = std::cos(roll);
  return {roll, std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
          std::atan2(s * R(0, 2) - c * R(0, 1), c * R(1, 1) - s * R(1, 2))};
}

std::string three(const Vector3& v) { return fmt::format("{} {} {}", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0); }

std::string origin_text(const Pose& pose) {
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", three(pose.p), three(roll_pitch_yaw(pose.R)));
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

/// A frame of the undeformed body, in its axes.
Pose undeformed(const Frame& frame) { return Pose{Matrix3::Identity(), frame.section.X} * frame.pose; }

class UrdfWriter {
 public:
  explicit UrdfWriter(const Model& model) : model_(model) {
    for (const BodyNode& body : model.bodies()) links_.insert(body.name);
    for (const HingeNode& hinge : model.hinges()) joints_.insert(hinge.name);
    const EventBook book(model);
    if (!book.any()) return;
    for (const ActingEvent& event : book.plan().events)
      for (const EventAction& action : event.actions)
        if (action.releases) welds_.insert(action.index);
  }

  Urdf write(const std::string& name) {
    out_.text = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- Made by `withy export`. Metres, kilograms, radians. -->\n<robot name=\"{}\">\n"
        "  <link name=\"world\"/>\n",
        escaped(name));
    for (std::size_t i = 0; i < model_.hinges().size(); ++i) {
      link(model_.bodies()[i]);
      joints(model_.hinges()[i]);
    }
    out_.text += "</robot>\n";
    tell_what_acts();
    return std::move(out_);
  }

 private:
  void tell_what_acts() {
    const auto left_out = [&](std::size_t count, const char* what) {
      if (count > 0) out_.remarks.push_back(fmt::format("{} {} left out", count, what));
    };
    const EventBook book(model_);
    // Loops and the states of events stand among the loads of a model.
    const std::vector<const LoopClosure*> loops = loops_of(model_);
    left_out(model_.loads().size() - loops.size() - (book.any() ? 1 : 0), "of the scene's loads");
    left_out(model_.motions().size(), "of the scene's motions");
    for (const LoopClosure* loop : loops)
      out_.remarks.push_back(
          fmt::format("constraint '{}' is left out, and its loop is open: URDF has trees alone", loop->name()));
    if (book.any()) tell_events(book.plan());
    if (!model_.gravity().isZero(0)) out_.remarks.push_back("gravity is left out: URDF has none");
  }

  void tell_events(const EventPlan& plan) {
    for (const ActingEvent& event : plan.events)
      out_.remarks.push_back(fmt::format("event '{}' is left out: URDF has none", event.name));
    for (const std::size_t hinge : plan.configurations.at(static_cast<std::size_t>(plan.start)))
      if (!welds_.contains(hinge))
        out_.remarks.push_back(
            fmt::format("hinge '{}' is held at first; its joint is free to move", model_.hinges()[hinge].name));
  }

  /// The frame of a body's link, that of its hinge on the child's side, in the body's axes.
  [[nodiscard]] Pose link_frame(int body) const {
    const HingeNode& hinge = model_.hinges()[static_cast<std::size_t>(body)];
    return undeformed(
        model_.bodies()[static_cast<std::size_t>(body)].frames[static_cast<std::size_t>(hinge.child_frame)]);
  }

  void link(const BodyNode& body) {
    const ModalShape& shape = body.body->shape();
    const Pose to_link = link_frame(static_cast<int>(&body - model_.bodies().data())).inverse();
    double mass = 0;
    Vector3 first = Vector3::Zero();
    for (const Particle& p : shape.particles) mass += p.mass, first += p.mass * p.at.X;
    const Vector3 center = mass > 0 ? Vector3(first / mass) : Vector3(Vector3::Zero());
    Matrix3 I = Matrix3::Zero();
    for (const Particle& p : shape.particles) {
      const Vector3 r = p.at.X - center;
      I += p.mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
    }
    for (const Section& s : shape.sections) I += s.inertia;
    I = to_link.R * I * to_link.R.transpose();
    out_.text += fmt::format(
        "  <link name=\"{}\">\n    <inertial>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <mass value=\"{}\"/>\n"
        "      <inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/>\n    </inertial>\n  "
        "</link>\n",
        escaped(body.name), three(to_link.R * center + to_link.p), mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
        I(1, 2));
    if (shape.modes() > 0)
      out_.remarks.push_back(fmt::format("body '{}' is flexible; its link is rigid, as it is undeformed", body.name));
  }

  void joint(const std::string& name, const char* type, const std::string& parent, const std::string& child,
             const Pose& origin, const Vector3* axis) {
    out_.text +=
        fmt::format("  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n    {}\n",
                    escaped(name), type, escaped(parent), escaped(child), origin_text(origin));
    if (axis != nullptr) out_.text += fmt::format("    <axis xyz=\"{}\"/>\n", three(*axis));
    // Readers ask for a limit of a prismatic joint.
    if (std::string_view(type) == "prismatic")
      out_.text += "    <limit lower=\"-1e9\" upper=\"1e9\" effort=\"1e9\" velocity=\"1e9\"/>\n";
    out_.text += "  </joint>\n";
  }

  void joints(const HingeNode& hinge) {
    const std::string child = model_.bodies()[static_cast<std::size_t>(hinge.child)].name;
    std::string parent = "world";
    Pose origin = hinge.offset;
    if (hinge.parent >= 0) {
      const BodyNode& body = model_.bodies()[static_cast<std::size_t>(hinge.parent)];
      parent = body.name;
      origin = link_frame(hinge.parent).inverse() *
               undeformed(body.frames[static_cast<std::size_t>(hinge.parent_frame)]) * hinge.offset;
    }
    if (hinge.reflected_inertia > 0)
      out_.remarks.push_back(fmt::format("the reflected inertia of hinge '{}' is left out: URDF has none", hinge.name));
    const auto kernel = hinge.hinge->kernel();
    using Kind = HingeKernel::Kind;
    if (welds_.contains(static_cast<std::size_t>(hinge.child)) || (kernel && kernel->kind == Kind::weld))
      return joint(hinge.name, "fixed", parent, child, origin, nullptr);
    if (kernel && kernel->kind == Kind::revolute)
      return joint(hinge.name, "continuous", parent, child, origin, &kernel->axis);
    if (kernel && kernel->kind == Kind::prismatic)
      return joint(hinge.name, "prismatic", parent, child, origin, &kernel->axis);
    if (kernel && kernel->kind == Kind::free) return joint(hinge.name, "floating", parent, child, origin, nullptr);
    if (hinge.hinge->speeds() == 2) return two_joints(hinge, parent, child, origin);
    throw std::domain_error(fmt::format(
        "hinge '{}' has no joint in URDF, which knows fixed, revolute, prismatic and floating ones", hinge.name));
  }

  /// Universal and cylindrical: one motion after the other, with a link without mass between them.
  void two_joints(const HingeNode& hinge, const std::string& parent, const std::string& child, const Pose& origin) {
    std::vector<double> x(hinge.hinge->coordinates()), rates(hinge.hinge->speeds(), 0.0);
    hinge.hinge->reference(x);
    HingeMotion motion;
    hinge.hinge->motion(x, rates, motion);
    const std::string between = own(links_, hinge.name + "_between");
    out_.text += fmt::format("  <link name=\"{}\"/>\n", escaped(between));
    for (int k = 0; k < 2; ++k) {
      const Vector3 angular = motion.H.col(k).head<3>(), linear = motion.H.col(k).tail<3>();
      const bool turns = !angular.isZero(0);
      const Vector3 axis = turns ? angular : linear;
      joint(own(joints_, fmt::format("{}_{}", hinge.name, k)), turns ? "continuous" : "prismatic",
            k == 0 ? parent : between, k == 0 ? between : child, k == 0 ? origin : Pose{}, &axis);
    }
  }

  /// A name that no other has, which is taken by that.
  static std::string own(std::set<std::string>& taken, std::string name) {
    while (!taken.insert(name).second) name += '_';
    return name;
  }

  const Model& model_;
  Urdf out_;
  std::set<std::size_t> welds_;  ///< hinges of the scene that events let go of: the model's are free, and held
  std::set<std::string> links_ = {"world"}, joints_;  ///< names that are taken
};

}  // namespace

Urdf write_urdf(const Model& model, const std::string& name) { return UrdfWriter(model).write(name); }

}  // namespace withy::exchange
