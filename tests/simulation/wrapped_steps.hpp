/// \file
/// An integrator that steps as another does, for tests of what it does else.
#pragma once

#include <memory>
#include <utility>

#include "withy/core/plugin/integrator.hpp"

namespace withy::test {

/// The steps of another stepper.
class WrappedSteps : public Stepper {
 public:
  explicit WrappedSteps(std::unique_ptr<Stepper> own) : own_(std::move(own)) {}
  StepResult step(double t_limit) override { return own_->step(t_limit); }
  const State& state() const override { return own_->state(); }
  void interpolate(double t, std::span<double> y) const override { own_->interpolate(t, y); }
  void restart() override { own_->restart(); }
  void jump(const State& state) override { own_->jump(state); }
  std::vector<double> memory() const override { return own_->memory(); }
  void resume(const State& state, std::span<const double> memory) override { own_->resume(state, memory); }
  const StepStatistics& statistics() const override { return own_->statistics(); }

 private:
  std::unique_ptr<Stepper> own_;
};

/// Another integrator with its steps in these; it says nothing of loops, as one that knows of none.
template <class Steps>
class WrappedIntegrator final : public Integrator {
 public:
  explicit WrappedIntegrator(std::shared_ptr<const Integrator> other) : other_(std::move(other)) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<Steps>(other_->start(equations, state));
  }
  int order() const override { return other_->order(); }

 private:
  std::shared_ptr<const Integrator> other_;
};

}  // namespace withy::test
