/// \file
/// A continuous load made digital: its efforts are computed at equal intervals and held in between (zero-order hold).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "withy/core/plugin/digital_part.hpp"
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/parameters.hpp"
#include "withy/core/simulation/same_instant.hpp"
#include "withy/loads/tracking.hpp"

namespace withy {

inline ParameterSpec sample_parameter() {
  return number("sample", "s",
                "period of a digital controller, which holds its efforts between samples; continuous where left out")
      .above(0)
      .optional();
}

/// The period [s] given, 0 where none is.
inline double sample_period(const Value& p) {
  const Value* period = p.find("sample");
  return period == nullptr ? 0.0 : period->number();
}

/// Whether an instant of the clock of this period [s] falls on a time [s].
inline bool at_sample(double t, double period) noexcept { return same_instant(std::round(t / period) * period, t); }

/// A controller of hinges with a sample-and-hold. Its discrete states are whether it has begun, what it told at the
/// last sample, and the efforts on the coordinates it follows.
class Sampled final : public EffortlessLoad, public DiscretePart, public DigitalPart, public LoadNumbers {
 public:
  Sampled(std::unique_ptr<TrackingLoad> controller, double period)
      : controller_(std::move(controller)),
        axes_(controller_->axes().size()),
        told_(controller_->numbers().size() - axes_),
        period_(period) {}

  std::size_t scratch() const override { return controller_->scratch(); }
  using EffortlessLoad::add;
  const DiscretePart* discrete() const override { return this; }
  double end() const override { return controller_->end(); }
  void begin(State& state) const override { controller_->begin(state); }

  std::vector<SensorColumn> numbers() const override { return controller_->numbers(); }
  /// The efforts that are held, errors and margins of the last sample.
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> efforts = view.discrete.last(axes_), told = view.discrete.subspan(1, told_);
    std::copy(efforts.begin(), efforts.end(), values.begin());
    std::copy(told.begin(), told.end(), values.begin() + static_cast<std::ptrdiff_t>(axes_));
    controller_->finish(values.subspan(axes_));
  }

  std::size_t states() const override { return 1 + told_ + axes_; }
  double period() const override { return period_; }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& crossing,
             std::span<double> discrete, std::span<double> scratch) const noexcept override {
    if (crossing.begins && !at_sample(t, period_)) return pass_idle(discrete);  // it waits for its clock
    discrete[0] = 1;
    controller_->tell(t, positions, speeds, discrete.subspan(1, told_));
    controller_->commands(t, positions, speeds, discrete.last(axes_), scratch);
  }
  void pass_idle(std::span<double> discrete) const noexcept override {
    std::fill(discrete.begin(), discrete.end(), 0.0);
  }
  bool waits(std::span<const double> discrete) const override { return discrete[0] == 0; }
  bool gives_steps() const override { return false; }
  std::size_t told() const override { return 1 + told_; }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    for (std::size_t i = 0; i < axes_; ++i) efforts[controller_->axes()[i].speed] += discrete[1 + told_ + i];
  }

 private:
  std::unique_ptr<TrackingLoad> controller_;
  std::size_t axes_;  ///< count of coordinates that it follows
  std::size_t told_;  ///< numbers beside the efforts
  double period_;     ///< [s]
};

/// The controller itself where `period` is 0.
inline std::unique_ptr<BoundLoad> sampled(std::unique_ptr<TrackingLoad> controller, double period) {
  if (!(period > 0)) return controller;
  return std::make_unique<Sampled>(std::move(controller), period);
}

}  // namespace withy
