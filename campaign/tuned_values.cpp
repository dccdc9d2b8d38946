#include "withy/campaign/tuned_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "withy/scene/names.hpp"
#include "withy/scene/units.hpp"
#include "withy/scene/value_path.hpp"

namespace withy::campaign {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// "/bodies/hub/mass" of "bodies.hub.mass".
std::string place_path(std::string path) {
  std::replace(path.begin(), path.end(), '.', '/');
  return '/' + path;
}

/// What the scene has against a value at a path: its own message; nothing where it takes it.
std::optional<std::string> objection(SceneValues values, const std::string& path, Value value, Registry& registry) {
  values.set(path, std::move(value), "--parameters " + path);
  try {
    static_cast<void>(make_scene(values, registry));
  } catch (const SceneError& e) {
    for (const Diagnostic& d : e.problems())
      if (d.place.path == place_path(path)) return d.message;
    return e.problems().front().message;
  }
  return {};
}

/// The SI unit of a number of the scene: the reader says that it needs "finite > 0 [N m^2]" there.
std::string unit_wanted(const SceneValues& values, const std::string& path, Registry& registry) {
  const std::string message = objection(values, path, Value(true), registry).value_or("");
  const std::size_t need = message.find("; need ");
  const std::size_t open = message.find('[', std::min(need, message.size())), close = message.find(']', open);
  return close == std::string::npos ? "" : message.substr(open + 1, close - open - 1);
}

/// "25 mm": the number and what stands behind it.
struct WrittenQuantity {
  double number = 0;
  std::string unit;
  explicit WrittenQuantity(const std::string& text) {
    const char* const end = text.data() + text.size();
    const char* const unit_begin = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), end, number).ptr;
    const std::size_t first = text.find_first_not_of(' ', static_cast<std::size_t>(unit_begin - text.data()));
    if (first != std::string::npos) unit = text.substr(first);
  }
};

/// A bound in the unit of the value it bounds.
std::optional<double> bound(const std::string& text, const TunedValue& tuned, std::vector<std::string>& problems) {
  const std::string unit = tuned.unit.empty() ? "1" : tuned.unit;
  const auto bare = plain_number(text);
  const QuantityReading reading = bare ? QuantityReading{*bare, {}} : read_quantity(text, unit);
  if (!reading.value) {
    problems.push_back(fmt::format("--parameters {}: bound {}: {}", tuned.path, in_quotes(text),
                                   reading.problem.empty() ? "need a number" : reading.problem));
    return {};
  }
  const UnitReading own = read_unit(unit);
  return *reading.value / (own.unit ? own.unit->to_si(1) : 1);
}

class TunedReader {
 public:
  TunedReader(const study::Prepared& scene, Registry& registry, std::vector<std::string>& problems)
      : scene_(scene), registry_(registry), problems_(problems) {}

  std::optional<TunedValue> read(const std::string& text) {
    const std::size_t equals = text.find('=');
    TunedValue tuned;
    tuned.path = text.substr(0, equals);
    if (!read_start(tuned)) return {};
    const std::size_t before = problems_.size();
    tuned.least = -unlimited, tuned.most = unlimited;
    if (equals != std::string::npos) read_bounds(text.substr(equals + 1), tuned);
    if (problems_.size() > before) return {};
    choose_coordinate(tuned);
    return tuned;
  }

 private:
  bool problem(const TunedValue& tuned, const std::string& message) {
    problems_.push_back(fmt::format("--parameters {}: {}", tuned.path, message));
    return false;
  }

  bool read_start(TunedValue& tuned) {
    const Value* written = scene_.values.find(tuned.path);
    const Value* checked = value_at(scene_.scene.source, tuned.path);  // defaults among them
    const Value* given = written != nullptr ? written : checked;
    if (given == nullptr)
      return problem(tuned, objection(scene_.values, tuned.path, Value(1.0), registry_)
                                .value_or("the scene has no value there to start from"));
    if (given->kind() == Value::Kind::text && looks_like_number(given->text())) {
      const WrittenQuantity quantity(given->text());
      if (!read_any_quantity(given->text()).value) return problem(tuned, "is no number");
      tuned.unit = quantity.unit;
      tuned.start = quantity.number;
      tuned.written = true;
    } else if (given->kind() == Value::Kind::number) {
      tuned.start = given->number();
      tuned.unit = unit_wanted(scene_.values, tuned.path, registry_);
    } else {
      return problem(tuned, "is no number of the scene; need one, or one element of a list, as gravity.2");
    }
    const double other = tuned.start == 0 ? 1e-3 : tuned.start * (1 + 1e-3);
    const auto against = objection(scene_.values, tuned.path, value_of(tuned, other), registry_);
    const auto lower = objection(scene_.values, tuned.path, value_of(tuned, 2 * tuned.start - other), registry_);
    if (against && lower) return problem(tuned, "cannot be varied: " + *against);
    return true;
  }

  void read_bounds(const std::string& range, TunedValue& tuned) {
    const std::size_t dots = range.find("..");
    if (dots == std::string::npos) {
      problem(tuned, fmt::format("got {}; need bounds as 2..3, 2.. or ..3", in_quotes(range)));
      return;
    }
    const std::size_t before = problems_.size();
    if (dots > 0) tuned.least = bound(range.substr(0, dots), tuned, problems_).value_or(-unlimited);
    if (dots + 2 < range.size()) tuned.most = bound(range.substr(dots + 2), tuned, problems_).value_or(unlimited);
    if (problems_.size() > before) return;
    if (!(tuned.least < tuned.most)) {
      problem(tuned, fmt::format("got bounds {:g} and {:g}; the first has to be less", tuned.least, tuned.most));
    } else if (tuned.start < tuned.least || tuned.start > tuned.most) {
      problem(tuned, fmt::format("the scene's {:g}{}{} lies outside of the bounds {:g} and {:g}", tuned.start,
                                 tuned.unit.empty() ? "" : " ", tuned.unit, tuned.least, tuned.most));
    }
  }

  void choose_coordinate(TunedValue& tuned) {
    const bool other_sign = tuned.start == 0 || (tuned.least < 0 && tuned.most > 0 && std::isfinite(tuned.least)) ||
                            !objection(scene_.values, tuned.path, value_of(tuned, -tuned.start), registry_);
    tuned.logarithmic = !other_sign;
    if (tuned.start != 0)
      tuned.scale = std::abs(tuned.start);
    else if (std::isfinite(tuned.least) && std::isfinite(tuned.most))
      tuned.scale = (tuned.most - tuned.least) / 2;
    if (tuned.logarithmic) {
      if (tuned.start > 0 ? tuned.least <= 0 : tuned.most >= 0)
        (tuned.start > 0 ? tuned.least : tuned.most) = tuned.start > 0 ? -unlimited : unlimited;
    }
    const double a = std::isfinite(tuned.least) ? tuned.coordinate(tuned.least) : -unlimited;
    const double b = std::isfinite(tuned.most) ? tuned.coordinate(tuned.most) : unlimited;
    tuned.lower = a, tuned.upper = b;
    if (tuned.logarithmic && tuned.start < 0)  // z grows with the size
      tuned.lower = std::isfinite(b) ? b : -unlimited, tuned.upper = std::isfinite(a) ? a : unlimited;
  }

  static Value value_of(const TunedValue& tuned, double x) {
    return tuned.written ? Value(fmt::format("{} {}", x, tuned.unit)) : Value(x);
  }

  const study::Prepared& scene_;
  Registry& registry_;
  std::vector<std::string>& problems_;
};

}  // namespace

double TunedValue::value(double z) const {
  const double x = logarithmic ? start * std::exp(z) : start + scale * z;
  return std::clamp(x, least, most);
}

double TunedValue::coordinate(double value) const {
  return logarithmic ? std::log(value / start) : (value - start) / scale;
}

double TunedValue::slope(double z) const { return logarithmic ? start * std::exp(z) : scale; }

std::vector<TunedValue> read_tuned(const std::vector<std::string>& texts, const study::Prepared& scene,
                                   Registry& registry, std::vector<std::string>& problems) {
  std::vector<TunedValue> all;
  TunedReader reader(scene, registry, problems);
  for (const std::string& text : texts) {
    std::optional<TunedValue> tuned = reader.read(text);
    if (!tuned) continue;
    if (std::any_of(all.begin(), all.end(), [&](const TunedValue& t) { return t.path == tuned->path; }))
      problems.push_back(fmt::format("--parameters {}: is there twice", tuned->path));
    all.push_back(std::move(*tuned));
  }
  return all;
}

SceneValues with_values(const SceneValues& scene, std::span<const TunedValue> tuned, std::span<const double> values) {
  SceneValues changed = scene;
  for (std::size_t i = 0; i < tuned.size(); ++i) {
    Value value = tuned[i].written ? Value(fmt::format("{} {}", values[i], tuned[i].unit)) : Value(values[i]);
    changed.set(tuned[i].path, std::move(value), "a fitted value");
  }
  return changed;
}

std::vector<study::Change> changes_of(const SceneValues& scene, std::span<const TunedValue> tuned,
                                      std::span<const double> values) {
  const SceneValues changed = with_values(scene, tuned, values);
  std::vector<study::Change> changes;
  for (const TunedValue& t : tuned) {
    std::string path = t.path;
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
      const Value* part = changed.find(path.substr(0, dot));
      if (part == nullptr || part->kind() != Value::Kind::list) continue;
      path.resize(dot);
      break;
    }
    const auto same = [&](const study::Change& c) { return c.path == path; };
    if (std::none_of(changes.begin(), changes.end(), same)) changes.push_back({path, *changed.find(path)});
  }
  return changes;
}

}  // namespace withy::campaign
