#include "withy/study/timed_loads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/study/load_efforts.hpp"

namespace withy::study {
namespace {

/// Where everything is some time after the state, with what turns carried on.
struct Instant {
  double time = 0;  ///< [s]
  State here, displaced;
};

std::vector<Instant> instants_after(const Configuration& c, const State& state, const Turning& turning,
                                    const std::vector<double>& times) {
  std::vector<Instant> instants{{state.time, state, displaced_anyhow(c, state)}};
  for (const double after : times) {
    State there = carried(c.prepared().model(), turning, state, after);
    State displaced = displaced_anyhow(c, there);
    instants.push_back({state.time + after, std::move(there), std::move(displaced)});
  }
  return instants;
}

/// Efforts of a load [N m, N] at a state and with everything displaced.
struct PushOfLoad {
  Eigen::VectorXd here, displaced;
};

/// What time itself changes of a load's efforts on what is free.
struct ChangeOfLoad {
  bool pushes = false;  ///< at the state
  std::vector<std::size_t>
      shaken;  ///< instants at which a displacement makes another effort, the greatest change first
};

/// Pushes of loads at instants after a state.
class Pushes {
 public:
  Pushes(const Configuration& c, const std::vector<Instant>& instants)
      : c_(c), instants_(instants), free_(free_speeds(c.held())), work_(c.prepared().equations->make_work()) {}

  /// \param soon, up_to instants at which shaking is looked at where the load pushes
  ChangeOfLoad change(std::size_t load, std::size_t soon, std::size_t up_to) {
    // Of the greatest effort, displaced too: what the state is off by, and a turn carried on, is known to so much.
    constexpr double rounding = 1e-9;
    const double start_time = instants_.front().time;
    greatest_ = 0;
    const PushOfLoad start = at(start_time, instants_.front(), load);
    double pushed = 0;
    std::vector<double> shaken(instants_.size(), 0.0);
    for (std::size_t k = 1; k < instants_.size(); ++k) {
      const PushOfLoad then = at(instants_[k].time, instants_[k], load);
      if (then.here == start.here && then.displaced == start.displaced) continue;
      // What the place alone makes of it is not of the time.
      const PushOfLoad of_place = at(start_time, instants_[k], load);
      pushed = std::max(pushed, std::min(apart(then.here, start.here), apart(then.here, of_place.here)));
      const Eigen::VectorXd by = then.displaced - then.here;
      shaken[k] = std::min(apart(by, start.displaced - start.here), apart(by, of_place.displaced - of_place.here));
    }
    ChangeOfLoad found{pushed > rounding * greatest_, {}};
    for (std::size_t k = found.pushes ? soon : 1; k < (found.pushes ? up_to : instants_.size()); ++k)
      if (shaken[k] > rounding * greatest_) found.shaken.push_back(k);
    std::sort(found.shaken.begin(), found.shaken.end(),
              [&](std::size_t a, std::size_t b) { return shaken[a] > shaken[b]; });
    return found;
  }

  /// Whether time itself changes what loads make together of small motions, at one of these instants. A displacement
  /// is finite, and what it makes of a load's square is nothing to these. \param pushed held against all that acts, for
  /// a law near its limit has nearly no derivative of its own
  bool small_motions_change(const std::vector<std::size_t>& loads, const std::vector<std::size_t>& at, bool pushed) {
    if (at.empty() || free_.empty()) return false;
    const double start_time = instants_.front().time;
    const Eigen::VectorXd against = pushed ? all_that_acts() : Eigen::VectorXd::Zero(free_count());
    const double share = pushed ? pushed_equations : differenced_equations;
    const auto others = [&](const Differenced& a, const Differenced& b) {
      return other_equations(a, b, share, against).any();
    };
    const Differenced start = slopes(start_time, instants_.front().here, loads);
    return std::any_of(at.begin(), at.end(), [&](std::size_t k) {
      const Differenced then = slopes(instants_[k].time, instants_[k].here, loads);
      return others(start, then) && others(slopes(start_time, instants_[k].here, loads), then);
    });
  }

 private:
  PushOfLoad at(double t, const Instant& place, std::size_t load) {
    return {of(t, place.here, load), of(t, place.displaced, load)};
  }
  Eigen::VectorXd of(double t, const State& state, std::size_t load) {
    Eigen::VectorXd efforts = load_efforts(*c_.prepared().equations, t, state, static_cast<int>(load), work_);
    for (const double effort : efforts) greatest_ = std::max(greatest_, std::abs(effort));
    return efforts;
  }
  /// What holds a hinge bears what acts on it.
  [[nodiscard]] double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    double change = 0;
    for (const Eigen::Index s : free_) change = std::max(change, std::abs(a[s] - b[s]));
    return change;
  }
  [[nodiscard]] Eigen::Index free_count() const { return static_cast<Eigen::Index>(free_.size()); }
  /// Of efforts on what is free, of loads together.
  Differenced slopes(double t, const State& place, const std::vector<std::size_t>& loads) {
    return slopes_anyhow(c_, place, [&](const State& state) {
      Eigen::VectorXd all = Eigen::VectorXd::Zero(free_count());
      for (const std::size_t load : loads) all += of(t, state, load)(free_);
      return all;
    });
  }
  /// What a displacement or its rate makes of all forces on what is free, were none to make up for another.
  Eigen::VectorXd all_that_acts() {
    const Instant& start = instants_.front();
    const Tangents now =
        c_.dynamics().tangents(start.time, start.here.y, c_.dynamics().steady_accelerations(start.time));
    Eigen::VectorXd by(free_count());
    for (Eigen::Index i = 0; i < by.size(); ++i) {
      const std::size_t rate = c_.layout().positions + static_cast<std::size_t>(free_[static_cast<std::size_t>(i)]);
      by[i] = std::abs(start.displaced.y[rate] - start.here.y[rate]);
    }
    const auto made_by = [&](const Eigen::MatrixXd& m) -> Eigen::VectorXd { return m(free_, free_).cwiseAbs() * by; };
    return made_by(now.by_position).cwiseMax(made_by(now.by_speed));
  }

  const Configuration& c_;
  const std::vector<Instant>& instants_;
  std::vector<Eigen::Index> free_;
  Work work_;
  double greatest_ = 0;  ///< effort of the load that has been met
};

}  // namespace

std::vector<double> times_after(const Configuration& c, const State& state) {
  constexpr int octaves = 20, intervals = 16;
  constexpr double without_end = 100;
  const double left = c.prepared().scene.end.value_or(state.time) - state.time, span = left > 0 ? left : without_end;
  std::vector<double> times;
  for (int k = 1; k <= octaves; ++k) times.push_back(std::ldexp(span, -k));
  for (int k = 0; k < intervals; ++k)
    for (const double share : in_no_ratio) times.push_back(span * (k + share) / intervals);
  return times;
}

TimedLoads timed_loads(const Configuration& c, const State& state, const Turning& turning) {
  constexpr std::size_t soon = first_soon + 1, up_to = end_of_soon + 1;  // the state itself is the first instant
  const std::vector<Instant> instants = instants_after(c, state, turning, times_after(c, state));
  Pushes pushes(c, instants);
  TimedLoads found;
  const std::vector<LoadNode>& loads = c.prepared().model().loads();
  std::vector<std::size_t> shaking, shaken;
  for (std::size_t load = 0; load < loads.size(); ++load) {
    const ChangeOfLoad change = pushes.change(load, soon, up_to);
    if (change.pushes) found.pushing.push_back(loads[load].name);
    if (!pushes.small_motions_change({load}, change.shaken, change.pushes)) continue;
    found.shaking.push_back(loads[load].name);
    shaking.push_back(load);
    shaken.insert(shaken.end(), change.shaken.begin(), change.shaken.end());
  }
  // Springs in axes that turn with time may leave the equations as they are together.
  if (shaking.size() > 1 && !pushes.small_motions_change(shaking, shaken, false)) found.shaking.clear();
  return found;
}

State displaced_anyhow(const Configuration& c, State state, double times) {
  constexpr double far = 1e-2;  // rad, m, and a second of it
  const Layout& layout = c.layout();
  Eigen::VectorXd by(static_cast<Eigen::Index>(layout.speeds));
  for (Eigen::Index s = 0; s < by.size(); ++s) {
    by[s] = c.held()[static_cast<std::size_t>(s)] ? 0.0 : times * far * (1 + std::cos(static_cast<double>(s)) / 2);
    state.y[layout.positions + static_cast<std::size_t>(s)] += by[s];
  }
  c.dynamics().displace(state.y, by);
  return state;
}

Differenced slopes_anyhow(const Configuration& c, const State& state,
                          const std::function<Eigen::VectorXd(const State&)>& reading) {
  constexpr int levels = 12;  // as adaptive_difference
  const State displaced = displaced_anyhow(c, state);
  double place = 0;  // in displacements: no step is to be lost in a coordinate
  for (std::size_t i = 0; i < state.y.size(); ++i)
    if (const double by = std::abs(displaced.y[i] - state.y[i]); by > 0)
      place = std::max(place, std::abs(state.y[i]) / by);
  return refine_difference([&](double times) { return reading(displaced_anyhow(c, state, times)); }, 1, levels, place);
}

Eigen::VectorXd other_slopes(const Differenced& a, const Differenced& b) {
  constexpr double of_change = 10;
  Eigen::VectorXd others = Eigen::VectorXd::Zero(a.slope.size());
  for (Eigen::Index i = 0; i < others.size(); ++i) {
    const double open = of_change * (a.change[i] + b.change[i]) + a.rounding[i] + b.rounding[i];
    if (const double change = std::abs(b.slope[i] - a.slope[i]) - open; change > 0) others[i] = change;
  }
  return others;
}

Eigen::Array<bool, Eigen::Dynamic, 1> other_equations(const Differenced& a, const Differenced& b, double share,
                                                      const Eigen::VectorXd& sizes) {
  constexpr double rounding_of_all = 1e-12;
  const Eigen::VectorXd own = a.slope.cwiseAbs().cwiseMax(b.slope.cwiseAbs());
  const double all = own.size() > 0 ? own.maxCoeff() : 0.0;
  return other_slopes(a, b).array() > (share * own.cwiseMax(sizes).array()).max(rounding_of_all * all);
}

}  // namespace withy::study
