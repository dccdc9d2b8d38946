#include "withy/apps/withy/trade_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace withy::app {
namespace {

/// In the order of a beam's coordinates.
constexpr std::array<const char*, 6> strains = {"bending_y", "bending_z", "torsion", "extension", "shear_y", "shear_z"};

/// Modes that a beam of the scene has in a strain; 0 where it has none.
int modes_of(const Value& beam, const char* strain) {
  const Value* s = beam.find(strain);
  const Value* modes = s != nullptr ? s->find("modes") : nullptr;
  return modes != nullptr ? static_cast<int>(modes->number()) : 0;
}

/// What an initial state says of a body's modal coordinates or rates, for another number of modes.
/// \param had modes of each strain up to now, in the order of the values.
std::string resized(const std::vector<double>& values, const std::vector<int>& had, int modes) {
  std::string text = "[";
  std::size_t first = 0;
  for (const int n : had) {
    for (int i = 0; n > 0 && i < modes; ++i) {
      const double v = i < n ? values.at(first + static_cast<std::size_t>(i)) : 0;
      text += fmt::format("{}{}", text.size() > 1 ? ", " : "", v);
    }
    first += static_cast<std::size_t>(n);
  }
  return text + "]";
}

}  // namespace

std::string TradePoint::key() const {
  std::string key =
      fmt::format("{}_{}_{}_{}_{:g}", formulation, modes, family.empty() ? "scene" : family, integrator, tolerance);
  for (const std::string& o : over) key += '_' + o;
  for (const auto& [body, own] : bodies) key += '_' + body + '=' + own;
  for (char& c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && std::string("._=+-").find(c) == std::string::npos) c = '~';
  }
  return key;
}

std::string TradePoint::formulation_text() const {
  std::string text = formulation;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    text += (i == 0 ? " (" : ", ") + bodies[i].first;
    if (i + 1 == bodies.size() || bodies[i + 1].second != bodies[i].second) text += ": " + bodies[i].second;
  }
  return bodies.empty() ? text : text + ')';
}

std::string TradePoint::text() const {
  std::string text = fmt::format("{}, {} mode{}{}, {} at {:g}", formulation_text(), modes, modes == 1 ? "" : "s",
                                 family.empty() ? "" : ' ' + family, integrator, tolerance);
  for (const std::string& o : over) text += ", " + o;
  return text;
}

std::vector<TradePoint> trade_points(const TradeAxes& axes) {
  std::vector<std::vector<std::string>> overs{{}};
  for (const std::string& text : axes.over) {
    const Variation v = parse_variation(text);
    std::vector<std::vector<std::string>> longer;
    for (const auto& before : overs) {
      for (const std::string& value : v.values) {
        longer.push_back(before);
        longer.back().push_back(v.path + '=' + value);
      }
    }
    overs = std::move(longer);
  }
  for (const int m : axes.modes)
    if (m < 1 || m > 200) throw InputError(fmt::format("--modes: got {}; need 1 to 200", m));
  for (const double t : axes.tolerances)
    if (!(t > 0 && t <= 1)) throw InputError(fmt::format("--tolerances: got {:g}; need above 0, at most 1", t));
  for (const std::string& f : axes.formulations)
    if (f == "auto") throw InputError("--formulations: 'auto' is a choice along a run, not a model; leave it out");
  std::vector<TradePoint> points;
  for (const auto& over : overs) {
    for (const std::string& formulation : axes.formulations) {
      for (const std::string& family : axes.families) {
        for (const int modes : axes.modes) {
          for (const std::string& integrator : axes.integrators) {
            for (const double tolerance : axes.tolerances)
              points.push_back({formulation, family, modes, integrator, tolerance, over});
          }
        }
      }
    }
  }
  return points;
}

SceneArguments arguments_at(const SceneArguments& base, const Scene& scene, const TradePoint& point) {
  SceneArguments a = base;
  std::vector<std::string>& overrides = a.options.overrides;
  overrides.insert(overrides.end(), point.over.begin(), point.over.end());
  overrides.push_back(fmt::format("integrator={{name: {}, rtol: {:g}, atol: {:g}}}", point.integrator, point.tolerance,
                                  1e-2 * point.tolerance));
  a.options.integrator.clear();
  a.options.formulation = point.formulation;
  if (point.modes == 0) return a;  // those of the scene
  const Value* bodies = scene.source.find("bodies");
  const Value* initial = scene.source.find("initial");
  const Value* starts = initial != nullptr ? initial->find("bodies") : nullptr;
  for (const auto& [name, body] : bodies->members()) {
    const std::string type = body.text_at("type");
    const Slot* const slot = scene.model->layout().body(name);  // none of a beam in segments
    std::vector<int> had;
    if (type == "plate") {
      had = {static_cast<int>(slot->speeds)};
      overrides.push_back(fmt::format("bodies.{}.modes={}", name, point.modes));
    } else if (type == "beam") {
      for (const char* strain : strains) {
        had.push_back(modes_of(body, strain));
        if (had.back() == 0) continue;
        overrides.push_back(fmt::format("bodies.{}.{}.modes={}", name, strain, point.modes));
        if (!point.family.empty() && std::string_view(strain).starts_with("bending"))
          overrides.push_back(fmt::format("bodies.{}.{}.family={}", name, strain, point.family));
      }
    } else {
      continue;
    }
    // The initial states of segments have names of their own.
    const Value* start = starts != nullptr && slot != nullptr ? starts->find(name) : nullptr;
    if (start == nullptr) continue;
    const auto values = [&](std::size_t first) {
      const auto begin = scene.initial.y.begin() + static_cast<std::ptrdiff_t>(first);
      return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(slot->speeds));
    };
    if (start->has("modes"))
      overrides.push_back(
          fmt::format("initial.bodies.{}.modes={}", name, resized(values(slot->position), had, point.modes)));
    if (start->has("rates"))
      overrides.push_back(
          fmt::format("initial.bodies.{}.rates={}", name,
                      resized(values(scene.model->layout().positions + slot->speed), had, point.modes)));
  }
  return a;
}

}  // namespace withy::app
