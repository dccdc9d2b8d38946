#include "withy/study/coarse_run.hpp"

#include <limits>

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

CoarseRun::CoarseRun(const Prepared& prepared, const EquationsOfMotion& equations, const Outputs& outputs,
                     const Integrator& integrator, const State& start, double end)
    : reader_(outputs, prepared.model(), equations),
      loop_(prepared.model(), equations, integrator.start(equations, start),
            {.end = end, .output = end - start.time + 1}),
      read_at_(-std::numeric_limits<double>::infinity()) {}

bool CoarseRun::to(double time, const Control& control, std::size_t most) {
  CoarseObserver observer(control, most, {});
  loop_.move_end(time);
  return loop_.run(observer).cause == SteppingEnd::Cause::reached;
}

bool CoarseRun::track(double time, const Control& control, double apart, WindowTrack& track) {
  CoarseObserver observer(control, std::numeric_limits<std::size_t>::max(), [&](const State& s) {
    track.times.push_back(s.time);
    const bool due = s.time >= read_at_ + apart || s.time >= time;
    track.readings.push_back(due ? reader_.read(s) : std::vector<double>());
    if (due) read_at_ = s.time;
  });
  loop_.move_end(time);
  if (loop_.run(observer).cause != SteppingEnd::Cause::reached) return false;
  track.end = loop_.state();
  return true;
}

}  // namespace withy::study
