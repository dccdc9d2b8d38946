#include "withy/core/simulation/loop_watch.hpp"

#include "withy/core/simulation/diagnosis.hpp"

namespace withy {

LoopWatch::LoopWatch(const EquationsOfMotion& equations, const State& initial)
    : loops_(dynamic_cast<const ClosedLoops*>(&equations)), work_(loops_ != nullptr ? equations.make_work() : Work(0)) {
  if (loops_ == nullptr) return;
  last_ = initial;
  for (const LoopCount& count : loops_->counts(initial.y, work_)) rank_ += count.independent;
}

std::string LoopWatch::fault(const State& state) {
  if (loops_ == nullptr) return {};
  const bool passes = state.time > last_.time && loops_->passes_singularity(last_.y, state.y, rank_, work_);
  const double before = last_.time;
  last_ = state;
  if (!passes) return {};
  return "the equations that close the loops lose rank between t = " + brief(before) + " and " + brief(state.time) +
         " s: there the loops can move on in more than one way, and no equation of motion says which (a singular "
         "configuration, as where links of a four-bar lie in one line)";
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
