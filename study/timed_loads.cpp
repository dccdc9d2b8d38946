#include "withy/study/timed_loads.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "withy/study/felt_states.hpp"
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

/// Efforts of a load [N m, N], one a speed, then rates of its own states, at a state and with everything displaced.
struct PushOfLoad {
  Eigen::VectorXd here, displaced;
};

/// By how much efforts and rates are others at an instant: than at the state, and than at the state's time with
/// everything where it is by then. What the place alone makes of them is not of the time.
struct PushedBy {
  Eigen::VectorXd from_start, from_place;
};

/// What time itself changes of a load's efforts on what is free, and of the rates of its own states, of which its
/// efforts are to come.
struct ChangeOfLoad {
  bool pushes = false;  ///< at the state
  bool felt = false;    ///< and something free feels it, at once or by and by
  std::vector<std::size_t>
      shaken;  ///< instants at which a displacement makes another effort, the greatest change first
};

/// Pushes of loads at instants after a state.
class Pushes {
 public:
  Pushes(const Configuration& c, const std::vector<Instant>& instants, const Turning& turning, Shaken shaken)
      : c_(c),
        instants_(instants),
        turning_(turning),
        shaken_(shaken),
        free_(free_speeds(c.held())),
        rows_(free_),
        work_(c.prepared().equations->make_work()),
        scratch_(c.prepared().model().load_scratch()),
        at_rest_(c.layout().speeds) {
    for (std::size_t i = 0; i < c.layout().continuous; ++i)
      rows_.push_back(static_cast<Eigen::Index>(c.layout().speeds + i));
    every_.resize(c.layout().speeds + c.layout().continuous);
    std::iota(every_.begin(), every_.end(), Eigen::Index{0});
  }

  /// \param soon, up_to instants at which shaking is looked at where the load pushes
  ChangeOfLoad change(std::size_t load, std::size_t soon, std::size_t up_to) {
    // Of the greatest effort, displaced too: what the state is off by, and a turn carried on, is known to so much.
    constexpr double rounding = 1e-9;
    const double start_time = instants_.front().time;
    greatest_.setZero();
    const PushOfLoad start = at(start_time, instants_.front(), load);
    std::vector<PushedBy> pushed;
    std::vector<Sizes> shaken(instants_.size(), Sizes::Zero());
    for (std::size_t k = 1; k < instants_.size(); ++k) {
      const PushOfLoad then = at(instants_[k].time, instants_[k], load);
      if (then.here == start.here && then.displaced == start.displaced) continue;
      const PushOfLoad of_place = at(start_time, instants_[k], load);
      pushed.push_back({then.here - start.here, then.here - of_place.here});
      const Eigen::VectorXd by = then.displaced - then.here;
      shaken[k] = apart(by, start.displaced - start.here).min(apart(by, of_place.displaced - of_place.here));
    }
    const auto pushes = [&](const std::vector<Eigen::Index>& rows) {
      Sizes most = Sizes::Zero();
      for (const PushedBy& by : pushed)
        most = most.max(greatest(by.from_start, rows).min(greatest(by.from_place, rows)));
      return share(most) > rounding;
    };
    ChangeOfLoad found{pushes(rows_), false, {}};
    found.felt = found.pushes && (pushes(free_) || pushes(felt_rows()));
    for (std::size_t k = found.pushes ? soon : 1; k < (found.pushes ? up_to : instants_.size()); ++k)
      if (share(shaken[k]) > rounding) found.shaken.push_back(k);
    std::sort(found.shaken.begin(), found.shaken.end(),
              [&](std::size_t a, std::size_t b) { return share(shaken[a]) > share(shaken[b]); });
    return found;
  }

  /// Whether time itself changes what loads make together of small motions, at one of these instants. A displacement
  /// is finite, and what it makes of a load's square is nothing to these. \param pushed held against all that acts, for
  /// a law near its limit has nearly no derivative of its own
  bool small_motions_change(const std::vector<std::size_t>& loads, const std::vector<std::size_t>& at, bool pushed) {
    if (at.empty() || rows_.empty()) return false;
    const double start_time = instants_.front().time;
    const Eigen::VectorXd against = pushed ? all_that_acts() : Eigen::VectorXd::Zero(count());
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
  using Sizes = Eigen::Array2d;  ///< of an effort, of a rate of a state

  PushOfLoad at(double t, const Instant& place, std::size_t load) {
    return {of(t, place.here, load), of(t, place.displaced, load)};
  }
  Eigen::VectorXd of(double t, const State& state, std::size_t load) {
    const std::size_t speeds = c_.layout().speeds;
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(speeds + c_.layout().continuous));
    all.head(static_cast<Eigen::Index>(speeds)) = c_.dynamics().on_motions(
        state.y, load_efforts(*c_.prepared().equations, t, state, static_cast<int>(load), work_));
    if (const LoadNode& node = c_.prepared().model().loads()[load]; node.continuous != nullptr) {
      LoadView view = node.view(t, state.y, c_.layout(), scratch_);
      // Whose change with time makes others is told itself.
      view.accelerations = at_rest_;
      const LoadSlot& own = node.continuous_slot;
      node.continuous->rates(view, std::span<double>(all.data(), static_cast<std::size_t>(all.size()))
                                       .subspan(own.first - c_.layout().positions, own.count));
    }
    greatest_ = greatest_.max(greatest(all, every_));
    return all;
  }
  /// The greatest of the numbers in `rows` that are efforts, and of those that are rates of states.
  [[nodiscard]] Sizes greatest(const Eigen::VectorXd& all, const std::vector<Eigen::Index>& rows) const {
    const auto speeds = static_cast<Eigen::Index>(c_.layout().speeds);
    Sizes of = Sizes::Zero();
    for (const Eigen::Index r : rows) of[r < speeds ? 0 : 1] = std::max(of[r < speeds ? 0 : 1], std::abs(all[r]));
    return of;
  }
  /// What holds a hinge bears what acts on it.
  [[nodiscard]] Sizes apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const { return greatest(a - b, rows_); }
  /// Of the greatest that has been met.
  [[nodiscard]] double share(const Sizes& change) const {
    double most = 0;
    for (Eigen::Index i = 0; i < change.size(); ++i)
      if (change[i] > 0) most = std::max(most, change[i] / greatest_[i]);
    return most;
  }
  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(rows_.size()); }
  /// Of efforts on what is free and of rates of own states, of loads together.
  Differenced slopes(double t, const State& place, const std::vector<std::size_t>& loads) {
    const std::vector<Eigen::Index> unfelt = unfelt_rows();
    return slopes_anyhow(c_, place, [&](const State& state) {
      Eigen::VectorXd all = together(t, state, loads);
      if (!unfelt.empty()) {
        State alone = place;
        for (const Eigen::Index r : unfelt) alone.y[element(r)] = state.y[element(r)];
        all(unfelt) = together(t, alone, loads)(unfelt);
      }
      return Eigen::VectorXd(all(rows_));
    });
  }
  /// Of loads, on all speeds and of all states.
  Eigen::VectorXd together(double t, const State& state, const std::vector<std::size_t>& loads) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(every_.size()));
    for (const std::size_t load : loads) all += of(t, state, load);
    return all;
  }
  /// Of State::y, that of a row of a load's state.
  [[nodiscard]] std::size_t element(Eigen::Index row) const {
    return c_.layout().positions + static_cast<std::size_t>(row);
  }
  const std::vector<bool>& felt() {
    if (!felt_) felt_ = felt_states(c_, instants_.front().here, turning_).continuous;
    return *felt_;
  }
  /// Of states that something free feels.
  std::vector<Eigen::Index> felt_rows() { return rows_of_states(true); }
  /// Of those of which only what they make of each other counts.
  std::vector<Eigen::Index> unfelt_rows() {
    return shaken_ == Shaken::growth ? rows_of_states(false) : std::vector<Eigen::Index>();
  }
  std::vector<Eigen::Index> rows_of_states(bool that_are_felt) {
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < c_.layout().continuous; ++i)
      if (felt()[i] == that_are_felt) rows.push_back(static_cast<Eigen::Index>(c_.layout().speeds + i));
    return rows;
  }
  /// What a displacement or its rate makes of all forces on what is free, were none to make up for another, and of the
  /// rates of loads' states.
  Eigen::VectorXd all_that_acts() {
    const Instant& start = instants_.front();
    const Tangents now =
        c_.dynamics().tangents(start.time, start.here.y, c_.dynamics().steady_accelerations(start.time));
    Eigen::VectorXd by(static_cast<Eigen::Index>(free_.size()));
    for (Eigen::Index i = 0; i < by.size(); ++i) {
      const std::size_t rate = c_.layout().positions + static_cast<std::size_t>(free_[static_cast<std::size_t>(i)]);
      by[i] = std::abs(start.displaced.y[rate] - start.here.y[rate]);
    }
    const auto made_by = [&](const Eigen::MatrixXd& m) -> Eigen::VectorXd { return m.cwiseAbs() * by; };
    Eigen::VectorXd all = Eigen::VectorXd::Zero(count());
    all.head(by.size()) = made_by(now.by_position(free_, free_)).cwiseMax(made_by(now.by_speed(free_, free_)));
    if (now.rate_by_position.size() > 0)
      all.tail(count() - by.size()) =
          made_by(now.rate_by_position(Eigen::all, free_)).cwiseMax(made_by(now.rate_by_speed(Eigen::all, free_)));
    return all;
  }

  const Configuration& c_;
  const std::vector<Instant>& instants_;
  const Turning& turning_;
  Shaken shaken_;
  std::optional<std::vector<bool>> felt_;  ///< of the states of loads, once it is asked for
  std::vector<Eigen::Index> free_, rows_;  ///< speeds; beside these states of loads, behind all speeds
  std::vector<Eigen::Index> every_;        ///< held speeds too
  Work work_;
  std::vector<double> scratch_, at_rest_;
  Sizes greatest_ = Sizes::Zero();  ///< of the load that has been met
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

TimedLoads timed_loads(const Configuration& c, const State& state, const Turning& turning, Shaken shaken_what) {
  constexpr std::size_t soon = first_soon + 1, up_to = end_of_soon + 1;  // the state itself is the first instant
  const std::vector<Instant> instants = instants_after(c, state, turning, times_after(c, state));
  Pushes pushes(c, instants, turning, shaken_what);
  TimedLoads found;
  const std::vector<LoadNode>& loads = c.prepared().model().loads();
  std::vector<std::size_t> shaking, shaken;
  for (std::size_t load = 0; load < loads.size(); ++load) {
    const ChangeOfLoad change = pushes.change(load, soon, up_to);
    found.any_pushes = found.any_pushes || change.pushes;
    if (change.felt) found.pushing.push_back(loads[load].name);
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
  }
  Eigen::Map<Eigen::VectorXd>(state.y.data() + layout.positions, by.size()) += c.dynamics().whole(state.y, by);
  for (std::size_t i = layout.positions + layout.speeds; i < layout.moving(); ++i)
    state.y[i] += times * far * (1 + std::abs(state.y[i])) * (1 + std::cos(static_cast<double>(i)) / 2);
  c.dynamics().displace(state.y, by);
  return state;
}

Differenced slopes_anyhow(const Configuration& c, const State& state,
                          const std::function<Eigen::VectorXd(const State&)>& reading) {
  const State displaced = displaced_anyhow(c, state);
  double place = 0;  // in displacements: no step is to be lost in a coordinate
  for (std::size_t i = 0; i < state.y.size(); ++i)
    if (const double by = std::abs(displaced.y[i] - state.y[i]); by > 0)
      place = std::max(place, std::abs(state.y[i]) / by);
  return refine_difference([&](double times) { return reading(displaced_anyhow(c, state, times)); }, 1,
                           most_refinements, place);
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
