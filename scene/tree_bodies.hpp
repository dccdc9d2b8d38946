/// \file
/// From the bodies of a scene to nodes of its model.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "withy/scene/made_once.hpp"
#include "withy/scene/tree.hpp"

namespace withy {

/// Reports what is wrong with a tree, and keeps whether anything is.
struct TreeProblems {
  const Checker& checker;
  bool good = true;

  void error(const Value& value, std::string message);
  void key_error(const std::string& path, std::string message);
  /// The name that a body or hinge bears.
  void check_name(const std::string& name, const Value& value);
};

/// After reporting a bad orientation the pose is meaningless.
Pose pose_of(const Value& value, TreeProblems& problems);

/// Checks the bodies of a scene and makes nodes of them. Its problems and the scene's tree outlive it.
class TreeBodies {
 public:
  /// A body of the scene: the nodes it became, one or, in segments, several from its root on.
  struct Entry {
    std::string name;
    int first = 0;
    int count = 1;
    int held = -1;  ///< the node that the inboard hinge holds
    Place place;
    std::string plugin = {};  ///< that made it
  };
  /// A node and one of its frames.
  struct NodeFrame {
    int node = -1;
    int frame = 0;
  };

  TreeBodies(TreeProblems& problems, SceneTree& tree) : problems_(problems), checker_(problems.checker), tree_(tree) {}

  /// Checks a body and adds its nodes, its name and its numbers of modes.
  void add(const std::string& name, const Value& given);
  /// Index of the body a hinge's end names; −2 after reporting.
  int find(const Value& end, const std::string& name);
  /// A frame of a body; a station it has becomes a frame when it is asked for. Node −1 after reporting.
  /// \param body index in entries(), negative where none was found
  NodeFrame frame(const Value& end, int body, const std::string& name);
  /// Makes frames of the stations that texts in a value name as "body.station".
  void add_named_stations(const Value& value);
  /// Notes the node of a body that its inboard hinge holds.
  void hold(int body, int node) { entries_[static_cast<std::size_t>(body)].held = node; }
  /// Reports modes that are named as another column of tables is. \param model made of the nodes
  void check_mode_names(const Model& model);
  /// Adds the names of all frames to those that other values may refer to.
  void name_frames();

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::vector<BodyNode>& nodes() { return nodes_; }
  /// Checked, in the order of the scene.
  [[nodiscard]] std::vector<Value::Member>& values() { return values_; }

 private:
  template <class Call>
  auto asked(const Entry& entry, Call&& call) -> decltype(call());
  bool add_made(BodyNode& node, std::shared_ptr<const Body> body, const Value& value);
  bool check_shape(const Body& body, const std::string& plugin, const Value& value);
  bool check_measured(const Body& body, const std::string& plugin, const Value& value);
  void add_segments(const std::string& plugin, const Value& value);
  std::optional<Terms> terms_of(const Value& given);
  void add_ends(BodyNode& node, const Value& value);
  void add_frames(const Value& frames, const Body& whole);
  [[nodiscard]] bool is_made(const Entry& entry) const;
  NodeFrame find_frame(const Entry& entry, const std::string& name);
  [[nodiscard]] std::vector<std::string> places_of(const Entry& entry) const;
  std::optional<PointExpansion> section_of(const Body::StationName& station, BodyNode*& node);

  TreeProblems& problems_;
  const Checker& checker_;
  SceneTree& tree_;
  MadeOnce<Body> made_;
  std::vector<BodyNode> nodes_;
  std::vector<Entry> entries_;
  std::unordered_map<std::string, int> index_;  ///< in entries_
  std::vector<Value::Member> values_;
  double bytes_ = 0;  ///< of memory, that the modes asked for so far need
};

}  // namespace withy
