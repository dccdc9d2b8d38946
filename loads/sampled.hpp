/// \file
/// A continuous load made digital: its efforts are computed at equal intervals and held in between (zero-order hold).
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/parameters.hpp"

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

/// A controller of hinges with a sample-and-hold. Its discrete states are the efforts on the speeds it acts on.
class Sampled final : public BoundLoad, public DiscretePart {
 public:
  /// \param speeds indices of the speeds that `controller` acts on, of `all_speeds`
  Sampled(std::unique_ptr<BoundLoad> controller, double period, std::vector<std::size_t> speeds, std::size_t all_speeds)
      : controller_(std::move(controller)), period_(period), speeds_(std::move(speeds)), all_speeds_(all_speeds) {}

  std::size_t scratch() const override { return all_speeds_ + controller_->scratch(); }
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

  std::size_t states() const override { return speeds_.size(); }
  double period() const override { return period_; }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& /*crossing*/,
             std::span<double> discrete, std::span<double> scratch) const noexcept override {
    const auto efforts = scratch.first(all_speeds_);
    std::fill(efforts.begin(), efforts.end(), 0.0);
    controller_->add(t, positions, speeds, efforts, scratch.subspan(all_speeds_));
    for (std::size_t i = 0; i < speeds_.size(); ++i) discrete[i] = efforts[speeds_[i]];
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    for (std::size_t i = 0; i < speeds_.size(); ++i) efforts[speeds_[i]] += discrete[i];
  }

 private:
  std::unique_ptr<BoundLoad> controller_;
  double period_;  ///< [s]
  std::vector<std::size_t> speeds_;
  std::size_t all_speeds_;
};

/// The controller itself where `period` is 0.
inline std::unique_ptr<BoundLoad> sampled(std::unique_ptr<BoundLoad> controller, double period,
                                          std::vector<std::size_t> speeds, std::size_t all_speeds) {
  if (!(period > 0)) return controller;
  return std::make_unique<Sampled>(std::move(controller), period, std::move(speeds), all_speeds);
}

}  // namespace withy
