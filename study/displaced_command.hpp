/// \file
/// A load whose command can be displaced: what others measure of it, and nothing else.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "withy/core/plugin/load.hpp"

namespace withy::study {

/// All of a load as it is, but that the loads which name it measure so much more than it gives as an element of
/// State::y says: in the equations of small motions the place where a loop is opened.
class DisplacedCommand final : public BoundLoad, public LoadOutput {
 public:
  /// \param load one with a LoadOutput
  /// \param element index in State::y
  DisplacedCommand(std::shared_ptr<const BoundLoad> load, std::size_t element)
      : load_(std::move(load)), element_(element) {}

  [[nodiscard]] std::size_t scratch() const override { return load_->scratch(); }
  void add(double t, std::span<const double> positions, std::span<const double> speeds, std::span<double> efforts,
           std::span<double> scratch) const noexcept override {
    load_->add(t, positions, speeds, efforts, scratch);
  }
  bool add_derivatives(double t, std::span<const double> positions, std::span<const double> speeds,
                       Eigen::Ref<Eigen::MatrixXd> by_position, Eigen::Ref<Eigen::MatrixXd> by_speed) const override {
    return load_->add_derivatives(t, positions, speeds, by_position, by_speed);
  }
  [[nodiscard]] std::span<const FrameIndex> frames() const override { return load_->frames(); }
  void wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept override {
    load_->wrenches(t, motions, wrenches);
  }
  [[nodiscard]] std::vector<double> discontinuities() const override { return load_->discontinuities(); }
  [[nodiscard]] const DiscretePart* discrete() const override { return load_->discrete(); }
  [[nodiscard]] const ContinuousPart* continuous() const override { return load_->continuous(); }
  [[nodiscard]] const LoadOutput* output() const override { return this; }
  [[nodiscard]] const InputPort* input() const override { return load_->input(); }
  [[nodiscard]] double end() const override { return load_->end(); }
  void begin(State& state) const override { load_->begin(state); }
  [[nodiscard]] std::unique_ptr<BoundLoad> rebound(const Model& model, const Terms& terms) const override {
    std::unique_ptr<BoundLoad> load = load_->rebound(model, terms);
    return load == nullptr ? nullptr : std::make_unique<DisplacedCommand>(std::move(load), element_);
  }

  [[nodiscard]] std::size_t outputs() const override { return load_->output()->outputs(); }
  [[nodiscard]] bool needs_accelerations() const override { return load_->output()->needs_accelerations(); }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    load_->output()->read(view, values);
    for (double& value : values) value += view.y[element_];
  }

 private:
  std::shared_ptr<const BoundLoad> load_;
  std::size_t element_;
};

}  // namespace withy::study
