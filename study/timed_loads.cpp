#include "withy/study/timed_loads.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  bool shakes = false;  ///< what it makes of a displacement
};

/// Pushes of single loads at instants after a state.
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
    double pushed = 0, shaken = 0, shaken_soon = 0;
    for (std::size_t k = 1; k < instants_.size(); ++k) {
      const PushOfLoad then = at(instants_[k].time, instants_[k], load);
      if (then.here == start.here && then.displaced == start.displaced) continue;
      // What the place alone makes of it is not of the time.
      const PushOfLoad of_place = at(start_time, instants_[k], load);
      pushed = std::max(pushed, std::min(apart(then.here, start.here), apart(then.here, of_place.here)));
      const Eigen::VectorXd by = then.displaced - then.here;
      const double other =
          std::min(apart(by, start.displaced - start.here), apart(by, of_place.displaced - of_place.here));
      shaken = std::max(shaken, other);
      if (k >= soon && k < up_to) shaken_soon = std::max(shaken_soon, other);
    }
    const bool pushes = pushed > rounding * greatest_;
    return {pushes, (pushes ? shaken_soon : shaken) > rounding * greatest_};
  }

 private:
  PushOfLoad at(double t, const Instant& place, std::size_t load) {
    return {of(t, place.here, load), of(t, place.displaced, load)};
  }
  Eigen::VectorXd of(double t, const State& state, std::size_t load) {
    std::vector<double> efforts(c_.layout().speeds);
    c_.prepared().equations->load_efforts(t, state.y, static_cast<int>(load), efforts, work_);
    for (const double effort : efforts) greatest_ = std::max(greatest_, std::abs(effort));
    return Eigen::Map<const Eigen::VectorXd>(efforts.data(), static_cast<Eigen::Index>(efforts.size()));
  }
  /// What holds a hinge bears what acts on it.
  [[nodiscard]] double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    double change = 0;
    for (const Eigen::Index s : free_) change = std::max(change, std::abs(a[s] - b[s]));
    return change;
  }

  const Configuration& c_;
  const std::vector<Instant>& instants_;
  std::vector<Eigen::Index> free_;
  Work work_;
  double greatest_ = 0;  ///< effort of the load that has been met
};

/// Whether time itself changes the equations of small motions in some of these instants.
bool small_motions_change(const Configuration& c, const std::vector<Instant>& instants, std::size_t first,
                          std::size_t end, double share) {
  constexpr std::size_t every = 3;  // tangents take longer than efforts
  const std::vector<Eigen::Index> free = free_speeds(c.held());
  if (free.empty() && c.layout().continuous == 0) return false;
  const auto at = [&](double t, const State& there) {
    return c.dynamics().tangents(t, there.y, c.dynamics().steady_accelerations(t));
  };
  const double start = instants.front().time;
  const Tangents now = at(start, instants.front().here);
  for (std::size_t k = first; k < end; k += every) {
    const Tangents then = at(instants[k].time, instants[k].here);
    if (other_equations(now, then, free, share) && other_equations(at(start, instants[k].here), then, free, share))
      return true;
  }
  return false;
}

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

bool other_equations(const Tangents& a, const Tangents& b, const std::vector<Eigen::Index>& free, double share) {
  const auto differs = [share](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    return x.size() > 0 &&
           (x - y).cwiseAbs().maxCoeff() > share * std::max(x.cwiseAbs().maxCoeff(), y.cwiseAbs().maxCoeff());
  };
  const auto rows = [&](const Eigen::MatrixXd& m) { return Eigen::MatrixXd(m(free, Eigen::all)); };
  const auto columns = [&](const Eigen::MatrixXd& m) { return Eigen::MatrixXd(m(Eigen::all, free)); };
  if (differs(a.by_position(free, free), b.by_position(free, free)) ||
      differs(a.by_speed(free, free), b.by_speed(free, free)))
    return true;
  if (a.rate_by_state.size() == 0) return false;
  return differs(rows(a.by_state), rows(b.by_state)) ||
         differs(columns(a.rate_by_position), columns(b.rate_by_position)) ||
         differs(columns(a.rate_by_speed), columns(b.rate_by_speed)) || differs(a.rate_by_state, b.rate_by_state);
}

TimedLoads timed_loads(const Configuration& c, const State& state, const Turning& turning) {
  constexpr std::size_t soon = first_soon + 1, up_to = end_of_soon + 1;  // the state itself is the first instant
  const std::vector<Instant> instants = instants_after(c, state, turning, times_after(c, state));
  Pushes pushes(c, instants);
  TimedLoads found;
  const std::vector<LoadNode>& loads = c.prepared().model().loads();
  for (std::size_t load = 0; load < loads.size(); ++load) {
    const ChangeOfLoad change = pushes.change(load, soon, up_to);
    if (change.pushes) found.pushing.push_back(loads[load].name);
    if (change.shakes) found.shaking.push_back(loads[load].name);
  }
  const bool calm = found.pushing.empty();
  // A displacement is finite: what it makes of a load's square is nothing to small motions.
  if (!found.shaking.empty() && !small_motions_change(c, instants, calm ? 1 : soon, calm ? instants.size() : up_to,
                                                      calm ? differenced_equations : pushed_equations))
    found.shaking.clear();
  return found;
}

State displaced_anyhow(const Configuration& c, State state) {
  constexpr double far = 1e-2;  // rad, m, and a second of it
  const Layout& layout = c.layout();
  Eigen::VectorXd by(static_cast<Eigen::Index>(layout.speeds));
  for (Eigen::Index s = 0; s < by.size(); ++s) {
    by[s] = c.held()[static_cast<std::size_t>(s)] ? 0.0 : far * (1 + std::cos(static_cast<double>(s)) / 2);
    state.y[layout.positions + static_cast<std::size_t>(s)] += by[s];
  }
  c.dynamics().displace(state.y, by);
  return state;
}

}  // namespace withy::study
