#include "withy/study/mode_basis.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/core/plugin/mode_family.hpp"
#include "withy/scene/value_path.hpp"

namespace withy::study {
namespace {

void set_below(Value& map, const std::string& path, const Value& value) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) {
    map.set(path, value);
    return;
  }
  const std::string key = path.substr(0, dot);
  Value inner = map.has(key) ? map.at(key) : Value::map({});
  set_below(inner, path.substr(dot + 1), value);
  map.set(key, std::move(inner));
}

const Plugin<Body>* plugin_of(const Value& body, Registry& registry) {
  return body.has("type") ? registry.find<Body>(body.text_at("type")) : nullptr;
}

/// Weighed fields Φ and lΨ at sections of a body, below each other.
Eigen::MatrixXd fields_along(const Body& body, double length, std::size_t sections) {
  const Eigen::Index n = body.shape().modes();
  Eigen::MatrixXd fields(static_cast<Eigen::Index>(6 * sections), n);
  const double pi = std::acos(-1.0);
  for (std::size_t k = 0; k < sections; ++k) {
    // Closer at the ends, where polynomials of high degree turn fastest.
    const double angle = pi * (static_cast<double>(k) + 0.5) / static_cast<double>(sections);
    const auto at = body.station(0.5 * length * (1 - std::cos(angle)));
    const double weight = std::sqrt(std::sin(angle));
    const auto row = static_cast<Eigen::Index>(6 * k);
    fields.middleRows(row, 3) = weight * at->phi;
    fields.middleRows(row + 3, 3) = weight * length * at->psi;
  }
  return fields;
}

/// Length of a body with stations along itself; 0 where it has none.
double length_along(const Body& body) {
  const auto tip = body.station("tip");
  if (!tip || !(tip->X.x() > 0) || !body.station(0.5 * tip->X.x())) return 0;
  return tip->X.x();
}

/// Whether a value is a table, or one below it is.
bool has_table(const Value& value) {
  if (value.kind() == Value::Kind::map)
    return std::any_of(value.members().begin(), value.members().end(),
                       [](const Value::Member& member) { return has_table(member.second); });
  return value.kind() == Value::Kind::list && !value.items().empty() &&
         value.items().front().kind() == Value::Kind::list;
}

}  // namespace

bool spans_cantilevers(const Value& family, Registry& registry) {
  Diagnostics diagnostics;
  const auto made = make_mode_family(family, {registry, diagnostics});
  return made != nullptr && made->spans_cantilevers();
}

std::string family_path(const Scene& scene, const std::string& body, const ModeCount& count, Registry& registry) {
  if (!count.family_path.empty() || count.strain.empty()) return count.family_path;
  const Value* value = value_at(scene.source, "bodies." + body);
  const Plugin<Body>* plugin = value != nullptr ? plugin_of(*value, registry) : nullptr;
  if (plugin == nullptr) return {};
  for (const ParameterSpec& strain : plugin->parameters) {
    if (strain.key != count.strain) continue;
    for (const ParameterSpec& spec : strain.members)
      if (spec.refers == ParameterSpec::Refers::mode_family) return count.strain + '.' + spec.key;
  }
  return {};
}

const Value* family_at(const Scene& scene, const std::string& body, const std::string& path) {
  return path.empty() ? nullptr : value_at(scene.source, "bodies." + body + '.' + path);
}

bool varies(const Scene& scene, const std::string& body) {
  const Value* given = value_at(scene.source, "bodies." + body);
  return given != nullptr && has_table(*given);
}

std::shared_ptr<const Body> body_with(const Scene& scene, const std::string& body,
                                      const std::vector<std::pair<std::string, Value>>& values, Registry& registry) {
  const Value* given = value_at(scene.source, "bodies." + body);
  const Plugin<Body>* plugin = given != nullptr ? plugin_of(*given, registry) : nullptr;
  if (plugin == nullptr) return nullptr;
  Value changed = *given;
  for (const auto& [path, value] : values) set_below(changed, path, value);
  Diagnostics diagnostics;
  return plugin->make(changed, {registry, diagnostics, scene.folder_now()});
}

std::optional<std::vector<double>> same_shape(const Body& from, std::span<const double> q, const Body& to) {
  const double length = length_along(from);
  if (!(length > 0) || !(length_along(to) > 0)) return {};
  const auto n = static_cast<std::size_t>(std::max(from.shape().modes(), to.shape().modes()));
  const std::size_t sections = 16 + 8 * n;
  const Eigen::Map<const Eigen::VectorXd> given(q.data(), static_cast<Eigen::Index>(q.size()));
  const Eigen::VectorXd wanted = fields_along(from, length, sections) * given;
  const Eigen::VectorXd found = fields_along(to, length, sections).colPivHouseholderQr().solve(wanted);
  return std::vector<double>(found.begin(), found.end());
}

std::string notably_faster_strains(const Scene& scene, const BodyModes& modes, const Body& body,
                                   const OtherFamily& other, Registry& registry) {
  constexpr double notably_faster = 0.015;  // of a frequency: less is hardly worth a word
  std::string text;
  Eigen::Index from = 0;
  for (const ModeCount& count : modes.counts) {
    const auto n = static_cast<Eigen::Index>(count.modes), first = std::exchange(from, from + n);
    if (n == 0 || count.family_path.empty() || count.family_id() == other.family || !other.compared(count)) continue;
    const auto with_other = body_with(scene, modes.body, {{count.family_path, Value(other.family)}}, registry);
    if (with_other == nullptr || with_other->shape().modes() != body.shape().modes()) continue;
    const double has = other.first_hertz(body, first, n), could = other.first_hertz(*with_other, first, n);
    if (!(has > (1 + notably_faster) * could)) continue;
    text += fmt::format("{}{} {} modes of {} vibrate first at {:.4g} Hz, as many of {} at {:.4g} Hz",
                        text.empty() ? "" : "; ", n, count.strain, count.family_id(), has, other.family, could);
  }
  return text;
}

}  // namespace withy::study
