#include "withy/study/sampled_loads.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "withy/core/plugin/digital_part.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

constexpr double most_instants = 1000;
/// Periods whose ratio is a whole number but for this are multiples.
constexpr double same_instant = 1e-9;

bool whole(double x) { return std::abs(x - std::round(x)) <= same_instant * std::max(1.0, x); }

const DiscretePart& part_of(const Model& model, const LoadSlot& slot) {
  return *model.loads()[slot.load].load->discrete();
}

}  // namespace

SampledLoads::SampledLoads(const SmallMotions& motions)
    : motions_(motions), renewal_(motions.model(), motions.equations()) {
  const Model& model = motions.model();
  names_ = sampled_names(model);
  efforts_.setZero(motions_.by_effort().cols(), size());
  Eigen::Index first = 0;
  const std::vector<LoadSlot> told = told_slots(model);
  for (const LoadSlot& slot : sampled_slots(model)) {
    const auto* digital = dynamic_cast<const DigitalPart*>(&part_of(model, slot));
    if (digital != nullptr && digital->gives_steps())
      throw InputError(fmt::format(
          "load '{}' gives what it measures in steps: it is not linear, and small motions do not show in it; leave it "
          "out for motions of many steps, and let what measures it measure its own 'of'",
          model.loads()[slot.load].name));
    loads_.push_back({slot, part_of(model, slot).period(), first, told[loads_.size()]});
    first += static_cast<Eigen::Index>(slot.count);
    told_ += static_cast<Eigen::Index>(loads_.back().told.count);
  }
  own_efforts_ = efforts_;
  rates_.setZero(motions_.size(), size());
  if (none()) return;
  find_period();
  refuse_held_alone();
  refuse_told_measured();
  differentiate();
}

void SampledLoads::refuse_held_alone() {
  const State& now = motions_.state();
  for (const Eigen::Index s : motions_.held_alone()) {
    const State pushed = motions_.pushed(Eigen::VectorXd::Unit(motions_.by_effort().cols(), s));
    for (const double t : instants_) {
      // An effort on it changes accelerations alone: what does not depend on them keeps its bits.
      if (renewed(pushed, now, due(t)) == renewed(now, now, due(t))) continue;
      const std::string& name = motions_.model().layout().speed_names[static_cast<std::size_t>(s)];
      throw InputError("'" + name +
                       "' is held and other rates of its hinge are not, and a sampled load measures accelerations or "
                       "forces, which do not know of that: hold all of the hinge");
    }
  }
}

void SampledLoads::refuse_told_measured() {
  const State& now = motions_.state();
  const Eigen::VectorXd renewed_now = renewed(now, now, due(0));
  if (!renewed_now.allFinite()) return;
  Eigen::Index i = 0;
  for (const Part& part : loads_)
    for (const Eigen::Index end = i + static_cast<Eigen::Index>(part.told.count); i < end; ++i)
      // What nothing measures leaves all bits; a law may have a dead zone, and a limit.
      for (const double by : {-1e3, -1.0, -1e-3, 1e-3, 1.0, 1e3}) {
        const State told = told_displaced(i, by);
        if (renewed(told, told, due(0)) == renewed_now) continue;
        const std::string& name = motions_.model().loads()[part.told.load].name;
        throw InputError(fmt::format(
            "a sampled load measures what an output shows of load '{0}' beside its commands, as its error, and small "
            "motions take that for something that nothing follows: let it measure what '{0}' measures",
            name));
      }
}

void SampledLoads::find_period() {
  double least = loads_[0].period;
  for (const Part& part : loads_) least = std::min(least, part.period);
  double greatest = 0;
  for (const Part& part : loads_) greatest = std::max(greatest, part.period);
  for (int k = 1; k * greatest <= most_instants * least; ++k) {
    if (!std::all_of(loads_.begin(), loads_.end(), [&](const Part& part) { return whole(k * greatest / part.period); }))
      continue;
    period_ = k * greatest;
    break;
  }
  if (!(period_ > 0))
    throw InputError(
        fmt::format("the periods of the sampled loads, {} s to {} s, have no common multiple within {:g} "
                    "samples of the shortest",
                    least, greatest, most_instants));
  for (const Part& part : loads_) {
    const auto count = static_cast<int>(std::lround(period_ / part.period));
    for (int k = 0; k < count; ++k) instants_.push_back(k * part.period);
  }
  std::sort(instants_.begin(), instants_.end());
  const auto same = [&](double a, double b) { return b - a <= same_instant * period_; };
  instants_.erase(std::unique(instants_.begin(), instants_.end(), same), instants_.end());
}

/// Which loads are renewed at an instant.
std::vector<bool> SampledLoads::due(double t) const {
  std::vector<bool> all;
  for (const Part& part : loads_) all.push_back(whole(t / part.period));
  return all;
}

Eigen::VectorXd SampledLoads::held(const State& state) const {
  Eigen::VectorXd d(size());
  for (const Part& part : loads_)
    for (std::size_t i = 0; i < part.slot.count; ++i)
      d[part.first + static_cast<Eigen::Index>(i)] = state.y[part.slot.first + i];
  return d;
}

Eigen::VectorXd SampledLoads::held_and_told(const State& state) const {
  Eigen::VectorXd all(size() + told_);
  all.head(size()) = held(state);
  Eigen::Index next = size();
  for (const Part& part : loads_)
    for (std::size_t i = part.told.first; i < part.told.first + part.told.count; ++i) all[next++] = state.y[i];
  return all;
}

State SampledLoads::after(const State& before, State state, const std::vector<bool>& due) {
  renewal_.at(before);
  for (std::size_t i = 0; i < loads_.size(); ++i)
    if (due[i]) renewal_(state, loads_[i].slot, {});
  return state;
}

State SampledLoads::displaced(const Eigen::VectorXd& d) const {
  State state = motions_.state();
  for (const Part& part : loads_)
    for (std::size_t i = 0; i < part.slot.count; ++i)
      state.y[part.slot.first + i] += d[part.first + static_cast<Eigen::Index>(i)];
  return state;
}

State SampledLoads::told_displaced(Eigen::Index i, double by) const {
  State state = motions_.state();
  for (const Part& part : loads_) {
    const auto count = static_cast<Eigen::Index>(part.told.count);
    if (i < count) {
      state.y[part.told.first + static_cast<std::size_t>(i)] += by;
      break;
    }
    i -= count;
  }
  return state;
}

Eigen::MatrixXd SampledLoads::differentiated(const std::vector<bool>& due) {
  const Eigen::Index n = motions_.size(), all = size() + told_;
  Eigen::MatrixXd R = Eigen::MatrixXd::Identity(n + all, n + size());
  const auto slope = [&](auto&& state_at, double step) {
    const auto told = [&](double h) {
      const State state = state_at(h);
      return held_and_told(after(state, state, due));
    };
    return adaptive_difference(told, step).slope;
  };
  for (Eigen::Index i = 0; i < n; ++i)
    R.col(i).tail(all) = slope([&](double h) { return motions_.displaced(i, h); }, motions_.step(i));
  for (Eigen::Index i = 0; i < size(); ++i)
    R.col(n + i).tail(all) = slope([&](double h) { return displaced(h * Eigen::VectorXd::Unit(size(), i)); }, step(i));
  return R;
}

double SampledLoads::step(Eigen::Index i) const {
  const auto part = std::find_if(loads_.begin(), loads_.end(),
                                 [&](const Part& p) { return i < p.first + static_cast<Eigen::Index>(p.slot.count); });
  const auto count = static_cast<Eigen::Index>(part->slot.count);
  return std::max(1.0, held_at_state().segment(part->first, count).cwiseAbs().maxCoeff());
}

void SampledLoads::differentiate() {
  change_ = renewed(motions_.state(), motions_.state(), due(0)) - held_at_state();
  for (const Part& part : loads_) {
    for (Eigen::Index i = part.first; i < part.first + static_cast<Eigen::Index>(part.slot.count); ++i) {
      const auto slope = [&](auto&& of) {
        return adaptive_difference([&](double h) { return of(displaced(h * Eigen::VectorXd::Unit(size(), i))); },
                                   step(i))
            .slope;
      };
      own_efforts_.col(i) = slope([&](const State& s) { return motions_.efforts(s, part.slot.load); });
      efforts_.col(i) = slope([&](const State& s) { return motions_.efforts(s); });
      const Eigen::VectorXd rates = slope([&](const State& s) { return motions_.rates(s); });
      rates_.col(i).tail(rates.size()) = rates;
    }
  }
  for (const double t : instants_) {
    const std::vector<bool> now_due = due(t);
    const auto at = std::find(due_.begin(), due_.end(), now_due);
    kinds_.push_back(static_cast<std::size_t>(at - due_.begin()));
    if (at != due_.end()) continue;
    due_.push_back(now_due);
    renewals_.push_back(differentiated(now_due));
  }
}

std::vector<Eigen::MatrixXd> SampledLoads::felt(const std::vector<LinearInput>& inputs) {
  bool any = false;
  std::vector<Eigen::MatrixXd> all;
  for (const std::vector<bool>& due : due_) {
    Eigen::MatrixXd by_input(size() + told_, static_cast<Eigen::Index>(inputs.size()));
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      // Only outputs feel v at once: what loads remember, and give one another, is what it was.
      const auto pushed = [&](double h) { return held_and_told(after(inputs[k].state_at(h), motions_.state(), due)); };
      by_input.col(static_cast<Eigen::Index>(k)) = adaptive_difference(pushed, motions_.step(inputs[k].efforts)).slope;
    }
    any = any || !by_input.isZero(0);
    all.push_back(std::move(by_input));
  }
  return any ? all : std::vector<Eigen::MatrixXd>();
}

double SampledLoads::period_of(std::size_t load) const {
  for (const Part& part : loads_)
    if (part.slot.load == load) return part.period;
  return 0;
}

std::pair<Eigen::Index, Eigen::Index> SampledLoads::held_by(std::size_t load) const {
  for (const Part& part : loads_)
    if (part.slot.load == load) return {part.first, static_cast<Eigen::Index>(part.slot.count)};
  return {0, 0};
}

bool SampledLoads::measured_by_others(std::size_t load) {
  const auto [first, count] = held_by(load);
  for (std::vector<bool> due : due_) {
    // Were it renewed too, the others would be given its new numbers.
    for (std::size_t i = 0; i < loads_.size(); ++i) due[i] = due[i] && loads_[i].slot.load != load;
    Eigen::VectorXd as_held = renewed(motions_.state(), motions_.state(), due);
    for (Eigen::Index i = first; i < first + count; ++i) {
      Eigen::VectorXd change =
          renewed(motions_.state(), displaced(1e-3 * Eigen::VectorXd::Unit(size(), i)), due) - as_held;
      change.segment(first, count).setZero();
      if (!change.isZero(0)) return true;
    }
  }
  return false;
}

Eigen::MatrixXd SampledLoads::shown(const Held& system, std::size_t kind) const {
  const Eigen::Index n = motions_.size(), d = size();
  if (system.felt.empty()) return renewals_[kind];
  const Eigen::MatrixXd& felt = system.felt[kind];
  Eigen::MatrixXd R(n + d + told_, n + d + felt.cols());
  R.leftCols(n + d) = renewals_[kind];
  R.rightCols(felt.cols()) << Eigen::MatrixXd::Zero(n, felt.cols()), felt;
  // The efforts in whose place v stands are felt no longer.
  if (system.replaced.size() > 0) R.block(n, n, d + told_, d) -= felt * system.replaced;
  return R;
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> SampledLoads::map(const Held& system) const {
  const Eigen::Index n = motions_.size(), d = size(), m = system.B.cols(), h = system.felt.empty() ? 0 : m;
  Eigen::MatrixXd both(n, d + m);
  both << system.by_held, system.B;
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(n + d + h, n + d + h), input = Eigen::MatrixXd::Zero(n + d + h, m);
  for (std::size_t k = 0; k < instants_.size(); ++k) {
    const double next = k + 1 < instants_.size() ? instants_[k + 1] : period_;
    const auto [Phi, Gamma] = hold(system.A, both, next - instants_[k]);
    Eigen::MatrixXd step = Eigen::MatrixXd::Identity(n + d, n + d);
    step.topLeftCorner(n, n) = Phi;
    step.topRightCorner(n, d) = Gamma.leftCols(d);
    const Eigen::MatrixXd renewed = step * renewal(system, kinds_[k]);
    // At the first instant h is what v was before; then it is v.
    map.topRows(n + d) = (renewed * map).eval();
    input.topRows(n + d) = (renewed * input).eval();
    input.topRows(n) += Gamma.rightCols(m);
    map.bottomRows(h).setZero();
    input.bottomRows(h) = Eigen::MatrixXd::Identity(h, m);
  }
  return {map, input};
}

SampledLoads::Course SampledLoads::course(const Held& system, const Eigen::MatrixXcd& columns) const {
  constexpr double steps_a_radian = 2, fewest_steps = 4, most_steps = 1024;
  const Eigen::Index n = motions_.size();
  const double fastest = n > 0 ? system.A.eigenvalues().cwiseAbs().maxCoeff() : 0.0;
  Course course{fastest, {}, {}, {}};
  Eigen::MatrixXcd at = columns;
  for (std::size_t k = 0; k < instants_.size(); ++k) {
    const double length = (k + 1 < instants_.size() ? instants_[k + 1] : period_) - instants_[k];
    const auto steps =
        static_cast<int>(std::clamp(std::ceil(steps_a_radian * fastest * length), fewest_steps, most_steps));
    const double step = length / steps;
    const auto [Phi, Gamma] = hold(system.A, system.by_held, step);
    const auto [half, by_held_in_half] = hold(system.A, system.by_held, step / 2);
    at = (renewal(system, kinds_[k]) * at).eval();
    for (int i = 0; i < steps; ++i) {
      course.times.push_back(instants_[k] + (i + 0.5) * step);
      course.weights.push_back(step / period_);
      course.motions.emplace_back(half * at.topRows(n) + by_held_in_half * at.bottomRows(size()));
      at.topRows(n) = (Phi * at.topRows(n) + Gamma * at.bottomRows(size())).eval();
    }
  }
  return course;
}

}  // namespace withy::study
