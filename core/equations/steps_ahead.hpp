/// \file
/// Steps of several cases that have been made at once and are given one after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "withy/core/kinematics/lane_energies.hpp"
#include "withy/core/plugin/staged_steps.hpp"
#include "withy/core/spatial/lanes.hpp"

namespace withy::equations {

/// What has been made of the steps that each lane has asked for and of those that follow them.
class StepsAhead {
 public:
  static constexpr std::size_t most = 8;  ///< steps at once; of long states fewer, down to one

  /// \param size numbers of a state \param speeds of these
  StepsAhead(std::size_t size, std::size_t speeds)
      : size_(size),
        speeds_(speeds),
        at_once_(std::clamp<std::size_t>(in_cache / size, 1, most)),
        y_(at_once_ * size, Lanes(0)),
        slopes_(at_once_ * size, Lanes(0)),
        efforts_(at_once_ * speeds, Lanes(0)) {}

  /// What was made ahead is not asked for: the lane's next step begins anew.
  void drop(std::size_t lane) { lanes_[lane].made = lanes_[lane].given = 0; }
  /// Another case comes into the lane.
  void forget(std::size_t lane) { lanes_[lane] = {}; }

  /// A lane asks for a step. \param alone those that follow cannot be made before they are asked for
  void begin(std::size_t lane, const StagedSteps::Step& step, bool alone) {
    OfLane& of = lanes_[lane];
    of.table = step.table;
    latest_.set(lane, step.latest);
    begin_[0].set(lane, step.t);
    length_[0].set(lane, step.h);
    of.wanted = alone || wants_slopes(step) ? 1 : std::clamp<std::size_t>(step.ends.size(), 1, at_once_);
    for (std::size_t k = 1; k < of.wanted; ++k) {
      begin_[k].set(lane, step.ends[k - 1]);
      length_[k].set(lane, step.ends[k] - step.ends[k - 1]);
    }
    of.made = of.given = 0;
    of.energies_expected = of.wanted > 1 ? of.energies_asked : 0;
    of.energies_asked = of.energies_known = 0;
  }
  /// Of step k, each lane its own [s]; of lanes that want none, of no meaning.
  [[nodiscard]] const Lanes& start(std::size_t k) const { return begin_[k]; }
  [[nodiscard]] const Lanes& length(std::size_t k) const { return length_[k]; }
  [[nodiscard]] const Lanes& latest() const { return latest_; }
  /// Those of some lanes that want a step k.
  [[nodiscard]] LaneSet wanting(std::size_t k, LaneSet of) const {
    return of & lanes_where([k](const OfLane& lane) { return lane.wanted > k; });
  }

  // What is made of step k: the state and slope at its end, efforts there.
  Lanes* y(std::size_t k) { return y_.data() + k * size_; }
  Lanes* slope(std::size_t k) { return slopes_.data() + k * size_; }
  Lanes* efforts(std::size_t k) { return efforts_.data() + k * speeds_; }
  void made(std::size_t lane, std::size_t k, const StagedSteps::Outcome& outcome) {
    lanes_[lane].outcomes[k] = outcome;
    lanes_[lane].made = k + 1;
  }

  /// Whether a lane has asked for energies after such a step the last time.
  [[nodiscard]] bool expects_energies(std::size_t k) const {
    return !none(lanes_where([k](const OfLane& of) { return of.wanted > k && has(of.energies_expected, k); }));
  }
  /// Takes the energies after step k of a lane.
  Energies& energies(std::size_t lane, std::size_t k) {
    lanes_[lane].energies_known |= 1U << k;
    return lanes_[lane].energies[k];
  }

  /// Gives a lane its next step. \param efforts of its case, in its work memory
  void give(std::size_t lane, const StagedSteps::Step& step, std::span<double> efforts, StagedSteps::Outcome& outcome) {
    OfLane& of = lanes_[lane];
    const std::size_t k = of.given++;
    outcome = of.outcomes[k];
    if (!outcome.evaluation.ok()) return;
    extract(y(k), lane, step.end);
    extract(slope(k), lane, step.slopes[step.table->stages - 2]);
    extract(this->efforts(k), lane, efforts);
  }
  /// Whether the next step that has been made for a lane is this one.
  [[nodiscard]] bool has_next(std::size_t lane, const StagedSteps::Step& step) const {
    const OfLane& of = lanes_[lane];
    return step.follows && of.given < of.made && of.table == step.table && latest_[lane] == step.latest &&
           begin_[of.given][lane] == step.t && length_[of.given][lane] == step.h && !wants_slopes(step);
  }
  /// The energies of a state, where it is that at the end of the step given last and they are known.
  bool find(std::size_t lane, LaneEnergy& call) {
    OfLane& of = lanes_[lane];
    if (of.given == 0) return false;
    const std::size_t k = of.given - 1;
    of.energies_asked |= 1U << k;
    if (!has(of.energies_known, k)) return false;
    const Lanes* const own = y(k);
    for (std::size_t i = 0; i < call.y.size(); ++i)
      if (call.y[i] != own[i][lane]) return false;
    call.energies = of.energies[k];
    return true;
  }

  /// Whether the slopes between the first and the last are wanted.
  [[nodiscard]] static bool wants_slopes(const StagedSteps::Step& step) {
    return std::any_of(step.slopes.begin(), step.slopes.end() - 1, [](std::span<double> s) { return !s.empty(); });
  }

 private:
  struct OfLane {
    const StageTable* table = nullptr;
    std::size_t wanted = 0, made = 0, given = 0;
    std::array<StagedSteps::Outcome, most> outcomes;
    std::array<Energies, most> energies;
    // A bit for each step: after which energies were asked for, were the last time, and are known.
    unsigned energies_asked = 0, energies_expected = 0, energies_known = 0;
  };
  static bool has(unsigned bits, std::size_t k) { return (bits >> k & 1U) != 0; }
  template <class Holds>
  [[nodiscard]] LaneSet lanes_where(const Holds& holds) const {
    LaneSet set;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) set.bits |= holds(lanes_[lane]) ? 1U << lane : 0U;
    return set;
  }
  static void extract(const Lanes* from, std::size_t lane, std::span<double> to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i][lane];
  }

  static constexpr std::size_t in_cache = 1 << 12;  ///< numbers of a case that the nearer caches hold with all lanes'
  std::size_t size_, speeds_, at_once_;
  std::vector<Lanes> y_, slopes_, efforts_;  ///< of each step in turn
  Lanes latest_ = 0;
  std::array<Lanes, most> begin_{}, length_{};  ///< [s] of each step
  std::array<OfLane, cases_at_once> lanes_;
};

}  // namespace withy::equations
