#include "withy/study/felt_states.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "withy/core/simulation/renewal.hpp"
#include "withy/study/load_efforts.hpp"
#include "withy/study/timed_loads.hpp"

namespace withy::study {
namespace {

/// Steps of one of a state: what has a dead zone is left by the longest, what is at a limit by the other way.
constexpr double short_step = 1e-3, long_step = 1e3;
/// Of the greatest change of an effort, on what is held too.
constexpr double rounded_effort = 1e-9;

/// A continuous state, or all that a sampled load holds.
struct FeltNode {
  std::size_t first = 0, count = 1;  ///< elements of State::y
  bool sampled = false;
  bool acts = false;          ///< on something free
  std::vector<bool> changes;  ///< nodes whose rates, or samples, it changes
};

/// What a state does at an instant.
struct FeltEffects {
  Eigen::VectorXd efforts;                ///< on all speeds
  std::vector<double> rates;              ///< of continuous states
  std::vector<std::vector<double>> held;  ///< after a sample, one a sampled load
};

class FeltGraph {
 public:
  explicit FeltGraph(const Configuration& c)
      : c_(c),
        slots_(sampled_slots(c.prepared().model())),
        free_(free_speeds(c.held())),
        work_(c.prepared().equations->make_work()),
        scratch_(c.prepared().model().load_scratch()),
        at_rest_(c.layout().speeds) {
    if (!slots_.empty()) renewal_.emplace(c.prepared().model(), *c.prepared().equations);
    const Layout& layout = c.layout();
    for (std::size_t i = layout.positions + layout.speeds; i < layout.moving(); ++i)
      nodes_.push_back({i, 1, false, false, {}});
    for (const LoadSlot& slot : slots_) nodes_.push_back({slot.first, slot.count, true, false, {}});
    for (FeltNode& node : nodes_) node.changes.assign(nodes_.size(), false);
  }

  /// Adds what is felt about a state.
  void meet(const State& base) {
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const FeltEffects before = effects(base, n);
      for (const double step : {1.0, short_step, long_step}) {
        if (nodes_[n].sampled && step > 1) continue;  // a law may count samples in what it holds
        for (const double way : {step, -step}) compare(before, effects(displaced(base, nodes_[n], way), n), n);
      }
    }
  }

  [[nodiscard]] FeltStates felt() const {
    std::vector<bool> all;
    for (const FeltNode& node : nodes_) all.push_back(node.acts);
    for (bool more = true; more;) {
      more = false;
      for (std::size_t n = 0; n < nodes_.size(); ++n)
        for (std::size_t by = 0; by < nodes_.size() && !all[n]; ++by)
          if (all[by] && nodes_[n].changes[by]) all[n] = more = true;
    }
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(c_.layout().continuous);
    return {{all.begin(), middle}, {middle, all.end()}};
  }

 private:
  /// No two of what a load holds alike, lest they make up for each other.
  static State displaced(State state, const FeltNode& node, double steps) {
    for (std::size_t i = node.first; i < node.first + node.count; ++i)
      state.y[i] += steps * (1 + std::cos(static_cast<double>(i)) / 2) * std::max(1.0, std::abs(state.y[i]));
    return state;
  }

  /// \param of node: were it renewed too, the others would be given its new numbers
  FeltEffects effects(const State& state, std::size_t of) {
    const Model& model = c_.prepared().model();
    FeltEffects now{c_.dynamics().on_motions(state.y, load_efforts(*c_.prepared().equations, state.time, state,
                                                                   EquationsOfMotion::all_loads, work_)),
                    {},
                    {}};
    now.rates.resize(c_.layout().continuous);
    for (const LoadNode& node : model.loads()) {
      if (node.continuous == nullptr) continue;
      LoadView view = node.view(state.time, state.y, c_.layout(), scratch_);
      view.accelerations = at_rest_;
      const LoadSlot& own = node.continuous_slot;
      node.continuous->rates(
          view, std::span(now.rates).subspan(own.first - c_.layout().positions - c_.layout().speeds, own.count));
    }
    if (!renewal_) return now;
    State after = state;
    renewal_->at(state);
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      if (c_.layout().continuous + k != of) (*renewal_)(after, slots_[k], {});
      const auto first = after.y.begin() + static_cast<std::ptrdiff_t>(slots_[k].first);
      now.held.emplace_back(first, first + static_cast<std::ptrdiff_t>(slots_[k].count));
    }
    return now;
  }

  void compare(const FeltEffects& before, const FeltEffects& after, std::size_t n) {
    const Eigen::VectorXd by = (after.efforts - before.efforts).cwiseAbs();
    const double most = by.size() > 0 ? by.maxCoeff() : 0.0;
    for (const Eigen::Index s : free_) nodes_[n].acts = nodes_[n].acts || by[s] > rounded_effort * most;
    // What has no part in a number leaves its bits; one that is not finite tells nothing, and counts as felt.
    for (std::size_t i = 0; i < after.rates.size(); ++i)
      if (i != n && !(after.rates[i] == before.rates[i])) nodes_[n].changes[i] = true;
    const std::size_t first = after.rates.size();
    for (std::size_t k = 0; k < after.held.size(); ++k)
      if (first + k != n && after.held[k] != before.held[k]) nodes_[n].changes[first + k] = true;
  }

  const Configuration& c_;
  std::vector<LoadSlot> slots_;
  std::vector<Eigen::Index> free_;
  Work work_;
  std::vector<double> scratch_, at_rest_;
  std::optional<Renewal> renewal_;
  std::vector<FeltNode> nodes_;  ///< continuous states, then sampled loads
};

}  // namespace

FeltStates felt_states(const Configuration& c, const State& state, const Turning& turning) {
  constexpr std::size_t seldom = 12;
  FeltGraph graph(c);
  graph.meet(displaced_anyhow(c, state));
  const std::vector<double> times = times_after(c, state);
  for (std::size_t k = 0; k < times.size(); k += seldom) {
    State there = carried(c.prepared().model(), turning, state, times[k]);
    there.time = state.time + times[k];
    graph.meet(displaced_anyhow(c, std::move(there)));
  }
  return graph.felt();
}

}  // namespace withy::study
