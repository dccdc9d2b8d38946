/// \file
/// Efforts of cases in lanes that are functions of time alone, and the power of their damping.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <tuple>
#include <vector>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/equations/elastic_part.hpp"
#include "withy/core/spatial/lanes.hpp"

namespace withy::equations {

/// A time for each lane that takes part; of the others nobody knows whether their loads still are.
struct LaneTimes {
  Lanes t;  ///< [s]
  LaneSet live;
};

/// Efforts that are functions of time alone, by lanes: found once for all lanes with one law that ask for one time, and
/// not again where a lane asks for its last time again, as the stages of a Runge–Kutta step do. The number is that of
/// the law whoever finds it.
class TimedEfforts {
 public:
  /// Another case is in the lane.
  void put(std::size_t lane, const std::vector<TimedLoad>& loads) {
    OfLane& own = of_[lane];
    own.loads = &loads;
    own.found.assign(loads.size(), {std::numeric_limits<double>::quiet_NaN(), nullptr});
    own.values.resize(loads.size());
    own.any = std::any_of(loads.begin(), loads.end(), [](const TimedLoad& load) { return load.effort != nullptr; });
    own.laws.clear();
    for (const TimedLoad& load : loads) own.laws.emplace_back(load.speed, load.law);
    const auto same = std::find_if(of_.begin(), of_.end(), [&](const OfLane& other) {
      return &other != &own && other.loads != nullptr && other.laws == own.laws;
    });
    own.kind = same != of_.end() ? same->kind : ++last_kind_;
    for (OfLane& a : of_) {
      a.alike = {};
      for (std::size_t i = 0; i < cases_at_once; ++i) a.alike.bits |= of_[i].kind == a.kind ? 1U << i : 0U;
    }
  }
  /// One number a load of the lane's case, at its time; nothing where no load is timed.
  std::span<const double> at(std::size_t lane, const LaneTimes& times) noexcept {
    OfLane& own = of_[lane];
    if (!own.any) return {};
    const double t = times.t[lane];
    for (std::size_t i = 0; i < own.values.size(); ++i) {
      const TimedLoad& load = (*own.loads)[i];
      if (load.effort == nullptr || own.found[i].t == t) continue;
      const double* known = elsewhere(load.law, t, lane, times.live);
      own.values[i] = known != nullptr ? *known : load.effort->effort(t);
      own.found[i] = {t, load.law};
    }
    return own.values;
  }
  /// Adds those of lanes whose loads are timed, all of them. \param of the lanes of which this holds
  void add(const LaneTimes& times, LaneSet of, Lanes* efforts) noexcept {
    if (const std::size_t first = alike(times, of); first < cases_at_once) {
      const std::span<const double> values = at(first, times);
      for (std::size_t i = 0; i < values.size(); ++i) efforts[(*of_[first].loads)[i].speed] += values[i];
      return;
    }
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (!of.has(lane)) continue;
      const std::span<const double> values = at(lane, times);
      for (std::size_t i = 0; i < values.size(); ++i) {
        Lanes& effort = efforts[(*of_[lane].loads)[i].speed];
        effort.set(lane, effort[lane] + values[i]);
      }
    }
  }

 private:
  struct Found {
    double t;  ///< [s]; NaN: at none
    const void* law;
  };
  struct OfLane {
    const std::vector<TimedLoad>* loads = nullptr;
    std::vector<Found> found;
    std::vector<double> values;
    std::vector<std::pair<std::size_t, const void*>> laws;  ///< with their speeds
    std::size_t kind = 0;                                   ///< the same for lanes with the same laws
    LaneSet alike;                                          ///< those
    bool any = false;
  };
  /// The first lane of a set, where all of it have the same laws at the same time; else that behind the last.
  [[nodiscard]] std::size_t alike(const LaneTimes& times, LaneSet of) const noexcept {
    if (none(of)) return cases_at_once;
    const auto first = static_cast<std::size_t>(std::countr_zero(of.bits));
    const Lanes t = times.t[first];
    const LaneSet others{of.bits &
                         (~of_[first].alike.bits | (positive(times.t - t).bits | positive(t - times.t).bits))};
    return none(others) ? first : cases_at_once;
  }
  /// What a lane before has found; null: none has.
  [[nodiscard]] const double* elsewhere(const void* law, double t, std::size_t lane, LaneSet live) const noexcept {
    for (std::size_t other = 0; other < lane; ++other) {
      if (!live.has(other)) continue;
      const OfLane& of = of_[other];
      for (std::size_t i = 0; i < of.found.size(); ++i)
        if (of.found[i].law == law && of.found[i].t == t) return &of.values[i];
    }
    return nullptr;
  }

  std::array<OfLane, cases_at_once> of_;
  std::size_t last_kind_ = 0;
};

/// Damping of the cases in lanes. An element that a case lacks is zero, and its sum that of the others in their order.
class LaneDamping {
 public:
  /// Another case is in the lane.
  void put(std::size_t lane, const ElasticPart& part) {
    for (Element& e : elements_) e.value.set(lane, 0);
    for (const ElasticPart::Damper& d : part.dampers()) {
      const auto order = [](const Element& e, const ElasticPart::Damper& of) {
        return std::tie(e.i, e.j) < std::tie(of.i, of.j);
      };
      auto at = std::lower_bound(elements_.begin(), elements_.end(), d, order);
      if (at == elements_.end() || at->i != d.i || at->j != d.j) at = elements_.insert(at, {d.i, d.j, Lanes(0)});
      at->value.set(lane, d.value);
    }
  }
  /// As ElasticPart::damping_power.
  [[nodiscard]] Lanes power(const Lanes* speeds) const noexcept {
    Lanes power(0);
    for (const Element& e : elements_) power -= speeds[e.i] * e.value * speeds[e.j];
    return power;
  }

 private:
  struct Element {
    std::size_t i, j;
    Lanes value;
  };
  std::vector<Element> elements_;
};

}  // namespace withy::equations
