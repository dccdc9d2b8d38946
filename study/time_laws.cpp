#include "withy/study/time_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "withy/core/plugin/sampled_part.hpp"
#include "withy/scene/control_order.hpp"
#include "withy/scene/names.hpp"
#include "withy/study/timed_loads.hpp"

namespace withy::study {
namespace {

const std::vector<Value::Member>& members_of(const Value& source, const char* key) {
  static const std::vector<Value::Member> none;
  const Value* given = source.find(key);
  return given != nullptr ? given->members() : none;
}

/// Whether a part of a scene names one of these loads; the name of a hinge may be that of a load too.
bool names_load(const Value& part, const std::set<std::string>& loads) {
  return std::any_of(part.members().begin(), part.members().end(), [&](const Value::Member& m) {
    return m.first != "hinge" && m.first != "type" && mentions(m.second, loads);
  });
}

/// Loads by what they measure, and whether time changes what they give others.
class TimeLaws {
 public:
  TimeLaws(const Configuration& c, const State& state, const Turning& turning)
      : c_(c),
        start_(state.time),
        scratch_(c.prepared().model().load_scratch()),
        at_rest_(c.layout().speeds),
        places_{displaced_anyhow(c, state)} {
    for (const double after : times_after(c, state)) {
      places_.push_back(displaced_anyhow(c, carried(c.prepared().model(), turning, state, after)));
      places_.back().time = state.time + after;
    }
    for (const auto& [name, load] : members_of(c.prepared().scene.source, "loads")) all_.insert(name);
  }

  /// Adds those that give a load the time; itself where none does. \param changing loads that are known to change
  void add_sources(const std::string& load, const std::set<std::string>& changing, std::vector<std::string>& found) {
    if (!met_.insert(load).second) return;
    bool given = false;
    for (const std::string& other : measured_by(load)) {
      // What a sampled load gives is held, and changes with its samples.
      if (!gives_by_time(other) && !(changing.contains(other) && sampled(other))) continue;
      given = true;
      add_sources(other, changing, found);
    }
    if (!given) found.push_back(load);
  }

 private:
  [[nodiscard]] const LoadNode* node_of(const std::string& name) const {
    for (const LoadNode& node : c_.prepared().model().loads())
      if (node.name == name) return &node;
    return nullptr;
  }
  [[nodiscard]] bool sampled(const std::string& name) const {
    const LoadNode* node = node_of(name);
    return node != nullptr && dynamic_cast<const SampledPart*>(node->load->discrete()) != nullptr;
  }
  /// Loads of which it measures a number, or an output that shows one.
  [[nodiscard]] std::set<std::string> measured_by(const std::string& name) const {
    const Value& source = c_.prepared().scene.source;
    const Value* loads = source.find("loads");
    const Value* load = loads != nullptr ? loads->find(name) : nullptr;
    if (load == nullptr) return {};
    Value measuring = *load;
    std::erase_if(measuring.members(), [](const Value::Member& m) { return m.first == "to"; });
    std::set<std::string> found = needed_loads(measuring, all_, &c_.prepared().model());
    for (const auto& [output, shown] : members_of(source, "outputs")) {
      if (!names_load(measuring, {output})) continue;
      for (const std::string& other : all_)
        if (other != name && names_load(shown, {other})) found.insert(other);
    }
    return found;
  }
  [[nodiscard]] std::vector<double> given_at(const LoadNode& node, double t, const State& place) {
    std::vector<double> values(node.load->output()->outputs());
    LoadView view = node.view(t, place.y, c_.layout(), scratch_);
    view.accelerations = at_rest_;
    node.load->output()->read(view, values);
    return values;
  }
  /// Whether time alone changes a number that a load gives, with all states where they are.
  bool gives_by_time(const std::string& name) {
    constexpr double rounding = 1e-9;
    const auto known = given_.find(name);
    if (known != given_.end()) return known->second;
    const LoadNode* node = node_of(name);
    double most = 0, change = 0;
    for (std::size_t k = 1; node != nullptr && node->load->output() != nullptr && k < places_.size(); ++k) {
      const std::vector<double> now = given_at(*node, start_, places_[k]),
                                then = given_at(*node, places_[k].time, places_[k]);
      for (std::size_t i = 0; i < now.size(); ++i) {
        most = std::max({most, std::abs(now[i]), std::abs(then[i])});
        change = std::max(change, std::abs(then[i] - now[i]));
      }
    }
    return given_[name] = change > rounding * most;
  }

  const Configuration& c_;
  double start_;  ///< [s]
  std::vector<double> scratch_, at_rest_;
  std::vector<State> places_;
  std::set<std::string> all_, met_;
  std::map<std::string, bool> given_;
};

}  // namespace

std::vector<std::string> with_the_time(const Configuration& c, const State& state, const Turning& turning,
                                       const std::vector<std::string>& loads) {
  if (loads.empty()) return {};
  TimeLaws laws(c, state, turning);
  const std::set<std::string> changing(loads.begin(), loads.end());
  std::vector<std::string> found;
  for (const std::string& load : loads) laws.add_sources(load, changing, found);
  return found;
}

std::vector<std::string> taken_away_with(const Scene& scene, const std::vector<std::string>& loads) {
  const std::vector<Value::Member>& given = members_of(scene.source, "loads");
  std::set<std::string> all, away(loads.begin(), loads.end());
  for (const auto& [name, load] : given) all.insert(name);
  for (bool more = true; more;) {
    more = false;
    for (const auto& [name, load] : given) {
      if (away.contains(name)) continue;
      const std::set<std::string> needs = needed_loads(load, all, scene.model.get());
      more = std::any_of(needs.begin(), needs.end(), [&](const std::string& need) { return away.contains(need); });
      if (more) away.insert(name);
      if (more) break;
    }
  }
  for (const char* key : {"outputs", "events", "motions"})
    for (const auto& [name, part] : members_of(scene.source, key))
      if (names_load(part, away)) return {};
  if (const Value* initial = scene.source.find("initial"))
    for (const char* key : {"loads", "inputs", "held", "settings"})
      for (const auto& [name, part] : members_of(*initial, key))
        if (away.contains(name) || mentions(part, away)) return {};
  std::vector<std::string> ordered;
  for (const auto& [name, load] : given)
    if (away.contains(name)) ordered.push_back(name);
  return ordered;
}

std::string set_to_null(const std::vector<std::string>& loads) {
  return fmt::format("--set loads.{}=null", fmt::join(loads, "=null --set loads."));
}

}  // namespace withy::study
