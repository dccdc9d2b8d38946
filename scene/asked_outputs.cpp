#include "withy/scene/asked_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "withy/scene/same_content.hpp"
#include "withy/scene/scene_values.hpp"
#include "withy/scene/value_path.hpp"

namespace withy {
namespace {

/// What a quantity is of.
enum class Of { hinge, constraint, frame, body, load, all };

/// A sensor with its options.
struct Quantity {
  const char* word;
  Of of;
  const char* sensor;
  const char* object;    ///< option that names the object
  const char* show;      ///< option `show`; null: none
  const char* argument;  ///< option that what stands behind @ is for; null: it takes none
};

/// Of several quantities with one word the first that has the object.
constexpr std::array quantities = {
    Quantity{"motion", Of::hinge, "hinge", "hinge", nullptr, nullptr},
    Quantity{"acceleration", Of::hinge, "hinge", "hinge", "acceleration", nullptr},
    Quantity{"effort", Of::hinge, "effort", "hinge", nullptr, "of"},
    Quantity{"reaction", Of::hinge, "reaction", "hinge", nullptr, nullptr},
    Quantity{"reaction", Of::constraint, "reaction", "constraint", nullptr, nullptr},
    Quantity{"motion", Of::frame, "frame", "of", nullptr, "in"},
    Quantity{"position", Of::frame, "frame", "of", "position", "in"},
    Quantity{"orientation", Of::frame, "frame", "of", "orientation", "in"},
    Quantity{"velocity", Of::frame, "frame", "of", "velocity", "in"},
    Quantity{"acceleration", Of::frame, "frame", "of", "acceleration", "in"},
    Quantity{"accelerometer", Of::frame, "accelerometer", "of", nullptr, nullptr},
    Quantity{"gyro", Of::frame, "gyro", "of", nullptr, nullptr},
    Quantity{"distance", Of::frame, "distance", "to", nullptr, "from"},
    Quantity{"angle", Of::frame, "angle", "to", nullptr, "from"},
    Quantity{"section", Of::body, "section", "of", nullptr, "at"},
    Quantity{"energy", Of::body, "energy", "of", nullptr, nullptr},
    Quantity{"momentum", Of::body, "momentum", "of", nullptr, nullptr},
    Quantity{"control", Of::load, "control", "of", nullptr, nullptr},
    Quantity{"power", Of::load, "power", "of", nullptr, nullptr},
    Quantity{"energy", Of::all, "energy", nullptr, nullptr, nullptr},
    Quantity{"momentum", Of::all, "momentum", nullptr, nullptr, nullptr},
    Quantity{"power", Of::all, "power", nullptr, nullptr, nullptr},
};

/// Whether it is of a beam at a place, whose coordinate stands behind an @.
bool at_a_place(const Quantity& q) { return q.of == Of::body && q.argument != nullptr; }

std::string dotted(std::span<const std::string> parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ".") + part;
  return text;
}

bool scene_has(const Value& scene, const char* key, const std::string& name) {
  const Value* part = scene.find(key);
  return part != nullptr && part->has(name);
}

bool scene_has(const Value& scene, Of of, const std::string& object) {
  switch (of) {
    case Of::hinge:
      return scene_has(scene, "hinges", object);
    case Of::constraint:
      return scene_has(scene, "constraints", object);
    case Of::frame:
      return scene_has(scene, "bodies", object.substr(0, object.find('.')));
    case Of::body:
      return scene_has(scene, "bodies", object);
    case Of::load:
      return scene_has(scene, "loads", object);
    case Of::all:
      return object.empty();
  }
  return false;
}

const Quantity* quantity_of(const Value& scene, const std::string& word, const std::string& object) {
  const Quantity* first = nullptr;
  for (const Quantity& q : quantities) {
    if (word != q.word || object.empty() != (q.of == Of::all)) continue;
    if (scene_has(scene, q.of, object)) return &q;
    if (first == nullptr) first = &q;
  }
  return first;
}

/// The coordinate at the beginning of a text, and its text: a dot that no digit follows is not of it. No text where
/// anything but a component follows.
std::pair<double, std::string> coordinate_at(std::string_view text) {
  double x = 0;
  const char *const begin = text.data(), *const behind = begin + text.size();
  const char* end = std::from_chars(begin, behind, x).ptr;
  if (end != begin && end[-1] == '.') --end;
  return {x, end == behind || *end == '.' ? std::string(begin, end) : std::string()};
}

/// Whether a part of a name behind a frame says which number of the output is meant, or what of it over the run.
bool says_number(std::string_view part) {
  constexpr std::array<std::string_view, 6> words = {"rate", "min", "max", "mean", "rms", "integral"};
  if (std::find(words.begin(), words.end(), part) != words.end() || part == "qw") return true;
  constexpr std::array<std::string_view, 7> vectors = {"", "q", "r", "v", "w", "a", "alpha"};
  const bool along = part.ends_with('x') || part.ends_with('y') || part.ends_with('z');
  return along && std::find(vectors.begin(), vectors.end(), part.substr(0, part.size() - 1)) != vectors.end();
}

/// The argument that stands at the beginning of what is behind an @: a word, or a frame, which may be a station.
std::string argument_of(const Value& scene, const Quantity& q, std::string_view text) {
  const std::vector<std::string> parts = keys_of_path(text);
  const Value* bodies = scene.find("bodies");
  const Value* body = q.of == Of::frame && bodies != nullptr ? bodies->find(parts[0]) : nullptr;
  if (body == nullptr || parts.size() == 1) return parts[0];
  const Value* frames = body->find("frames");
  const bool frame = (frames != nullptr && frames->has(parts[1])) || !says_number(parts[1]);
  return frame ? parts[0] + '.' + parts[1] : parts[0];
}

}  // namespace

std::optional<AskedOutput> asked_output(const Value& scene, std::string_view name) {
  const std::size_t at = std::min(name.find('@'), name.size());
  const std::vector<std::string> parts = keys_of_path(name.substr(0, at));
  for (std::size_t i = parts.size(); i-- > 0;) {
    if (at < name.size() && i + 1 < parts.size()) break;  // the argument follows the quantity
    const std::string object = dotted(std::span(parts).first(i));
    const Quantity* q = quantity_of(scene, parts[i], object);
    if (q == nullptr) continue;
    AskedOutput asked{dotted(std::span(parts).first(i + 1)), Value::map({{"type", Value(std::string(q->sensor))}})};
    if (q->object != nullptr) asked.definition.set(q->object, Value(object));
    if (q->show != nullptr) asked.definition.set("show", Value(std::string(q->show)));
    if (at == name.size()) return asked;
    if (q->argument == nullptr) return {};
    std::string argument;
    if (at_a_place(*q)) {
      const auto [x, text] = coordinate_at(name.substr(at + 1));
      asked.definition.set(q->argument, Value(x));
      argument = text;
    } else {
      argument = argument_of(scene, *q, name.substr(at + 1));
      asked.definition.set(q->argument, Value(argument));
    }
    if (argument.empty()) return {};
    asked.name += '@' + argument;
    return asked;
  }
  return {};
}

std::string problem_of_place(const Value& scene, std::string_view name) {
  const std::size_t at = name.find('@');
  if (at == std::string_view::npos) return {};
  const std::vector<std::string> parts = keys_of_path(name.substr(0, at));
  const std::string object = dotted(std::span(parts).first(parts.size() - 1));
  const Quantity* q = quantity_of(scene, parts.back(), object);
  if (q == nullptr || !at_a_place(*q) || !scene_has(scene, q->of, object)) return {};
  if (!coordinate_at(name.substr(at + 1)).second.empty()) return {};
  return fmt::format("'{}' has no place behind the @: need a number, in m, without its unit, as {}.{}@0.3", name,
                     object, q->word);
}

std::vector<std::string> asked_names(const Value& scene) {
  std::vector<std::string> names;
  const auto add = [&](const char* key, const std::vector<Of>& kinds) {
    const Value* part = scene.find(key);
    for (const auto& [object, value] : part == nullptr ? std::vector<Value::Member>{} : part->members()) {
      const Value* type = value.find("type");
      const bool beam = type != nullptr && type->kind() == Value::Kind::text && type->text() == "beam";
      for (const Quantity& q : quantities) {
        if (std::find(kinds.begin(), kinds.end(), q.of) == kinds.end() || (at_a_place(q) && !beam)) continue;
        names.push_back(object + '.' + q.word + (at_a_place(q) ? "@X" : ""));
      }
    }
  };
  add("hinges", {Of::hinge});
  add("constraints", {Of::constraint});
  add("bodies", {Of::frame, Of::body});
  add("loads", {Of::load});
  return names;
}

bool says_its_name(const Value& scene, const std::string& name, const Value& definition) {
  const std::optional<AskedOutput> asked = asked_output(scene, name);
  if (!asked || asked->name != name) return false;
  const auto& members = asked->definition.members();
  return std::all_of(members.begin(), members.end(), [&](const Value::Member& m) {
    const Value* given = definition.find(m.first);
    return given != nullptr && same_content(*given, m.second);
  });
}

bool defines_output(const Value& scene, std::string_view name) {
  const Value* outputs = scene.find("outputs");
  if (outputs == nullptr) return false;
  return std::any_of(outputs->members().begin(), outputs->members().end(), [&](const Value::Member& m) {
    return name.starts_with(m.first) && (name.size() == m.first.size() || name[m.first.size()] == '.');
  });
}

void ask_outputs(SceneValues& values, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (!defines_output(values.root(), name) && asked_output(values.root(), name))
      values.set_text("outputs=" + name, "--output '" + name + "'");
}

}  // namespace withy
