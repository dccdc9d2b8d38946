/// \file
/// Efforts of cases in lanes that are functions of time alone, and the power of their damping.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
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

/// What has been found of a law that several cases have, at increasing times. With equal steps each case goes through
/// the times of the one before it.
class KnownEfforts {
 public:
  explicit KnownEfforts(std::shared_ptr<const void> law) : law_(std::move(law)) {
    times_.reserve(most), values_.reserve(most);
  }
  /// Held, so that no other law takes its place in memory.
  [[nodiscard]] const std::shared_ptr<const void>& law() const { return law_; }
  /// The effort at t, and goes behind it; `find()` gives one that is not known. A case whose times are others leaves:
  /// `next` is `gone` then.
  template <class Find>
  double at(double t, std::size_t& next, const Find& find) {
    if (next < times_.size() && times_[next] == t) return values_[next++];
    const double value = find();
    if (next == gone) return value;
    const auto of_t = std::lower_bound(times_.begin(), times_.end(), t);
    next = static_cast<std::size_t>(of_t - times_.begin()) + 1;
    if (of_t != times_.end()) {
      if (*of_t != t) next = gone;
    } else if (times_.size() < most) {
      times_.push_back(t);
      values_.push_back(value);
    } else {
      next = gone;
    }
    return value;
  }
  static constexpr std::size_t gone = std::numeric_limits<std::size_t>::max();

 private:
  static constexpr std::size_t most = 1 << 14;  ///< a quarter of a megabyte, of which only what is used becomes memory
  std::shared_ptr<const void> law_;
  std::vector<double> times_, values_;
};

/// Efforts that are functions of time alone, by lanes: found once for all lanes with one law that ask for one time, and
/// not again where a lane asks for its last time again, as the stages of a Runge–Kutta step do, or where an earlier
/// case asked for the same times. The number is that of the law whoever finds it.
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
    for (const TimedLoad& load : loads) own.laws.emplace_back(load.speed, load.law.get());
    std::erase_if(known_, [](const auto& known) { return known->law().use_count() == 1; });
    own.known.clear();
    for (const TimedLoad& load : loads) own.known.push_back(load.effort != nullptr ? known(load.law, own) : nullptr);
    own.next.assign(loads.size(), 0);
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
      const void* const law = load.law.get();
      const auto find = [&] {
        const double* const value = elsewhere(law, t, lane, times.live);
        return value != nullptr ? *value : load.effort->effort(t);
      };
      own.values[i] = own.known[i] != nullptr ? own.known[i]->at(t, own.next[i], find) : find();
      own.found[i] = {t, law};
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
    std::vector<KnownEfforts*> known;                       ///< of each load; null: nobody else has its law
    std::vector<std::size_t> next;                          ///< in those
    std::vector<std::pair<std::size_t, const void*>> laws;  ///< with their speeds
    std::size_t kind = 0;                                   ///< the same for lanes with the same laws
    LaneSet alike;                                          ///< those
    bool any = false;
  };
  /// What is known of a law, if a case before this or in another lane has it as well; else null.
  KnownEfforts* known(const std::shared_ptr<const void>& law, const OfLane& own) {
    const auto same = [&](const auto& known) { return known->law() == law; };
    if (const auto at = std::find_if(known_.begin(), known_.end(), same); at != known_.end()) return at->get();
    const auto has = [&](const OfLane& of) {
      return &of != &own &&
             std::any_of(of.laws.begin(), of.laws.end(), [&](const auto& l) { return l.second == law.get(); });
    };
    if (std::none_of(of_.begin(), of_.end(), has)) return nullptr;
    return known_.emplace_back(std::make_unique<KnownEfforts>(law)).get();
  }
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
  std::vector<std::unique_ptr<KnownEfforts>> known_;
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
