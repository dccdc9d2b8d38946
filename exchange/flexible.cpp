#include "flexible.hpp"

#include <fmt/format.h>

#include "withy/core/spatial/direction.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy::exchange {
namespace {

class FlexibleReader {
 public:
  FlexibleReader(const Tree& tree, Diagnostics& diagnostics) : tree_(tree), diagnostics_(diagnostics) {}

  std::optional<FlexibleLink> link(const Value& value, int index) const {
    if (value.kind() != Value::Kind::map) {
      diagnostics_.error(value.place(), "need a map with `tip` and the parameters of a beam");
      return {};
    }
    const Value* tip_given = value.find("tip");
    if (tip_given == nullptr) {
      diagnostics_.error(value.place(), "missing: tip, a joint of the link or a point [x, y, z] of its frame [m]");
      return {};
    }
    const auto tip = tip_of(*tip_given, index);
    const Value* root_given = value.find("root");
    const auto root = root_given != nullptr ? point(*root_given) : Vector3(Vector3::Zero());
    if (!tip || !root) return {};
    if ((*tip - *root).norm() == 0) {
      diagnostics_.error(tip_given->place(), "the beam would have no length: its tip is its root");
      return {};
    }
    if (const Value* length = value.find("length"))
      diagnostics_.error(length->place(), "unknown key \"length\": it is the distance from root to tip");
    return made(value, *root, *tip, index);
  }

 private:
  [[nodiscard]] std::optional<Vector3> point(const Value& value) const {
    if (value.kind() == Value::Kind::list && value.items().size() == 3) {
      const auto all_numbers = std::all_of(value.items().begin(), value.items().end(), [](const Value& v) {
        return v.kind() == Value::Kind::number && std::isfinite(v.number());
      });
      if (all_numbers) return Vector3(value.items()[0].number(), value.items()[1].number(), value.items()[2].number());
    }
    diagnostics_.error(value.place(), "need three finite numbers [x, y, z] in the frame of the link");
    return {};
  }

  [[nodiscard]] std::optional<Vector3> tip_of(const Value& value, int index) const {
    if (value.kind() != Value::Kind::text) return point(value);
    std::vector<std::string> known;
    for (const Joint& joint : tree_.joints) {
      if (joint.parent != index) continue;
      if (joint.name == value.text()) return joint.offset.p;
      known.push_back(joint.name);
    }
    diagnostics_.error(value.place(),
                       fmt::format("no joint {} hangs on this link{}", in_quotes(value.text()),
                                   known.empty() ? "; give a point [x, y, z]" : "; there are: " + listed(known)));
    return {};
  }

  [[nodiscard]] FlexibleLink made(const Value& value, const Vector3& root, const Vector3& tip, int index) const {
    FlexibleLink flexible;
    flexible.length = (tip - root).norm();
    const Vector3 x = (tip - root) / flexible.length;
    // Without a wish: the first axis of the link, from y on, that is well across the beam.
    Vector3 wish = std::abs(x.y()) < 0.9 ? Vector3::UnitY() : Vector3::UnitZ();
    if (const Value* given = value.find("y")) {
      const auto read = point(*given);
      const auto unit = read ? unit_along(*read) : std::nullopt;
      if (unit) wish = *unit;
      if (read && (!unit || x.cross(*unit).norm() <= 1e-9))
        diagnostics_.error(given->place(), "the direction of y is along the beam; need one across it");
    }
    flexible.beam.R.col(0) = x;
    flexible.beam.R.col(2) = x.cross(wish).normalized();
    flexible.beam.R.col(1) = flexible.beam.R.col(2).cross(x);
    flexible.beam.p = root;
    std::vector<Value::Member> parameters;
    const Link& link = tree_.links[static_cast<std::size_t>(index)];
    if (!value.has("mass_per_length") && link.mass > 0)
      parameters.emplace_back("mass_per_length", Value(link.mass / flexible.length, value.place()));
    for (const Value::Member& member : value.members()) {
      if (member.first == "type" || member.first == "length" || member.first == "frames")
        diagnostics_.error(member.second.place(),
                           "a flexible link is a beam as long as its joints are apart, which are its frames; leave '" +
                               member.first + "' out");
      if (member.first != "tip" && member.first != "root" && member.first != "y") parameters.push_back(member);
    }
    flexible.parameters = Value::map(std::move(parameters), value.place());
    return flexible;
  }

  const Tree& tree_;
  Diagnostics& diagnostics_;
};

}  // namespace

FlexibleLinks read_flexible(std::string_view text, const std::string& file, const Tree& tree) {
  FlexibleLinks all;
  all.file = file;
  Diagnostics diagnostics;
  const bool whole = read_document(text, {}, all.document, diagnostics);
  const Value& root = all.document.root;
  const Value* format = root.find("format");
  if (whole && (format == nullptr || format->kind() != Value::Kind::text || format->text() != "withy-flexible/1"))
    diagnostics.error(root.place(), "need a map with format: withy-flexible/1");
  const Value* links = root.find("links");
  if (whole && (links == nullptr || links->kind() != Value::Kind::map))
    diagnostics.error(root.place(), "missing: links, a map of names of links to beams");
  if (!diagnostics.ok()) throw SceneError(file, diagnostics.errors());
  std::vector<std::string> names;
  for (const Link& link : tree.links) names.push_back(link.name);
  for (const auto& [key, value] : root.members())
    if (key != "format" && key != "links")
      diagnostics.error(all.document.key_place(value.place().path), "unknown key " + in_quotes(key));
  for (const auto& [name, value] : links->members()) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string guess = nearest(name, names);
      diagnostics.error(all.document.key_place(value.place().path),
                        fmt::format("there is no link {}{}", in_quotes(name),
                                    guess.empty() ? "" : "; did you mean '" + guess + "'?"));
      continue;
    }
    const int index = static_cast<int>(found - names.begin());
    if (auto link = FlexibleReader(tree, diagnostics).link(value, index)) all.of_link.emplace(index, std::move(*link));
  }
  if (!diagnostics.ok()) throw SceneError(file, diagnostics.errors());
  return all;
}

}  // namespace withy::exchange
