#include "withy/scene/tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/made_once.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/state.hpp"
#include "withy/scene/topology.hpp"
#include "withy/scene/visual.hpp"

namespace withy {
namespace {

constexpr double most_bytes = 4.0 * 1024 * 1024 * 1024;

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

  SceneTree build(const Value& bodies, const Value& hinges, const Vector3& gravity) {
    for (const auto& [name, value] : bodies.members()) add_body(name, value);
    for (const auto& [name, value] : hinges.members()) add_hinge(name, value);
    for (const Entry& entry : entries_) weld_segments(entry);
    good_ = check_topology(tree_.names.bodies.names(), links_, checker_) && good_;
    tree_.bodies = Value::map(std::move(body_values_), bodies.place());
    tree_.hinges = Value::map(std::move(hinge_values_), hinges.place());
    for (const BodyNode& node : nodes_) {
      tree_.names.frames.add(node.name);
      for (const Frame& f : node.frames) tree_.names.frames.add(node.name + "." + f.name);
    }
    tree_.names.frames_complete = good_;
    if (!good_) return std::move(tree_);
    add_names_of_wholes();
    try {
      tree_.model = std::make_unique<Model>(std::move(nodes_), std::move(hinge_nodes_), gravity);
    } catch (const std::invalid_argument& e) {
      error(hinges, e.what());
    }
    return std::move(tree_);
  }

 private:
  /// A body of the scene: the nodes it became, one or, in segments, several from its root on.
  struct Entry {
    std::string name;
    int first = 0;
    int count = 1;
    int held = -1;  ///< the node that the inboard hinge holds
    Place place;
  };
  /// A node and one of its frames.
  struct NodeFrame {
    int node = -1;
    int frame = 0;
  };

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
    index_.emplace(name, static_cast<int>(entries_.size()));
    entries_.push_back({name, static_cast<int>(nodes_.size()), 1, -1, given.place()});
    tree_.names.bodies.add(name);
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
    bytes_ += predicted_bytes(*value, made.plugin->parameters);
    if (bytes_ > most_bytes) {
      if (before <= most_bytes) {
        key_error(value->place().path, fmt::format("its modes bring the model to about {:.1f} GiB of memory; need at "
                                                   "most {:.0f}: use fewer modes",
                                                   bytes_ / (most_bytes / 4), most_bytes / (most_bytes / 4)));
      }
      good_ = false;
      return;
    }
    const std::shared_ptr<const Body> body = bodies_.of(*made.plugin, *value, checker_);
    if (body == nullptr) {
      good_ = false;
      return;
    }
    if (!check_shape(*body, made.plugin->id, *value)) return;
    if (const Value* visual = value->find("visual"))
      good_ = check_visual(*visual, *body, checker_.make_context().directory, checker_.diagnostics()) && good_;
    node.body = body;
    if (node.body->segments().size() > 1) {
      add_segments(made.plugin->id, *value);
    } else {
      add_ends(node, *value);
      if (node.body != nullptr) add_frames(value->at("frames"), *node.body);
    }
    if (auto counts = mode_counts(*value, made.plugin->parameters); !counts.empty())
      tree_.modes.push_back({name, std::move(counts)});
    body_values_.emplace_back(name, std::move(made.value));
  }

  bool check_shape(const Body& body, const std::string& plugin, const Value& value) {
    const std::string fault = find_fault(body.shape());
    if (fault.empty()) return true;
    key_error(value.place().path, fmt::format("body plugin '{}' made a shape that cannot be: {}", plugin, fault));
    return false;
  }

  /// Replaces the last node, the whole body, by its segments.
  void add_segments(const std::string& plugin, const Value& value) {
    const BodyNode whole = std::move(nodes_.back());
    const auto segments = whole.body->segments();
    nodes_.pop_back();
    for (std::size_t k = 0; k < segments.size(); ++k) {
      BodyNode& node = nodes_.emplace_back();
      node.name = fmt::format("{}.{}", whole.name, k + 1);
      node.terms = whole.terms;
      node.segment = Segment{whole.name, k, segments.size()};
      if (segments[k] == nullptr || !check_shape(*segments[k], plugin, value)) {
        good_ = false;
        return;
      }
      node.body = segments[k];
      add_ends(node, value);
      if (node.body == nullptr) return;
      if (node.frame("tip") < 0) {
        key_error(value.place().path, fmt::format("body plugin '{}' made a segment without a tip", plugin));
        return;
      }
    }
    entries_.back().count = static_cast<int>(segments.size());
    add_frames(value.at("frames"), *whole.body);
  }

  /// Welds the segments of a body to each other, outwards from the one that the body's hinge holds.
  void weld_segments(const Entry& entry) {
    if (entry.count == 1 || entry.held < 0 || !good_) return;
    const auto* plugin = checker_.registry().find<Hinge>("weld");
    if (plugin == nullptr) {
      key_error(entry.place.path + "/segments", "no hinge plugin 'weld' to join the segments with");
      return;
    }
    for (int i = entry.first; i < entry.first + entry.count; ++i) {
      if (i == entry.held) continue;
      const bool outwards = i > entry.held;
      HingeNode& hinge = hinge_nodes_.emplace_back();
      hinge.parent = outwards ? i - 1 : i + 1;
      hinge.child = i;
      hinge.name = nodes_[static_cast<std::size_t>(i)].name + ".weld";
      hinge.parent_frame = nodes_[static_cast<std::size_t>(hinge.parent)].frame(outwards ? "tip" : "root");
      hinge.child_frame = nodes_[static_cast<std::size_t>(i)].frame(outwards ? "root" : "tip");
      hinge.hinge = hinges_.of(*plugin, Value::map({}, entry.place), checker_);
      if (hinge.hinge == nullptr) good_ = false;
    }
  }

  void add_names_of_wholes() {
    for (const Entry& entry : entries_) {
      if (entry.count == 1) continue;
      tree_.names.frames.add(entry.name);
      for (int i = entry.first; i < entry.first + entry.count; ++i) {
        for (const Frame& f : nodes_[static_cast<std::size_t>(i)].frames)
          tree_.names.frames.add(entry.name + "." + f.name);
      }
    }
  }

  /// What a body's own formulation keeps: its name, or a map with its options.
  std::optional<Terms> terms_of(const Value& given) {
    const Value choice =
        given.kind() == Value::Kind::text ? Value::map({{"name", given}}, given.place()) : given;  // it is checked
    const Value& id = choice.at("name");
    if (id.kind() == Value::Kind::text && id.text() == "auto") {
      checker_.diagnostics().error(id.place(), "got 'auto', which is a choice for a whole scene; name a formulation");
      good_ = false;
      return {};
    }
    Made<Formulation> made;
    const auto value = check_plugin_map(choice, "name", {grammar::formulation_name()}, checker_, made);
    const auto formulation = value ? make_object(*made.plugin, *value, checker_) : nullptr;
    if (formulation != nullptr && formulation->terms().products_of_speeds) return formulation->terms();
    if (formulation != nullptr)
      key_error(id.place().path, fmt::format("{} holds for whole scenes, not for single bodies", in_quotes(id.text())));
    good_ = false;
    return {};
  }

  /// The ends of a body are frames whether a hinge uses them or not: results speak of them.
  void add_ends(BodyNode& node, const Value& value) {
    for (const char* station : {"root", "tip"}) {
      if (auto section = node.body->station(std::string(station))) node.frames.push_back({station, *section, {}});
    }
    if (!node.frames.empty() && node.frames[0].name == "root") return;
    key_error(value.at("frames").place().path, fmt::format("body '{}' has no station 'root'", node.name));
    node.body = nullptr;
  }

  /// The frames of the last body, `whole` in segments or not.
  void add_frames(const Value& frames, const Body& whole) {
    for (const auto& [name, frame] : frames.members()) {
      if (whole.station(name)) {
        key_error(frame.place().path, fmt::format("'{}' is a station of the body already; choose another name", name));
        continue;
      }
      const Value& at = frame.at("at");
      const Body::StationName station =
          at.kind() == Value::Kind::number ? Body::StationName(at.number()) : Body::StationName(at.text());
      BodyNode* node = nullptr;
      std::optional<PointExpansion> section;
      if (whole.station(station)) section = section_of(station, node);
      if (!section) {
        error(at, fmt::format("no station {}; need {}", shown(at), whole.stations()));
        continue;
      }
      node->frames.push_back({name, *section, pose_of(frame)});
    }
  }

  /// The section at a station of the last body, and the node that has it: of segments the one where x lies.
  std::optional<PointExpansion> section_of(const Body::StationName& station, BodyNode*& node) {
    const Entry& entry = entries_.back();
    const auto piece = [&](int k) { return &nodes_[static_cast<std::size_t>(entry.first + k)]; };
    node = piece(0);
    if (entry.count == 1) return node->body->station(station);
    const double length = node->body->shape().length;
    if (const auto* name = std::get_if<std::string>(&station)) {
      if (*name == "tip") node = piece(entry.count - 1);
      return *name == "tip" || *name == "root" ? node->body->station(station) : std::nullopt;
    }
    const double x = std::get<double>(station);
    const int k = std::clamp(static_cast<int>(x / length), 0, entry.count - 1);
    node = piece(k);
    return node->body->station(std::clamp(x - k * length, 0.0, length));
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
    error(end, fmt::format("no body {}{}", in_quotes(at.body), checker_.suggest(at.body, tree_.names.bodies.names())));
    return -2;
  }

  /// A frame of a body; a station it has becomes a frame when it is asked for.
  NodeFrame find_frame(const Value& end, int body, const std::string& name) {
    if (body < 0) return {};
    const Entry& entry = entries_[static_cast<std::size_t>(body)];
    const auto node = [&](int i) -> BodyNode& { return nodes_[static_cast<std::size_t>(i)]; };
    for (int i = entry.first; i < entry.first + entry.count; ++i) {
      if (static_cast<std::size_t>(i) >= nodes_.size() || node(i).body == nullptr) return {};  // reported already
    }
    const int last = entry.first + entry.count - 1;
    if (name == "tip" && node(last).frame(name) >= 0) return {last, node(last).frame(name)};
    std::vector<std::string> known;
    for (int i = entry.first; i <= last; ++i) {
      if (const int index = node(i).frame(name); index >= 0) return {i, index};
      for (const Frame& f : node(i).frames) {
        if (std::find(known.begin(), known.end(), f.name) == known.end()) known.push_back(f.name);
      }
    }
    if (const auto section = entry.count == 1 ? node(last).body->station(name) : std::nullopt) {
      node(last).frames.push_back({name, *section, {}});
      return {last, static_cast<int>(node(last).frames.size()) - 1};
    }
    error(end, fmt::format("body '{}' has no frame {}{}; its frames name other places of it", entry.name,
                           in_quotes(name), checker_.suggest(name, known)));
    return {};
  }

  void add_hinge(const std::string& name, const Value& given) {
    check_name(name, given);
    tree_.names.hinges.add(name);
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
        const NodeFrame found = find_frame(*parent, link.parent, at.frame);
        node.parent = found.node;
        node.parent_frame = found.frame;
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
        const NodeFrame found = find_frame(*child, link.child, at.frame);
        node.child = found.node;
        node.child_frame = found.frame;
        if (link.child >= 0) entries_[static_cast<std::size_t>(link.child)].held = found.node;
      }
    }
    if (!value) {
      good_ = false;
      return;
    }
    node.offset = pose_of(value->at("offset"));
    node.hinge = hinges_.of(*made.plugin, *value, checker_);
    if (node.hinge == nullptr) good_ = false;
    hinge_nodes_.push_back(std::move(node));
    hinge_values_.emplace_back(name, std::move(made.value));
  }

  const Checker& checker_;
  SceneTree tree_;
  MadeOnce<Body> bodies_;
  MadeOnce<Hinge> hinges_;
  std::vector<BodyNode> nodes_;
  std::vector<HingeNode> hinge_nodes_;
  std::vector<Link> links_;
  std::vector<Entry> entries_;
  std::unordered_map<std::string, int> index_;  ///< in entries_
  std::vector<Value::Member> body_values_;
  std::vector<Value::Member> hinge_values_;
  double bytes_ = 0;
  bool good_ = true;
};

}  // namespace

SceneTree build_tree(const Value& bodies, const Value& hinges, const Vector3& gravity, const Checker& checker) {
  return TreeBuilder(checker).build(bodies, hinges, gravity);
}

}  // namespace withy
