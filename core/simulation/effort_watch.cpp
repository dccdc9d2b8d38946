#include "withy/core/simulation/effort_watch.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/simulation/cubic.hpp"
#include "withy/core/simulation/integrator_call.hpp"

namespace withy {

EffortWatch::EffortWatch(const Model& model, const EquationsOfMotion& equations, double span, RunSummary& summary)
    : equations_(equations),
      positions_(model.layout().positions),
      speeds_(model.layout().speeds),
      longest_(span / 50),
      rates_(equations.size()),
      rates_before_(equations.size()),
      work_(model.loads().empty() && model.motions().empty() ? Work(0) : equations.make_work()) {
  summary.peak_effort.assign(speeds_, 0.0);
  summary.peak_motion_effort.assign(speeds_, 0.0);
  if (!model.loads().empty()) loads_ = summary.peak_effort;
  if (!model.motions().empty()) motions_ = summary.peak_motion_effort;
  if (idle()) return;
  for (Sample* sample : {&samples_[0], &samples_[1], &samples_[2], &between_}) {
    sample->state.y.resize(equations.size());
    sample->loads.resize(speeds_);
    sample->motions.resize(speeds_);
  }
}

void EffortWatch::evaluate(Sample& sample) {
  const State& state = sample.state;
  if (!loads_.empty()) equations_.load_efforts(state.time, state.y, EquationsOfMotion::all_loads, sample.loads, work_);
  if (!motions_.empty() && !equations_.motion_efforts(state.time, state.y, sample.motions, work_).ok())
    std::fill(sample.motions.begin(), sample.motions.end(), 0.0);
}

void EffortWatch::raise(const Sample& sample) {
  const auto raise_by = [](std::span<double> peaks, const std::vector<double>& efforts) {
    // What is not finite, of a formula that divides by zero, is no effort and no peak: the run ends there.
    for (std::size_t i = 0; i < peaks.size(); ++i)
      if (const double size = std::abs(efforts[i]); std::isfinite(size)) peaks[i] = std::max(peaks[i], size);
  };
  raise_by(loads_, sample.loads);
  raise_by(motions_, sample.motions);
}

/// Of the sample between the last three those efforts that they resolve.
void EffortWatch::raise_resolved() {
  // Three states of a vibration that all have less than a tenth of its peak are fewer than two a period.
  constexpr double far = 10;
  const auto cut = [&](std::vector<double> Sample::*efforts) {
    for (std::size_t i = 0; i < (between_.*efforts).size(); ++i) {
      double greatest = 0;
      for (const Sample& seen : samples_) greatest = std::max(greatest, std::abs((seen.*efforts)[i]));
      if (double& effort = (between_.*efforts)[i]; greatest > 0 && std::abs(effort) > far * greatest) effort = 0;
    }
  };
  cut(&Sample::loads);
  cut(&Sample::motions);
  raise(between_);
}

void EffortWatch::begin_at(const State& state) {
  if (idle()) return;
  count_ = 1;
  Sample& sample = samples_[newest_];
  sample.state = state;
  evaluate(sample);
  raise(sample);
}

void EffortWatch::push(const Stepper& stepper) {
  newest_ = (newest_ + 1) % samples_.size();
  count_ = std::min(count_ + 1, samples_.size());
  Sample& sample = samples_[newest_];
  sample.state = stepper.state();
  Work* const evaluated = stepper.evaluated();
  if (evaluated == nullptr || !equations_.found_efforts(*evaluated, sample.loads, sample.motions)) evaluate(sample);
  raise(sample);
}

void EffortWatch::observe(const Stepper& stepper) {
  if (idle() || count_ == 0) return;
  const double before = back(0).state.time, step = stepper.state().time - before;
  if (step > longest_) {
    const double parts = std::ceil(step / longest_);
    for (double i = 1; i < parts; ++i) {
      between_.state.time = before + step * (i / parts);
      interpolate_step(stepper, between_.state.time, between_.state.y);
      evaluate(between_);
      raise(between_);
    }
  }
  push(stepper);
  if (count_ < samples_.size() || !hides_a_peak()) return;
  look_between(back(2), back(1));
  look_between(back(1), back(0));
}

/// Whether the parabola through an effort's size at the last three states rises above what has been seen.
bool EffortWatch::hides_a_peak() const {
  const Sample &first = back(2), &middle = back(1), &last = back(0);
  const double h1 = middle.state.time - first.state.time, h2 = last.state.time - middle.state.time;
  if (!(h1 > 0) || !(h2 > 0)) return false;
  constexpr double worthwhile = 1 + 1e-6;
  const auto rises = [&](double at_first, double at_middle, double at_last, double peak) {
    if (at_middle == 0) return false;  // most have no effort at all
    const double a = std::abs(at_first), b = std::abs(at_middle), c = std::abs(at_last);
    if (b < a || b < c || (b == a && b == c)) return false;
    const double up = (b - a) / h1, down = (b - c) / h2;
    const double bend = (up + down) / (h1 + h2), slope = (up * h2 - down * h1) / (h1 + h2);
    return bend > 0 && b + slope * slope / (4 * bend) > worthwhile * peak;
  };
  for (std::size_t i = 0; i < loads_.size(); ++i)
    if (rises(first.loads[i], middle.loads[i], last.loads[i], loads_[i])) return true;
  for (std::size_t i = 0; i < motions_.size(); ++i)
    if (rises(first.motions[i], middle.motions[i], last.motions[i], motions_[i])) return true;
  return false;
}

/// Within a step: positions on the cubic through those at its ends and their rates, the rest on the line.
void EffortWatch::look_between(const Sample& before, const Sample& after) {
  const std::size_t moving = equations_.layout().moving();
  const std::vector<double>&x = before.state.y, &y = after.state.y;
  const double h = after.state.time - before.state.time;
  const bool smooth = equations_.position_rates(before.state.time, x, rates_before_, work_).ok() &&
                      equations_.position_rates(after.state.time, y, rates_, work_).ok();
  constexpr int parts = 4;
  between_.state.y = y;  // with the discrete states
  for (int part = 1; part < parts; ++part) {
    const double s = static_cast<double>(part) / parts;
    between_.state.time = before.state.time + s * h;
    for (std::size_t i = 0; i < positions_; ++i)
      between_.state.y[i] =
          smooth ? cubic(s, x[i], h * rates_before_[i], y[i], h * rates_[i]) : (1 - s) * x[i] + s * y[i];
    for (std::size_t i = positions_; i < moving; ++i) between_.state.y[i] = (1 - s) * x[i] + s * y[i];
    equations_.normalize(between_.state.y);
    evaluate(between_);
    raise_resolved();
  }
}

void EffortWatch::remember(Memory& memory) {
  memory(newest_);
  memory(count_);
  for (double& peak : loads_) memory(peak);
  for (double& peak : motions_) memory(peak);
  if (idle()) return;
  for (Sample& sample : samples_) {
    memory(sample.state.time);
    memory(sample.state.y);
    memory(sample.loads);
    memory(sample.motions);
  }
}

}  // namespace withy
