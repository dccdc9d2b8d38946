#include "withy/study/point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <numeric>
#include <string_view>

#include "withy/scene/one_line.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/mode_basis.hpp"
#include "withy/study/tip_load.hpp"

namespace withy::study {
namespace {

/// What an initial state says of a body's modal coordinates or rates, for another number of modes.
/// \param had modes of each strain up to now, in the order of the values, and \param becomes what these are to be.
Value resized(std::span<const double> values, const std::vector<int>& had, const std::vector<int>& becomes) {
  std::vector<Value> items;
  std::size_t first = 0;
  for (std::size_t strain = 0; strain < had.size(); ++strain) {
    for (int i = 0; i < becomes[strain]; ++i)
      items.emplace_back(i < had[strain] ? values[first + static_cast<std::size_t>(i)] : 0.0);
    first += static_cast<std::size_t>(had[strain]);
  }
  return Value::list(std::move(items));
}

/// How many modes there are to be where there are so many now.
using NumberOfModes = std::function<int(int)>;

/// A family that bodies are to have in the place of their own; empty: none.
struct NewFamily {
  std::string name;
  std::vector<Matrix6> loads;  ///< of each body of the model, where the family knows of them

  NewFamily(std::string family, const Scene& scene) : name(std::move(family)) {
    if (knows_loads()) loads = tip_loads(*scene.model, scene.initial);
  }
  [[nodiscard]] bool knows_loads() const { return name == vibration_modes || name == loaded_modes; }
  /// What a body's value says; nothing where the family does not fit. Segments have none of their own names.
  [[nodiscard]] std::optional<Value> of(const Scene& scene, const std::string& body, const std::string& strain) const {
    if (name.empty()) return {};
    if (!knows_loads()) return Value(name);
    const int index = scene.model->body(body);
    if (index < 0) return {};
    return loaded_family(loads[static_cast<std::size_t>(index)], strain, name, varies(scene, body));
  }
};

/// What another number of modes and another family change in a body.
struct ModesChanged {
  std::vector<int> had;      ///< modes of each strain up to now, in the order of the coordinates
  std::vector<int> becomes;  ///< the same from now on; none where there were none
  bool families = false;
  std::vector<std::pair<std::string, Value>> values;  ///< by paths below the body
};

/// Gives a body other modes, by what it has of each, and the family where one is named. The family is of bending; other
/// strains take it where both it and their own can be any strain of a clamped beam, so that no strain converges more
/// slowly than the rest.
ModesChanged change_modes(const Scene& scene, const BodyModes& body, const NumberOfModes& number, const NewFamily& to,
                          Registry& registry) {
  ModesChanged changed;
  for (const ModeCount& count : body.counts) {
    const auto had = static_cast<int>(count.modes), becomes = had == 0 ? 0 : number(had);
    changed.had.push_back(had);
    changed.becomes.push_back(becomes);
    if (had == 0) continue;
    changed.values.emplace_back(count.path, Value(static_cast<double>(becomes)));
    const std::optional<Value> family = to.of(scene, body.body, count.strain);
    const std::string path = family ? family_path(scene, body.body, count, registry) : "";
    const Value* own = family_at(scene, body.body, path);
    if (path.empty() || (own != nullptr && own->kind() == Value::Kind::text && family->kind() == Value::Kind::text &&
                         own->text() == family->text()))
      continue;
    const bool bending = !count.family_path.empty();
    if (!bending && !(own != nullptr && spans_cantilevers(*own, registry) && spans_cantilevers(*family, registry)))
      continue;
    changed.families = true;
    changed.values.emplace_back(path, *family);
  }
  return changed;
}

/// Keeps what the initial state says of a body's modes: by the number of each where the family stays, else by the
/// shape.
void change_start(std::vector<Change>& changes, const Scene& scene, const std::string& name, const ModesChanged& modes,
                  Registry& registry) {
  const Value* initial = scene.source.find("initial");
  const Value* starts = initial != nullptr ? initial->find("bodies") : nullptr;
  const Value* start = starts != nullptr ? starts->find(name) : nullptr;
  // The initial states of segments have names of their own.
  const Slot* const slot = scene.model->layout().body(name);
  if (start == nullptr || slot == nullptr) return;
  if (std::accumulate(modes.had.begin(), modes.had.end(), std::size_t{0}) != slot->speeds)
    throw InputError("body '" + name +
                     "' has other modes than its plugin says: its initial state cannot be carried over");
  const auto& bodies = scene.model->bodies();
  const auto node = std::find_if(bodies.begin(), bodies.end(), [&](const BodyNode& b) { return b.name == name; });
  const auto becomes = modes.families ? body_with(scene, name, modes.values, registry) : nullptr;
  const auto carried = [&](std::span<const double> values) {
    if (!modes.families || std::all_of(values.begin(), values.end(), [](double v) { return v == 0; }))
      return resized(values, modes.had, modes.becomes);
    const auto shape = becomes != nullptr ? same_shape(*node->body, values, *becomes) : std::nullopt;
    if (!shape)
      throw InputError("body '" + name +
                       "' has no stations along itself: its initial state cannot be carried over to other functions");
    std::vector<Value> items;
    for (const double v : *shape) items.emplace_back(v);
    return Value::list(std::move(items));
  };
  const std::string path = "initial.bodies." + name;
  const std::span<const double> y = scene.initial.y;
  if (start->has("modes")) changes.push_back({path + ".modes", carried(y.subspan(slot->position, slot->speeds))});
  if (start->has("rates"))
    changes.push_back(
        {path + ".rates", carried(y.subspan(scene.model->layout().positions + slot->speed, slot->speeds))});
}

/// What gives all bodies other modes, and keeps what the initial state says of them.
void change_all_modes(std::vector<Change>& changes, const Scene& scene, const NumberOfModes& number,
                      const std::string& family, Registry& registry) {
  const NewFamily to(family, scene);
  for (const BodyModes& body : scene.modes) {
    const ModesChanged modes = change_modes(scene, body, number, to, registry);
    for (const auto& [path, value] : modes.values) changes.push_back({"bodies." + body.body + '.' + path, value});
    change_start(changes, scene, body.body, modes, registry);
  }
}

}  // namespace

std::string Point::key() const {
  std::string key =
      fmt::format("{}_{}_{}_{}_{:g}", formulation, modes, family.empty() ? "scene" : family, integrator, tolerance);
  for (const std::string& o : over) key += '_' + o;
  for (const auto& [body, own] : bodies) key += '_' + body + '=' + own;
  for (char& c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && std::string_view("._=+-").find(c) == std::string::npos)
      c = '~';
  }
  return key;
}

std::string Point::formulation_text() const {
  std::string text = formulation;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    text += (i == 0 ? " (" : ", ") + bodies[i].first;
    if (i + 1 == bodies.size() || bodies[i + 1].second != bodies[i].second) text += ": " + bodies[i].second;
  }
  return bodies.empty() ? text : text + ')';
}

std::string Point::text() const {
  std::string text = formulation_text();
  if (modes > 0) text += fmt::format(", {} mode{}", modes, modes == 1 ? "" : "s");  // else those of the scene
  if (!family.empty()) text += (modes > 0 ? " " : ", ") + family;
  text += fmt::format(", {} at {:g}", integrator, tolerance);
  for (const std::string& o : over) text += ", " + o;
  return text;
}

bool Point::same_model(const Point& other) const {
  return formulation == other.formulation && family == other.family && modes == other.modes && bodies == other.bodies &&
         over == other.over;
}

double absolute_tolerance(double relative) { return to_digits(1e-2 * relative, 6); }

void check_axes(const Axes& axes) {
  for (const int m : axes.modes)
    if (m < 1 || m > 200) throw OptionError("modes", fmt::format("got {}; need 1 to 200", m));
  for (const double t : axes.tolerances)
    if (!(t > 0 && t <= 1)) throw OptionError("tolerances", fmt::format("got {:g}; need above 0, at most 1", t));
  for (const std::string& f : axes.formulations)
    if (f == "auto") throw OptionError("formulations", "'auto' is a choice along a run, not a model; leave it out");
}

std::vector<Point> points_of(const Axes& axes) {
  std::vector<std::vector<std::string>> overs{{}};
  for (const Variation& v : axes.over) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& before : overs) {
      for (const std::string& value : v.values) {
        longer.push_back(before);
        longer.back().push_back(v.path + '=' + value);
      }
    }
    overs = std::move(longer);
  }
  std::vector<Point> points;
  for (const auto& over : overs)
    for (const std::string& formulation : axes.formulations)
      for (const std::string& family : axes.families)
        for (const int modes : axes.modes)
          for (const std::string& integrator : axes.integrators)
            for (const double tolerance : axes.tolerances)
              points.push_back({formulation, family, modes, integrator, tolerance, over});
  return points;
}

std::string Change::text() const { return path + '=' + in_one_line(value); }

std::vector<Change> changes_at(const Scene& scene, const Point& point, Registry& registry) {
  std::vector<Change> changes;
  if (!point.integrator.empty())
    changes.push_back({"integrator", Value::map({{"name", Value(point.integrator)},
                                                 {"rtol", Value(point.tolerance)},
                                                 {"atol", Value(absolute_tolerance(point.tolerance))}})});
  if (point.modes > 0)
    change_all_modes(
        changes, scene, [&](int) { return point.modes; }, point.family, registry);
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    const std::string& of = name;
    const auto own =
        std::find_if(point.bodies.begin(), point.bodies.end(), [&](const auto& b) { return b.first == of; });
    if (own != point.bodies.end()) {
      changes.push_back({"bodies." + name + ".formulation", Value(own->second)});
    } else if (body.has("formulation")) {
      changes.push_back({"bodies." + name + ".formulation", Value(point.formulation)});
    }
  }
  return changes;
}

SceneValues values_at(SceneValues values, const Scene& scene, const Point& point, Registry& registry) {
  for (const std::string& over : point.over) values.set_text(over);
  const std::string origin = "the study's point " + point.text();
  values.choose_formulation(point.formulation, origin);
  for (Change& change : changes_at(scene, point, registry)) values.set(change.path, std::move(change.value), origin);
  return values;
}

SceneValues with_more_modes(SceneValues values, const Scene& scene, int more, Registry& registry) {
  std::vector<Change> changes;
  change_all_modes(
      changes, scene, [more](int had) { return had + more; }, "", registry);
  for (Change& change : changes)
    values.set(change.path, std::move(change.value), fmt::format("{} more of each body's modes", more));
  return values;
}

}  // namespace withy::study
