#include "withy/scene/tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/topology.hpp"
#include "withy/scene/tree_bodies.hpp"

namespace withy {
namespace {

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

  SceneTree build(const Value& bodies, const Value& hinges, const Value& scene, const Vector3& gravity) {
    for (const auto& [name, value] : bodies.members()) bodies_.add(name, value);
    const bool bodies_are_made = problems_.good;  // what is wrong with hinges takes no frame away
    for (const auto& [name, value] : hinges.members()) add_hinge(name, value);
    for (const TreeBodies::Entry& entry : bodies_.entries()) weld_segments(entry);
    problems_.good = check_topology(tree_.names.bodies.names(), links_, checker_) && problems_.good;
    tree_.bodies = Value::map(std::move(bodies_.values()), bodies.place());
    tree_.hinges = Value::map(std::move(hinge_values_), hinges.place());
    for (const auto& [key, value] : scene.members())
      if (key != "bodies" && key != "hinges") bodies_.add_named_stations(value);
    bodies_.name_frames();
    tree_.names.frames_complete = bodies_are_made;
    if (!problems_.good) return std::move(tree_);
    try {
      tree_.model = std::make_unique<Model>(std::move(bodies_.nodes()), std::move(hinge_nodes_), gravity);
      bodies_.check_mode_names(*tree_.model);
    } catch (const std::invalid_argument& e) {
      problems_.error(hinges, e.what());
    }
    return std::move(tree_);
  }

 private:
  /// Welds the segments of a body to each other, outwards from the one that the body's hinge holds.
  void weld_segments(const TreeBodies::Entry& entry) {
    if (entry.count == 1 || entry.held < 0 || !problems_.good) return;
    const auto* plugin = checker_.registry().find<Hinge>("weld");
    if (plugin == nullptr) {
      problems_.key_error(entry.place.path + "/segments", "no hinge plugin 'weld' to join the segments with");
      return;
    }
    const std::vector<BodyNode>& nodes = bodies_.nodes();
    for (int i = entry.first; i < entry.first + entry.count; ++i) {
      if (i == entry.held) continue;
      const bool outwards = i > entry.held;
      HingeNode& hinge = hinge_nodes_.emplace_back();
      hinge.parent = outwards ? i - 1 : i + 1;
      hinge.child = i;
      hinge.name = nodes[static_cast<std::size_t>(i)].name + ".weld";
      hinge.parent_frame = nodes[static_cast<std::size_t>(hinge.parent)].frame(outwards ? "tip" : "root");
      hinge.child_frame = nodes[static_cast<std::size_t>(i)].frame(outwards ? "root" : "tip");
      hinge.hinge = hinges_.of(*plugin, Value::map({}, entry.place), checker_);
      if (hinge.hinge == nullptr) problems_.good = false;
    }
  }

  void take_reflected_inertia(const Value& given, const Value& value, HingeNode& node) {
    const Value* reflected = value.find("reflected_inertia");
    if (reflected == nullptr || node.hinge == nullptr) return;
    node.reflected_inertia = reflected->number();
    if (node.hinge->speeds() != 1 || node.hinge->coordinates() != 1) {
      problems_.error(*reflected, fmt::format("only hinges of one rate have a reflected inertia, and this one has {}",
                                              node.hinge->speeds()));
      return;
    }
    const std::vector<ParameterSpec>& members = grammar::hinge_members();
    const auto spec = std::find_if(members.begin(), members.end(),
                                   [](const ParameterSpec& s) { return s.key == "reflected_inertia"; });
    if (!checker_.has_unit(given.at("reflected_inertia"), *spec, !hinge_rates(*node.hinge)[0].angular))
      problems_.good = false;
  }

  void find_parent(const Value& ends, Link& link, HingeNode& node) {
    const Value* parent = ends.find("parent");
    if (parent == nullptr || parent->kind() != Value::Kind::text) return;
    const FrameName at = split(parent->text());
    if (at.body != "world") {
      link.parent = bodies_.find(*parent, at.body);
      const TreeBodies::NodeFrame found = bodies_.frame(*parent, link.parent, at.frame);
      node.parent = found.node;
      node.parent_frame = found.frame;
    } else if (at.frame == "root") {
      link.parent = -1;
    } else {
      problems_.error(*parent, "the world has no frames; place the hinge with its offset");
    }
  }

  void find_child(const Value& ends, Link& link, HingeNode& node) {
    const Value* child = ends.find("child");
    if (child == nullptr || child->kind() != Value::Kind::text) return;
    link.child_place = child->place();
    const FrameName at = split(child->text());
    if (at.body == "world") {
      problems_.error(*child, "the world cannot be a child");
      return;
    }
    link.child = bodies_.find(*child, at.body);
    const TreeBodies::NodeFrame found = bodies_.frame(*child, link.child, at.frame);
    node.child = found.node;
    node.child_frame = found.frame;
    if (link.child >= 0) bodies_.hold(link.child, found.node);
  }

  void name_rates(const std::string& name, const Value& given, const Hinge& hinge) {
    const std::vector<HingeRate> rates = hinge_rates(hinge);
    if (!rates.empty() && is_column_of_all(name))
      problems_.key_error(given.place().path,
                          fmt::format("got name {}, which is that of a column that every table of results has; "
                                      "hinges need their own",
                                      in_quotes(name)));
    for (std::size_t i = 0; i < rates.size(); ++i)
      if (!rates[i].angular) tree_.names.sliding.add(fmt::format("{}.{}", name, i));
  }

  void add_hinge(const std::string& name, const Value& given) {
    problems_.check_name(name, given);
    tree_.names.hinges.add(name);
    Link& link = links_.emplace_back();
    link.name = name;
    Made<Hinge> made;
    // Whether it turns or slides is known when it is made.
    const Value* value =
        checker_.of_either([&] { return check_plugin_map(given, "type", grammar::hinge_members(), checker_, made); });
    HingeNode node;
    node.name = name;
    // The ends are looked up whatever else is wrong.
    const Value& ends = made.plugin != nullptr ? made.value : given;
    find_parent(ends, link, node);
    find_child(ends, link, node);
    if (value == nullptr) {
      problems_.good = false;
      return;
    }
    node.offset = pose_of(value->at("offset"), problems_);
    node.hinge = hinges_.of(*made.plugin, *value, checker_);
    if (node.hinge == nullptr) {
      problems_.good = false;
    } else {
      name_rates(name, given, *node.hinge);
    }
    take_reflected_inertia(given, *value, node);
    hinge_nodes_.push_back(std::move(node));
    hinge_values_.emplace_back(name, std::move(made.value));
  }

  const Checker& checker_;
  SceneTree tree_;
  TreeProblems problems_{checker_};
  TreeBodies bodies_{problems_, tree_};
  MadeOnce<Hinge> hinges_;
  std::vector<HingeNode> hinge_nodes_;
  std::vector<Link> links_;
  std::vector<Value::Member> hinge_values_;
};

}  // namespace

SceneTree build_tree(const Value& bodies, const Value& hinges, const Value& scene, const Vector3& gravity,
                     const Checker& checker) {
  return TreeBuilder(checker).build(bodies, hinges, scene, gravity);
}

}  // namespace withy
