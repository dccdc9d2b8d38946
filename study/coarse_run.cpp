#include "withy/study/coarse_run.hpp"

#include <limits>

#include "withy/core/simulation/integrator_call.hpp"

namespace withy::study {
namespace {

/// Ends a coarse run that costs too much, and keeps the times of its steps.
class CoarseObserver final : public SteppingObserver {
 public:
  CoarseObserver(const Control& control, std::size_t most, std::function<void(const State&)> stepped)
      : control_(control), most_(most), stepped_(std::move(stepped)) {}
  bool before_step(const Stepper& stepper) override {
    return stepper.statistics().evaluations < most_ && !control_.stop();
  }
  bool output(const State& /*state*/) override { return true; }
  bool after_step(const Stepper& stepper, bool /*outputs*/) override {
    if (stepped_) stepped_(stepper.state());
    return true;
  }

 private:
  const Control& control_;
  std::size_t most_;
  std::function<void(const State&)> stepped_;
};

}  // namespace

CoarseRun::CoarseRun(const Prepared& prepared, std::size_t low, std::size_t high, const Outputs& outputs,
                     const Integrator& integrator, const State& start, double end)
    : corrected_(prepared.rungs, low, high),
      reader_(outputs, prepared.model(), *prepared.rungs[high].equations),
      loop_(prepared.model(), *prepared.rungs[high].equations, start_stepper(integrator, corrected_.faces(), start),
            {.end = end, .output = end - start.time + 1}),
      read_at_(-std::numeric_limits<double>::infinity()) {
  corrected_.begin(start);
}

bool CoarseRun::to(double time, const Control& control, std::size_t most) {
  CoarseObserver observer(control, most, [&](const State& s) { corrected_.sample(s); });
  loop_.move_end(time);
  return loop_.run(observer).cause == SteppingEnd::Cause::reached;
}

bool CoarseRun::track(double time, const Control& control, double apart, std::size_t most,
                      const std::function<void(const State&)>& look, WindowTrack& track) {
  CoarseObserver observer(control, evaluations() + most, [&](const State& s) {
    corrected_.sample(s);
    track.times.push_back(s.time);
    const bool due = s.time >= read_at_ + apart || s.time >= time;
    track.readings.push_back(due ? reader_.read(s) : std::vector<double>());
    if (!due) return;
    read_at_ = s.time;
    look(s);
  });
  loop_.move_end(time);
  if (loop_.run(observer).cause != SteppingEnd::Cause::reached) return false;
  track.end = loop_.state();
  return true;
}

bool CoarseRun::follow(const WindowTrack& other, const Control& control, WindowTrack& track) {
  const std::size_t most = evaluations() + most_evaluations(other);
  for (std::size_t i = 0; i < other.times.size(); ++i) {
    if (!to(other.times[i], control, most)) return false;
    track.times.push_back(other.times[i]);
    track.readings.push_back(other.readings[i].empty() ? std::vector<double>() : read());
  }
  track.end = state();
  return true;
}

void CoarseRun::charge(std::vector<std::size_t>& evaluations) {
  const std::size_t stepped = this->evaluations() - charged_, sampled = corrected_.samples() - samples_charged_;
  evaluations[corrected_.low()] += stepped + sampled;
  evaluations[corrected_.high()] += sampled;
  charged_ += stepped;
  samples_charged_ += sampled;
}

}  // namespace withy::study
