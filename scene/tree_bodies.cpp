#include "withy/scene/tree_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/plugin/segments.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/state.hpp"
#include "withy/scene/visual.hpp"

namespace withy {
namespace {

constexpr double most_bytes = 4.0 * 1024 * 1024 * 1024;

/// The names among what a body says of its stations, the first of them: for messages.
std::vector<std::string> station_names(const Body& body) {
  constexpr std::size_t most = 100;
  std::vector<std::string> names;
  std::istringstream words(body.stations());
  for (std::string word; names.size() < most && words >> word;) {
    if (word.ends_with(',')) word.pop_back();
    if (body.station(word)) names.push_back(word);
  }
  return names;
}

Vector3 vector_of(const Value& list) {
  const std::vector<double> x = list.numbers();
  return {x[0], x[1], x[2]};
}

}  // namespace

void TreeProblems::error(const Value& value, std::string message) {
  checker.diagnostics().error(value.place(), std::move(message));
  good = false;
}

void TreeProblems::key_error(const std::string& path, std::string message) {
  checker.key_error(path, std::move(message));
  good = false;
}

void TreeProblems::check_name(const std::string& name, const Value& value) {
  const std::string problem = name_problem(name);
  if (!problem.empty()) key_error(value.place().path, fmt::format("got name {}; {}", in_quotes(name), problem));
}

Pose pose_of(const Value& value, TreeProblems& problems) {
  std::vector<double> q = value.at("orientation").numbers();
  if (!accept_quaternion(q, value.at("orientation").place(), problems.checker.diagnostics())) problems.good = false;
  return {rotation_from_quaternion(q[0], q[1], q[2], q[3]), vector_of(value.at("position"))};
}

void TreeBodies::add(const std::string& name, const Value& given) {
  problems_.check_name(name, given);
  index_.emplace(name, static_cast<int>(entries_.size()));
  entries_.push_back({name, static_cast<int>(nodes_.size()), 1, -1, given.place()});
  tree_.names.bodies.add(name);
  BodyNode& node = nodes_.emplace_back();
  node.name = name;
  Made<Body> made;
  const auto value = check_plugin_map(given, "type", grammar::body_members(), checker_, made);
  if (const Value* formulation = made.value.find("formulation")) node.terms = terms_of(*formulation);
  if (!value) {
    problems_.good = false;
    return;
  }
  const double before = bytes_;
  bytes_ += predicted_bytes(*value, made.plugin->parameters);
  if (bytes_ > most_bytes) {
    if (before <= most_bytes) {
      problems_.key_error(value->place().path,
                          fmt::format("its modes bring the model to about {:.1f} GiB of memory; need at "
                                      "most {:.0f}: use fewer modes",
                                      bytes_ / (most_bytes / 4), most_bytes / (most_bytes / 4)));
    }
    problems_.good = false;
    return;
  }
  const std::shared_ptr<const Body> body = made_.of(*made.plugin, *value, checker_);
  if (body == nullptr) {
    problems_.good = false;
    return;
  }
  entries_.back().plugin = made.plugin->id;
  if (!asked(entries_.back(), [&] { return add_made(node, body, *value); })) return;
  if (auto counts = mode_counts(*value, made.plugin->parameters); !counts.empty())
    tree_.modes.push_back({name, std::move(counts)});
  values_.emplace_back(name, std::move(made.value));
}

/// What `call` finds out of a body from its plugin; nothing, after reporting at the body, where the plugin throws.
template <class Call>
auto TreeBodies::asked(const Entry& entry, Call&& call) -> decltype(call()) {
  try {
    return plugin_call("body plugin '" + entry.plugin + "' does not say what the body is", call);
  } catch (const std::invalid_argument& e) {
    problems_.key_error(entry.place.path, e.what());
    const std::size_t end = static_cast<std::size_t>(entry.first + entry.count);
    for (std::size_t i = static_cast<std::size_t>(entry.first); i < std::min(end, nodes_.size()); ++i)
      nodes_[i].body = nullptr;  // asked no more
    return {};
  }
}

/// Whether the shape is one. What else is wrong is reported, and the body's values are kept.
bool TreeBodies::add_made(BodyNode& node, std::shared_ptr<const Body> body, const Value& value) {
  const std::string& plugin = entries_.back().plugin;
  if (!check_shape(*body, plugin, value) || !check_measured(*body, plugin, value)) return false;
  if (const Value* visual = value.find("visual"))
    problems_.good =
        check_visual(*visual, *body, checker_.make_context().directory, checker_.diagnostics()) && problems_.good;
  node.body = std::move(body);
  if (node.body->segments().size() > 1) {
    add_segments(plugin, value);
  } else {
    add_ends(node, value);
    if (node.body != nullptr) add_frames(value.at("frames"), *node.body);
  }
  return true;
}

bool TreeBodies::check_measured(const Body& body, const std::string& plugin, const Value& value) {
  const auto refuse = [&](const std::string& station, const char* what) {
    problems_.key_error(value.place().path,
                        fmt::format("body plugin '{}' measures {}at a station that the body does not have, {}; need {}",
                                    plugin, what, in_quotes(station), body.stations()));
    return false;
  };
  const std::string station = body.measured_station();
  if (!station.empty() && !body.station(station)) return refuse(station, "");
  for (const std::string& beside : body.measured_beside())
    if (!body.station(beside)) return refuse(beside, "beside ");
  return true;
}

bool TreeBodies::check_shape(const Body& body, const std::string& plugin, const Value& value) {
  const std::string fault = find_fault(body.shape());
  if (fault.empty()) return true;
  problems_.key_error(value.place().path,
                      fmt::format("body plugin '{}' made a shape that cannot be: {}", plugin, fault));
  return false;
}

/// Replaces the last node, the whole body, by its segments.
void TreeBodies::add_segments(const std::string& plugin, const Value& value) {
  const BodyNode whole = std::move(nodes_.back());
  const auto segments = whole.body->segments();
  nodes_.pop_back();
  for (std::size_t k = 0; k < segments.size(); ++k) {
    BodyNode& node = nodes_.emplace_back();
    node.name = fmt::format("{}.{}", whole.name, k + 1);
    node.terms = whole.terms;
    node.segment = Segment{whole.name, k, segments.size(), whole.body};
    if (segments[k] == nullptr) {
      problems_.key_error(value.place().path,
                          fmt::format("body plugin '{}' made no segment {} of {}", plugin, k + 1, segments.size()));
      return;
    }
    if (!check_shape(*segments[k], plugin, value)) return;
    node.body = segments[k];
    add_ends(node, value);
    if (node.body == nullptr) return;
    if (node.frame("tip") < 0) {
      problems_.key_error(value.place().path, fmt::format("body plugin '{}' made a segment without a tip", plugin));
      return;
    }
  }
  entries_.back().count = static_cast<int>(segments.size());
  add_frames(value.at("frames"), *whole.body);
}

/// What a body's own formulation keeps: its name, or a map with its options.
std::optional<Terms> TreeBodies::terms_of(const Value& given) {
  const Value choice =
      given.kind() == Value::Kind::text ? Value::map({{"name", given}}, given.place()) : given;  // it is checked
  const Value& id = choice.at("name");
  if (id.kind() == Value::Kind::text && id.text() == "auto") {
    checker_.diagnostics().error(id.place(), "got 'auto', which is a choice for a whole scene; name a formulation");
    problems_.good = false;
    return {};
  }
  Made<Formulation> made;
  const auto value = check_plugin_map(choice, "name", {grammar::formulation_name()}, checker_, made);
  const auto formulation = value ? make_object(*made.plugin, *value, checker_) : nullptr;
  if (formulation != nullptr && formulation->terms().products_of_speeds) return formulation->terms();
  if (formulation != nullptr)
    problems_.key_error(id.place().path,
                        fmt::format("{} holds for whole scenes, not for single bodies", in_quotes(id.text())));
  problems_.good = false;
  return {};
}

/// The ends of a body, and where it is measured, are frames whether a hinge uses them or not: results speak of them.
void TreeBodies::add_ends(BodyNode& node, const Value& value) {
  for (const char* station : {"root", "tip"}) {
    if (auto section = node.body->station(std::string(station))) node.frames.push_back({station, *section, {}});
  }
  if (node.body->shape().modes() > 0)
    for (MeasuredPlace& place : measured_places(*node.body))
      if (node.frame(place.name) < 0) node.frames.push_back({place.name, std::move(place.at), {}});
  if (!node.frames.empty() && node.frames[0].name == "root") return;
  problems_.key_error(value.at("frames").place().path, fmt::format("body '{}' has no station 'root'", node.name));
  node.body = nullptr;
}

/// The frames of the last body, `whole` in segments or not.
void TreeBodies::add_frames(const Value& frames, const Body& whole) {
  for (const auto& [name, frame] : frames.members()) {
    if (whole.station(name)) {
      problems_.key_error(frame.place().path,
                          fmt::format("'{}' is a station of the body already; choose another name", name));
      continue;
    }
    const Value& at = frame.at("at");
    const Body::StationName station =
        at.kind() == Value::Kind::number ? Body::StationName(at.number()) : Body::StationName(at.text());
    BodyNode* node = nullptr;
    std::optional<PointExpansion> section;
    if (whole.station(station)) section = section_of(station, node);
    if (!section) {
      problems_.error(at, fmt::format("no station {}; need {}", shown(at), whole.stations()));
      continue;
    }
    node->frames.push_back({name, *section, pose_of(frame, problems_)});
  }
}

/// The section at a station of the last body, and the node that has it: of segments the one where x lies.
std::optional<PointExpansion> TreeBodies::section_of(const Body::StationName& station, BodyNode*& node) {
  const Entry& entry = entries_.back();
  const auto piece = [&](int k) { return &nodes_[static_cast<std::size_t>(entry.first + k)]; };
  node = piece(0);
  if (entry.count == 1) return node->body->station(station);
  if (const auto* name = std::get_if<std::string>(&station)) {
    if (*name == "tip") node = piece(entry.count - 1);
    return *name == "tip" || *name == "root" ? node->body->station(station) : std::nullopt;
  }
  std::vector<double> lengths;
  for (int k = 0; k < entry.count; ++k) lengths.push_back(piece(k)->body->shape().length);
  const auto place = place_in_segments(lengths, std::get<double>(station));
  if (!place) return {};
  node = piece(static_cast<int>(place->segment));
  return node->body->station(place->x);
}

int TreeBodies::find(const Value& end, const std::string& name) {
  const auto it = index_.find(name);
  if (it != index_.end()) return it->second;
  problems_.error(end,
                  fmt::format("no body {}{}", in_quotes(name), checker_.suggest(name, tree_.names.bodies.names())));
  return -2;
}

bool TreeBodies::is_made(const Entry& entry) const {
  for (int i = entry.first; i < entry.first + entry.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (at >= nodes_.size() || nodes_[at].body == nullptr) return false;
  }
  return true;
}

/// A frame of a body, or of the station that it has by this name; node −1 where there is none.
TreeBodies::NodeFrame TreeBodies::find_frame(const Entry& entry, const std::string& name) {
  const int last = entry.first + entry.count - 1;
  BodyNode& outermost = nodes_[static_cast<std::size_t>(last)];
  if (const int tip = outermost.frame("tip"); name == "tip" && tip >= 0) return {last, tip};
  for (int i = entry.first; i <= last; ++i)
    if (const int index = nodes_[static_cast<std::size_t>(i)].frame(name); index >= 0) return {i, index};
  const auto section = entry.count == 1 ? outermost.body->station(name) : std::nullopt;
  if (!section) return {};
  outermost.frames.push_back({name, *section, {}});
  return {last, static_cast<int>(outermost.frames.size()) - 1};
}

/// Names of a body's frames and stations, for messages.
std::vector<std::string> TreeBodies::places_of(const Entry& entry) const {
  NameList places;
  for (int i = entry.first; i < entry.first + entry.count; ++i) {
    const BodyNode& node = nodes_[static_cast<std::size_t>(i)];
    for (const Frame& f : node.frames) places.add(f.name);
    for (std::string& name : station_names(*node.body)) places.add(std::move(name));
  }
  return places.names();
}

TreeBodies::NodeFrame TreeBodies::frame(const Value& end, int body, const std::string& name) {
  if (body < 0) return {};
  const Entry& entry = entries_[static_cast<std::size_t>(body)];
  if (!is_made(entry)) return {};  // reported already
  return asked(entry, [&]() -> NodeFrame {
    const NodeFrame found = find_frame(entry, name);
    if (found.node >= 0) return found;
    problems_.error(end, fmt::format("body '{}' has no frame {}{}; its frames name other places of it", entry.name,
                                     in_quotes(name), checker_.suggest(name, places_of(entry))));
    return {};
  });
}

void TreeBodies::add_named_stations(const Value& value) {
  for (const Value& item : value.items()) add_named_stations(item);
  for (const auto& [key, member] : value.members()) add_named_stations(member);
  if (value.kind() != Value::Kind::text) return;
  const std::string& text = value.text();
  const std::size_t dot = text.find('.');
  if (dot == std::string::npos) return;
  const auto it = index_.find(text.substr(0, dot));
  if (it == index_.end()) return;
  const Entry& entry = entries_[static_cast<std::size_t>(it->second)];
  if (!is_made(entry)) return;
  const auto places = asked(entry, [&]() -> std::vector<std::string> {
    if (find_frame(entry, text.substr(dot + 1)).node >= 0) return {};
    return places_of(entry);
  });
  for (const std::string& place : places) tree_.names.places.add(entry.name + "." + place);
}

void TreeBodies::check_mode_names(const Model& model) {
  for (const Entry& entry : entries_) {
    for (int k = 1; k <= entry.count; ++k) {
      const int body = model.body(entry.count == 1 ? entry.name : fmt::format("{}.{}", entry.name, k));
      const std::string fault = body < 0 ? "" : mode_name_fault(model, static_cast<std::size_t>(body));
      if (fault.empty()) continue;
      problems_.key_error(entry.place.path,
                          fmt::format("body plugin '{}' made a body that cannot be told of: {}", entry.plugin, fault));
      break;
    }
  }
}

void TreeBodies::name_frames() {
  for (const BodyNode& node : nodes_) {
    tree_.names.frames.add(node.name);
    for (const Frame& f : node.frames) tree_.names.frames.add(node.name + "." + f.name);
  }
  for (const Entry& entry : entries_) {
    if (entry.count == 1) continue;
    tree_.names.frames.add(entry.name);
    for (int i = entry.first; i < entry.first + entry.count; ++i) {
      for (const Frame& f : nodes_[static_cast<std::size_t>(i)].frames)
        tree_.names.frames.add(entry.name + "." + f.name);
    }
  }
  if (tree_.names.places.names().empty()) return;
  NameList places = tree_.names.frames;
  for (const std::string& name : tree_.names.places.names()) places.add(name);
  tree_.names.places = std::move(places);
}

}  // namespace withy
