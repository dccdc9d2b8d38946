#include "withy/core/simulation/loop_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/integrator_call.hpp"

namespace withy {
namespace {

/// Of a step, to a four-thousandth of it.
constexpr std::size_t most_halvings = 12;
/// How far hinges of loops may turn between states of which the rank is told [rad], and the most parts of a step for
/// that.
constexpr double most_turned = 1, most_times = 4096;
/// How far the coordinates of a run's start go on for a look beside it [rad, m].
constexpr double beside = 1e-3;

}  // namespace

LoopWatch::LoopWatch(const EquationsOfMotion& equations, const State& initial)
    : loops_(dynamic_cast<const ClosedLoops*>(&equations)), work_(loops_ != nullptr ? equations.make_work() : Work(0)) {
  if (loops_ == nullptr) return;
  last_ = initial;
  between_.assign(most_halvings, initial);
  from_ = to_ = initial;
  rank_ = loops_->rank_at(initial.y, work_);
  begins_singular_ = rank_.independent < rank_beside(equations, initial);
}

std::size_t LoopWatch::rank_beside(const EquationsOfMotion& equations, const State& initial) {
  std::vector<double> slopes(equations.size());
  const std::size_t positions = equations.layout().positions, speeds = equations.layout().speeds;
  const auto fastest = [&](std::size_t first, std::size_t count) {
    double most = 0;
    for (std::size_t i = first; i < first + count; ++i) most = std::max(most, std::abs(slopes[i]));
    return std::isfinite(most) ? most : 0;
  };
  State there = initial;
  if (!equations.derivatives(there.time, there.y, slopes, work_).ok()) return 0;
  if (fastest(0, positions) == 0) {  // from rest it goes on along its accelerations
    const double most = fastest(positions, speeds);
    if (most == 0) return 0;
    for (std::size_t i = positions; i < positions + speeds; ++i) there.y[i] = slopes[i] / most;
    if (!equations.derivatives(there.time, there.y, slopes, work_).ok()) return 0;
  }
  const double most = fastest(0, positions);
  if (most == 0) return 0;
  for (std::size_t i = 0; i < positions; ++i) there.y[i] += beside / most * slopes[i];
  return loops_->close(there.y, work_).closed ? independent_at(there) : 0;
}

std::size_t LoopWatch::independent_at(const State& state) {
  std::size_t rank = 0;
  for (const LoopCount& count : loops_->counts(state.y, work_)) rank += count.independent;
  return rank;
}

double LoopWatch::kept_until(const Stepper& stepper, const State& before, const State& after, std::size_t halvings) {
  if (loops_->keeps_rank(before.y, after.y, rank_, work_)) return after.time;
  if (halvings == 0) return before.time;
  State& middle = between_[halvings - 1];
  middle.time = before.time + (after.time - before.time) / 2;
  interpolate_step(stepper, middle.time, middle.y);
  const double first = kept_until(stepper, before, middle, halvings - 1);
  return first < middle.time ? first : kept_until(stepper, middle, after, halvings - 1);
}

double LoopWatch::kept_through(const Stepper& stepper, const State& after) {
  const double start = last_.time, length = after.time - start;
  const double turned = loops_->turned(last_.y, after.y, length);
  if (!(turned > most_turned)) return kept_until(stepper, last_, after, most_halvings);
  const double parts = std::min(std::ceil(turned / most_turned), most_times);
  from_ = last_;
  for (double k = 1; k < parts; ++k) {
    to_.time = start + length * (k / parts);
    interpolate_step(stepper, to_.time, to_.y);
    if (const double kept = kept_until(stepper, from_, to_, most_halvings); kept < to_.time) return kept;
    std::swap(from_, to_);
  }
  return kept_until(stepper, from_, after, most_halvings);
}

std::string LoopWatch::fault(const Stepper& stepper) {
  if (loops_ == nullptr) return {};
  const State& state = stepper.state();
  if (!(state.time > last_.time)) {
    last_ = state;
    return {};
  }
  const double before = last_.time, kept = kept_through(stepper, state);
  last_ = state;
  if (kept < state.time)
    return "the equations that close the loops lose rank " +
           brief_interval(
               kept, std::min(state.time, kept + std::ldexp(state.time - before, -static_cast<int>(most_halvings)))) +
           ": there the loops can move on in more than one way, and no equation of motion says which (a singular "
           "configuration, as where links of a four-bar lie in one line)";
  if (begins_singular_)
    return "the run begins in a singular configuration of the loops, as where links of a four-bar lie in one line: "
           "there they can move on in more than one way, and no equation of motion says which";
  return {};
}

void LoopWatch::remember(Memory& memory) {
  if (loops_ == nullptr) return;
  memory(last_.time);
  memory(last_.y);
}

std::string closing_text(const EquationsOfMotion& equations, const Stepper& stepper) {
  const auto* closing = dynamic_cast<const ClosingStepper*>(&stepper);
  if (closing == nullptr || dynamic_cast<const ClosedLoops*>(&equations) == nullptr) return {};
  const ClosingRecord& record = closing->closing_record();
  return "Loops were closed after each step: gaps of up to " + brief(record.gap) + " m there, " + brief(record.energy) +
         " J added.";
}

}  // namespace withy
