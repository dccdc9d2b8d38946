/// \file
/// A continuous load made digital: its efforts are computed at equal intervals and held in between (zero-order hold).
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "withy/core/plugin/parameters.hpp"
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

/// A controller of hinges with a sample-and-hold. Its discrete states are the efforts on the coordinates it follows.
class Sampled final : public BoundLoad, public DiscretePart, public LoadNumbers {
 public:
  Sampled(std::unique_ptr<TrackingLoad> controller, double period)
      : controller_(std::move(controller)), period_(period) {}

  std::size_t scratch() const override { return controller_->scratch(); }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> /*efforts*/, std::span<double> /*scratch*/) const noexcept override {}
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // held efforts do not change with the state
  }
  std::vector<double> discontinuities() const override { return {}; }  // they are seen at the samples alone
  const DiscretePart* discrete() const override { return this; }
  double end() const override { return controller_->end(); }
  void begin(State& state) const override { controller_->begin(state); }

  std::vector<SensorColumn> numbers() const override { return controller_->numbers(); }
  /// The efforts that are held, the rest of the state as it is.
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    controller_->show(view, values);
    std::copy(view.discrete.begin(), view.discrete.end(), values.begin());
  }

  std::size_t states() const override { return controller_->axes().size(); }
  double period() const override { return period_; }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& /*crossing*/,
             std::span<double> discrete, std::span<double> scratch) const noexcept override {
    controller_->commands(t, positions, speeds, discrete, scratch);
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    for (std::size_t i = 0; i < controller_->axes().size(); ++i) efforts[controller_->axes()[i].speed] += discrete[i];
  }

 private:
  std::unique_ptr<TrackingLoad> controller_;
  double period_;  ///< [s]
};

/// The controller itself where `period` is 0.
inline std::unique_ptr<BoundLoad> sampled(std::unique_ptr<TrackingLoad> controller, double period) {
  if (!(period > 0)) return controller;
  return std::make_unique<Sampled>(std::move(controller), period);
}

}  // namespace withy
