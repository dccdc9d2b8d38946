#include "withy/scene/tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/state.hpp"
#include "withy/scene/topology.hpp"

namespace withy {
namespace {

constexpr double most_bytes = 4.0 * 1024 * 1024 * 1024;

/// What makes a body large.
struct Extent {
  double modes = 0;     ///< sum of the whole numbers named "modes"
  double greatest = 0;  ///< of them
  double rows = 0;      ///< of all tables
};

/// Of a value and what is below it.
void measure(const Value& value, Extent& extent) {
  if (value.kind() == Value::Kind::list && !value.items().empty() &&
      value.items().front().kind() == Value::Kind::list) {
    extent.rows += static_cast<double>(value.items().size());
  }
  for (const auto& [key, member] : value.members()) {
    if (key == "modes" && member.kind() == Value::Kind::number) {
      extent.modes += member.number();
      extent.greatest = std::max(extent.greatest, member.number());
    }
    measure(member, extent);
  }
}

Vector3 vector_of(const Value& list) {
  const std::vector<double> x = list.numbers();
  return {x[0], x[1], x[2]};
}

/// "body.frame", taken apart.
struct FrameName {
  std::string body;
  std::string frame;
};

FrameName split(const std::string& text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string::npos) return {text, "root"};
  return {text.substr(0, dot), text.substr(dot + 1)};
}

class TreeBuilder {
 public:
  explicit TreeBuilder(const Checker& checker) : checker_(checker) {}

  Tree build(const Value& bodies, const Value& hinges, const Vector3& gravity) {
    for (const auto& [name, value] : bodies.members()) add_body(name, value);
    for (const auto& [name, value] : hinges.members()) add_hinge(name, value);
    good_ = check_topology(tree_.names.bodies, links_, checker_) && good_;
    tree_.bodies = Value::map(std::move(body_values_), bodies.place());
    tree_.hinges = Value::map(std::move(hinge_values_), hinges.place());
    for (const BodyNode& node : nodes_) {
      tree_.names.frames.insert(node.name);
      for (const Frame& f : node.frames) tree_.names.frames.insert(node.name + "." + f.name);
    }
    tree_.names.frames_complete = good_;
    if (!good_) return std::move(tree_);
    try {
      tree_.model = std::make_unique<Model>(std::move(nodes_), std::move(hinge_nodes_), gravity);
    } catch (const std::invalid_argument& e) {
      error(hinges, e.what());
    }
    return std::move(tree_);
  }

 private:
  void error(const Value& value, std::string message) {
    checker_.diagnostics().error(value.place(), std::move(message));
    good_ = false;
  }

  void key_error(const std::string& path, std::string message) {
    checker_.key_error(path, std::move(message));
    good_ = false;
  }

  bool check_name(const std::string& name, const Value& value) {
    const std::string problem = name_problem(name);
    if (!problem.empty()) key_error(value.place().path, fmt::format("got name {}; {}", in_quotes(name), problem));
    return problem.empty();
  }

  void add_body(const std::string& name, const Value& given) {
    check_name(name, given);
    index_.emplace(name, static_cast<int>(nodes_.size()));
    tree_.names.bodies.push_back(name);
    BodyNode& node = nodes_.emplace_back();
    node.name = name;
    Made<Body> made;
    const auto value = check_plugin_map(given, "type", grammar::body_members(), checker_, made);
    if (const Value* formulation = made.value.find("formulation")) node.terms = terms_of(*formulation);
    if (!value) {
      good_ = false;
      return;
    }
    const double before = bytes_;
    bytes_ += predicted_bytes(*value);
    if (bytes_ > most_bytes) {
      if (before <= most_bytes) {
        key_error(value->place().path, fmt::format("its modes bring the model to about {:.1f} GiB of memory; need at "
                                                   "most {:.0f}: use fewer modes",
                                                   bytes_ / (most_bytes / 4), most_bytes / (most_bytes / 4)));
      }
      good_ = false;
      return;
    }
    made.object = make_object(*made.plugin, *value, checker_);
    if (made.object == nullptr) {
      good_ = false;
      return;
    }
    node.body = std::move(made.object);
    if (const std::string fault = find_fault(node.body->shape()); !fault.empty()) {
      key_error(value->place().path,
                fmt::format("body plugin '{}' made a shape that cannot be: {}", made.plugin->id, fault));
      node.body = nullptr;
      return;
    }
    add_frames(node, value->at("frames"));
    body_values_.emplace_back(name, *value);
  }

  /// What a body's own formulation keeps; it has no options there.
  std::optional<Terms> terms_of(const Value& id) {
    Made<Formulation> made;
    const Value choice = Value::map({{"name", id}}, id.place());
    const auto value = check_plugin_map(choice, "name", {text("name", "")}, checker_, made);
    const auto formulation = value ? make_object(*made.plugin, *value, checker_) : nullptr;
    if (formulation != nullptr) return formulation->terms();
    good_ = false;
    return {};
  }

  void add_frames(BodyNode& node, const Value& frames) {
    // The ends of a body are frames whether a hinge uses them or not: results speak of them.
    for (const char* station : {"root", "tip"}) {
      if (auto section = node.body->station(std::string(station))) node.frames.push_back({station, *section, {}});
    }
    if (node.frames.empty() || node.frames[0].name != "root") {
      key_error(frames.place().path, fmt::format("body '{}' has no station 'root'", node.name));
      node.body = nullptr;
      return;
    }
    for (const auto& [name, frame] : frames.members()) {
      if (node.body->station(name)) {
        key_error(frame.place().path, fmt::format("'{}' is a station of the body already; choose another name", name));
        continue;
      }
      const Value& at = frame.at("at");
      const auto section =
          at.kind() == Value::Kind::number ? node.body->station(at.number()) : node.body->station(at.text());
      if (!section) {
        error(at, fmt::format("no station {}; need {}", shown(at), node.body->stations()));
        continue;
      }
      node.frames.push_back({name, *section, pose_of(frame)});
    }
  }

  /// After reporting a bad orientation the pose is meaningless.
  Pose pose_of(const Value& value) {
    std::vector<double> q = value.at("orientation").numbers();
    if (!accept_quaternion(q, value.at("orientation").place(), checker_.diagnostics())) good_ = false;
    return {rotation_from_quaternion(q[0], q[1], q[2], q[3]), vector_of(value.at("position"))};
  }

  /// Index of the body a hinge's end names; −2 after reporting.
  int find_body(const Value& end, const FrameName& at) {
    const auto it = index_.find(at.body);
    if (it != index_.end()) return it->second;
    error(end, fmt::format("no body {}{}", in_quotes(at.body), suggestion(at.body, tree_.names.bodies)));
    return -2;
  }

  /// Index of a frame of a body; a station it has becomes a frame when it is asked for.
  int find_frame(const Value& end, int body, const std::string& name) {
    if (body < 0) return 0;
    BodyNode& node = nodes_[static_cast<std::size_t>(body)];
    if (node.body == nullptr) return 0;  // reported already
    if (const int index = node.frame(name); index >= 0) return index;
    if (const auto section = node.body->station(name)) {
      node.frames.push_back({name, *section, {}});
      return static_cast<int>(node.frames.size()) - 1;
    }
    std::vector<std::string> known;
    for (const Frame& f : node.frames) known.push_back(f.name);
    error(end, fmt::format("body '{}' has no frame {}{}", node.name, in_quotes(name), suggestion(name, known)));
    return 0;
  }

  void add_hinge(const std::string& name, const Value& given) {
    check_name(name, given);
    tree_.names.hinges.push_back(name);
    Link& link = links_.emplace_back();
    link.name = name;
    Made<Hinge> made;
    const auto value = check_plugin_map(given, "type", grammar::hinge_members(), checker_, made);
    HingeNode node;
    node.name = name;
    // The ends are looked up whatever else is wrong.
    const Value& ends = made.plugin != nullptr ? made.value : given;
    const Value* parent = ends.find("parent");
    const Value* child = ends.find("child");
    if (parent != nullptr && parent->kind() == Value::Kind::text) {
      const FrameName at = split(parent->text());
      if (at.body != "world") {
        link.parent = find_body(*parent, at);
        node.parent_frame = find_frame(*parent, link.parent, at.frame);
      } else if (at.frame == "root") {
        link.parent = -1;
      } else {
        error(*parent, "the world has no frames; place the hinge with its offset");
      }
    }
    if (child != nullptr && child->kind() == Value::Kind::text) {
      link.child_place = child->place();
      const FrameName at = split(child->text());
      if (at.body == "world") {
        error(*child, "the world cannot be a child");
      } else {
        link.child = find_body(*child, at);
        node.child_frame = find_frame(*child, link.child, at.frame);
      }
    }
    node.parent = link.parent;
    node.child = link.child;
    if (!value) {
      good_ = false;
      return;
    }
    node.offset = pose_of(value->at("offset"));
    node.hinge = make_object(*made.plugin, *value, checker_);
    if (node.hinge == nullptr) good_ = false;
    hinge_nodes_.push_back(std::move(node));
    hinge_values_.emplace_back(name, *value);
  }

  const Checker& checker_;
  Tree tree_;
  std::vector<BodyNode> nodes_;
  std::vector<HingeNode> hinge_nodes_;
  std::vector<Link> links_;
  std::unordered_map<std::string, int> index_;
  std::vector<Value::Member> body_values_;
  std::vector<Value::Member> hinge_values_;
  double bytes_ = 0;
  bool good_ = true;
};

}  // namespace

double predicted_bytes(const Value& body) {
  Extent extent;
  measure(body, extent);
  const double n = extent.modes;
  // Shape functions up to number m need about 25 m points of quadrature (20 for each 2.5 rad of phase), and 20 between
  // the rows of a table; a point keeps Φ, Ψ and Γ, Θ; a body four times that: particles, sections, and running
  // integrals.
  const double points = 25 * extent.greatest + 20 * (1 + extent.rows);
  return 4 * points * 6 * n * (n + 1) * static_cast<double>(sizeof(double));
}

Tree build_tree(const Value& bodies, const Value& hinges, const Vector3& gravity, const Checker& checker) {
  return TreeBuilder(checker).build(bodies, hinges, gravity);
}

}  // namespace withy
