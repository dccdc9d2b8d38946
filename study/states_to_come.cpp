#include "withy/study/states_to_come.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "withy/core/model/hosted_motion.hpp"
#include "withy/study/timed_loads.hpp"

namespace withy::study {
namespace {

/// What of a number's greatest size counts as rounding, and of the greatest of its group.
constexpr double rounded_share = 1e-9, rounded_share_of_group = 1e-13;

/// What goes in stays as it is, whatever tables say of later.
State with_inputs_held(const SmallMotions& motions) {
  State state = motions.state();
  for (const LoadNode& node : motions.model().loads()) {
    const InputPort* port = node.load->input();
    if (port == nullptr || hosted_motion(*node.load) != nullptr) continue;
    const double value = port->value(state.time, node.discrete(std::span<const double>(state.y)));
    port->set(state.time, state.time, value, node.discrete(std::span<double>(state.y)));
  }
  return state;
}

/// No two displacements are alike, and none is nothing.
double weight_of(Eigen::Index i) { return 1 + std::cos(static_cast<double>(i)) / 2; }

/// What counts as rounding of each of several numbers, by the greatest that was met of it and of its group.
Eigen::VectorXd rounding_of(const Eigen::VectorXd& greatest, const std::vector<std::string>& groups) {
  std::map<std::string, double> of_group;
  for (Eigen::Index i = 0; i < greatest.size(); ++i) {
    double& most = of_group[groups[static_cast<std::size_t>(i)]];
    most = std::max(most, greatest[i]);
  }
  Eigen::VectorXd all = rounded_share * greatest;
  for (Eigen::Index i = 0; i < all.size(); ++i)
    all[i] += rounded_share_of_group * of_group[groups[static_cast<std::size_t>(i)]];
  return all;
}

}  // namespace

/// One reading at all instants.
struct StatesToCome::Looked {
  const StatesToCome& states;
  const Reading& reading;
  const Displacement& displacement;
  Read start;
  std::vector<Instant> instants;
  std::vector<Read> then;  ///< one an instant
  Eigen::VectorXd rounding;
  std::optional<Differenced> slopes;  ///< at the state, once they are wanted

  [[nodiscard]] Read at(const State& state) const {
    Read read{reading(state), {}};
    if (displacement) read.by = reading(displacement(state, 1)) - read.here;
    return read;
  }
  [[nodiscard]] Differenced slopes_at(const State& state) const {
    return adaptive_difference([&](double h) { return reading(displacement(state, h)); }, 1);
  }
  /// What is left of a change where rounding alone makes it: instants that differ by nothing else tell.
  [[nodiscard]] Read scatter(double after, const Read& there) const {
    Read all{Eigen::VectorXd::Zero(there.here.size()), Eigen::VectorXd::Zero(there.by.size())};
    for (const double part : {-1.7e-12, 1e-12, 2.3e-12}) {
      const Read near = at(states.carried_on(after * (1 + part)));
      all.here = all.here.cwiseMax((near.here - there.here).cwiseAbs());
      all.by = all.by.cwiseMax((near.by - there.by).cwiseAbs());
    }
    constexpr double above = 100;
    return {above * all.here, above * all.by};
  }
  /// By which share of themselves the derivatives along the displacement are others, beyond what differences leave.
  [[nodiscard]] Eigen::VectorXd other_slopes(double after) {
    if (!slopes) slopes = slopes_at(states.carried_on(0));
    const Differenced there = slopes_at(states.carried_on(after));
    Eigen::VectorXd others = study::other_slopes(*slopes, there);
    for (Eigen::Index i = 0; i < others.size(); ++i)
      if (others[i] > 0) others[i] /= std::max(std::abs(there.slope[i]), std::abs(slopes->slope[i]));
    return others;
  }

  void compare_values(std::size_t k, std::vector<GoingOn>& all) const;
  void compare_slopes(std::size_t k, std::vector<GoingOn>& all);
};

void StatesToCome::Looked::compare_values(std::size_t k, std::vector<GoingOn>& all) const {
  const Eigen::ArrayXd moved = (then[k].here - start.here).array().abs();
  const auto other = [&](Eigen::Index i) {
    const GoingOn& g = all[static_cast<std::size_t>(i)];
    return !g.moves && !g.timed && moved[i] > rounding[i];
  };
  bool any = false;
  for (Eigen::Index i = 0; i < moved.size(); ++i) any = any || other(i);
  if (!any) return;
  const Eigen::VectorXd noise = scatter(instants[k].after, then[k]).here;
  const Eigen::VectorXd of_place = reading(states.of_place(instants[k].after));
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    if (!other(i) || !(moved[i] > noise[i])) continue;
    const bool place = std::abs(then[k].here[i] - of_place[i]) <= std::max(rounding[i], noise[i]);
    (place ? all[static_cast<std::size_t>(i)].moves : all[static_cast<std::size_t>(i)].timed) = true;
  }
}

void StatesToCome::Looked::compare_slopes(std::size_t k, std::vector<GoingOn>& all) {
  const Eigen::ArrayXd bent = (then[k].by - start.by).array().abs();
  const auto other = [&](Eigen::Index i) {
    const GoingOn& g = all[static_cast<std::size_t>(i)];
    return !g.turns && !g.shakes && bent[i] > rounding[i];
  };
  bool any = false;
  for (Eigen::Index i = 0; i < bent.size(); ++i) any = any || other(i);
  if (!any) return;
  const Eigen::VectorXd noise = scatter(instants[k].after, then[k]).by;
  any = false;
  for (Eigen::Index i = 0; i < bent.size(); ++i) any = any || (other(i) && bent[i] > noise[i]);
  if (!any) return;
  const Read of_place = at(states.of_place(instants[k].after));
  const bool pushed = states.pushed_ || std::any_of(all.begin(), all.end(), [](const GoingOn& g) { return g.timed; });
  const Eigen::VectorXd others = other_slopes(instants[k].after);
  for (Eigen::Index i = 0; i < bent.size(); ++i) {
    if (!other(i) || !(bent[i] > noise[i]) || !(others[i] > differenced_equations)) continue;
    GoingOn& g = all[static_cast<std::size_t>(i)];
    if (std::abs(then[k].by[i] - of_place.by[i]) <= std::max(rounding[i], noise[i]))
      g.turns = true;
    else
      g.shakes = !pushed || (instants[k].soon && others[i] > pushed_equations);
  }
}

StatesToCome::StatesToCome(const Configuration& c, const SmallMotions& motions, const Turning& turning, bool pushed,
                           bool timed)
    : c_(c), motions_(motions), turning_(turning), state_(with_inputs_held(motions)), pushed_(pushed) {
  const double turn = one_turn(c.prepared().model(), turning, c.state());
  for (const double share : in_no_ratio)
    if (turn > 0) few_.push_back({share * turn, false});
  for (const double share : {0.25, 0.5})
    if (turn > 0) few_.push_back({share * turn, false});
  if (!timed) return;
  const std::vector<double> times = times_after(c, c.state());
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool soon = k >= first_soon && k < end_of_soon;
    (k % 23 == 7 ? few_ : more_).push_back({times[k], soon});
  }
}

State StatesToCome::carried_on(double after) const { return carried(c_.prepared().model(), turning_, state_, after); }

State StatesToCome::of_place(double after) const {
  State state = carried_on(after);
  state.time = state_.time;
  return state;
}

Displacement StatesToCome::everything() const {
  return [this](const State& from, double steps) {
    State state = from;
    const Layout& layout = c_.layout();
    const std::vector<Eigen::Index>& free = motions_.free();
    const auto m = static_cast<Eigen::Index>(free.size());
    Eigen::VectorXd by = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index s = free[static_cast<std::size_t>(i)];
      by[s] = steps * weight_of(i) * motions_.step(i);
    }
    Eigen::Map<Eigen::VectorXd>(state.y.data() + layout.positions, by.size()) += c_.dynamics().whole(state.y, by);
    c_.dynamics().displace(state.y, by);
    for (Eigen::Index i = 2 * m; i < motions_.size(); ++i)
      state.y[layout.positions + layout.speeds + static_cast<std::size_t>(i - 2 * m)] +=
          steps * weight_of(i) * motions_.step(i);
    Eigen::Index i = motions_.size();
    for (const LoadSlot& slot : sampled_slots(c_.prepared().model()))
      for (std::size_t at = slot.first; at < slot.first + slot.count; ++at)
        state.y[at] += steps * 1e-2 * weight_of(i++) * std::max(1.0, std::abs(from.y[at]));
    return state;
  };
}

std::vector<GoingOn> StatesToCome::look(const Reading& reading, const std::vector<std::string>& groups,
                                        const Displacement& displacement, bool few) const {
  std::vector<GoingOn> all(groups.size());
  Looked looked{*this, reading, displacement, {}, {}, {}, {}, {}};
  std::vector<Instant> instants = few_;
  if (!few) instants.insert(instants.end(), more_.begin(), more_.end());
  try {
    looked.start = looked.at(carried_on(0));
  } catch (const std::domain_error&) {  // what is said of the state itself says so
    return all;
  }
  Eigen::VectorXd greatest = looked.start.here.cwiseAbs();
  const auto meet = [&](const Read& read) {
    greatest = greatest.cwiseMax(read.here.cwiseAbs());
    if (displacement) greatest = greatest.cwiseMax(read.by.cwiseAbs());
  };
  meet(looked.start);
  for (const Instant& instant : instants) {
    try {
      looked.then.push_back(looked.at(carried_on(instant.after)));
    } catch (const std::domain_error&) {
      continue;
    }
    looked.instants.push_back(instant);
    meet(looked.then.back());
  }
  looked.rounding = rounding_of(greatest, groups);
  try {
    for (std::size_t k = 0; k < looked.then.size(); ++k) looked.compare_values(k, all);
    for (std::size_t k = 0; k < looked.then.size() && displacement; ++k) looked.compare_slopes(k, all);
  } catch (const std::domain_error&) {  // beside an instant: what was seen before stands
  }
  return all;
}

}  // namespace withy::study
