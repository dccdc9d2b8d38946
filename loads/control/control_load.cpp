#include "withy/loads/control/control_load.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/kinematics/signals.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/loads/control/bound_control.hpp"

namespace withy {
namespace {

std::unique_ptr<BoundLoad> make_continuous(const Model& model, const Terms& terms, const ControlEnds& ends,
                                           const std::shared_ptr<const ControlBlock>& block);

/// In continuous time: the block's states are the load's.
class ContinuousControl : public BoundControl, public ContinuousPart, public CourseOfTime {
 public:
  ContinuousControl(const Model& model, const Terms& terms, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : BoundControl(model, std::move(ends), std::move(block)),
        signals_(model, terms, names()),
        states_(this->block().states()),
        course_(dynamic_cast<const CourseOfTime*>(&this->block())) {
    for (std::size_t i = 0; i < signals_.size(); ++i) along_.push_back(speed_along(model, signals_.element(i)));
    for (std::size_t i = 0; i < this->block().inputs(); ++i) commands_at_once_ |= this->block().feeds_through(i);
    for (const InputPlace& place : places()) acts_on_speeds_ |= place.speed >= 0;
    follow_accelerations();
  }

  std::size_t courses() const override { return course_ == nullptr ? 0 : course_->courses(); }
  void course(double t, std::span<double> values) const noexcept override { course_->course(t, values); }
  std::size_t scratch() const override { return block().inputs() + block().outputs() + signals_.scratch(); }
  bool needs_accelerations() const override { return follows_accelerations_; }

  std::unique_ptr<BoundLoad> rebound(const Model& model, const Terms& terms) const override {
    if (!signals_.of_frames() && !signals_.of_loads()) return nullptr;
    return make_continuous(model, terms, ends(), shared_block());
  }
  const ContinuousPart* continuous() const override { return this; }
  std::vector<double> discontinuities() const override { return block().discontinuities(); }
  std::size_t states() const override { return states_.size(); }
  std::string name(std::size_t state) const override { return states_[state]; }
  void begin(const LoadView& view, std::span<double> continuous) const noexcept override {
    block().begin(view.t, measure(view), continuous);
  }
  void rates(const LoadView& view, std::span<double> rates) const noexcept override {
    block().rates(view.t, measure(view), view.continuous, rates);
  }
  void add(const LoadView& view, std::span<double> efforts) const noexcept override {
    if (acts_on_speeds_) act(command(view), efforts);
  }
  void add_wrenches(const LoadView& view, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    act_at_frames(command(view), motions, wrenches);
  }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> v = command(view);
    std::copy(v.begin(), v.end(), values.begin());
  }
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> w = measure(view);
    block().output(view.t, w, view.continuous, values.first(outputs()));
    const std::span<double> told = values.subspan(outputs(), values.size() - outputs() - states_.size());
    block().tell(view.t, w, view.continuous, told);
    block().finish(told);
    std::copy(view.continuous.begin(), view.continuous.end(), values.end() - std::ssize(states_));
  }
  bool add_derivatives(const LoadView& view, ContinuousDerivatives& to) const override {
    if (std::any_of(along_.begin(), along_.end(), [](int speed) { return speed < 0; })) return false;
    const auto m = static_cast<Eigen::Index>(block().inputs()), p = static_cast<Eigen::Index>(block().outputs()),
               k = static_cast<Eigen::Index>(states_.size()), acting = static_cast<Eigen::Index>(places().size());
    ControlBlock::Slopes s{Eigen::MatrixXd::Zero(k, m), Eigen::MatrixXd::Zero(k, k), Eigen::MatrixXd::Zero(p, m),
                           Eigen::MatrixXd::Zero(p, k)};
    if (!block().slopes(view.t, measure(view), view.continuous, s)) return false;
    to.rate_by_state += s.rate_by_state;
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto input = static_cast<std::size_t>(j);
      const bool rate = signals_.element(input)->rate;
      (rate ? to.rate_by_speed : to.rate_by_position).col(along_[input]) += s.rate_by_input.col(j);
      for (Eigen::Index i = 0; i < acting; ++i) {
        const int speed = places()[static_cast<std::size_t>(i)].speed;
        if (speed >= 0)
          (rate ? to.effort_by_speed : to.effort_by_position)(speed, along_[input]) += s.output_by_input(i, j);
      }
    }
    for (Eigen::Index i = 0; i < acting; ++i) {
      const int speed = places()[static_cast<std::size_t>(i)].speed;
      if (speed >= 0) to.effort_by_state.row(speed) += s.output_by_state.row(i);
    }
    return true;
  }
  using BoundControl::add;
  using BoundControl::add_derivatives;
  using BoundControl::begin;

 private:
  /// What is measured, in the scratch space.
  std::span<const double> measure(const LoadView& view) const noexcept {
    const std::span<double> w = view.scratch.first(block().inputs());
    LoadView behind = view;
    behind.scratch = view.scratch.subspan(block().inputs() + block().outputs());
    signals_.read(behind, w);
    return w;
  }
  [[nodiscard]] std::span<const double> command(const LoadView& view) const noexcept {
    const std::span<double> w = view.scratch.first(block().inputs()),
                            v = view.scratch.subspan(block().inputs(), block().outputs());
    if (commands_at_once_) {
      measure(view);
    } else {
      std::fill(w.begin(), w.end(), 0.0);  // measuring may take longer than all else, and these change nothing
    }
    block().output(view.t, w, view.continuous, v);
    return v;
  }
  /// The speed that a signal is, or along which alone it changes; −1 where there is no such one.
  static int speed_along(const Model& model, const std::optional<Signals::Element>& element) {
    if (!element) return -1;
    if (element->rate) return static_cast<int>(element->index);
    for (std::size_t h = 0; h < model.hinges().size(); ++h) {
      const Slot& slot = model.layout().hinges[h];
      const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
      // Where all rates are derivatives of coordinates a displacement along one moves that coordinate alone.
      const bool plain = slot.positions == slot.speeds &&
                         std::all_of(rates.begin(), rates.end(), [](const HingeRate& r) { return bool(r.coordinate); });
      for (std::size_t i = 0; plain && i < rates.size(); ++i)
        if (slot.position + *rates[i].coordinate == element->index) return static_cast<int>(slot.speed + i);
    }
    return -1;
  }

  /// What is commanded may depend on accelerations at once where nothing acts by it at once.
  void follow_accelerations() {
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      if (!signals_.needs_accelerations(i) || !block().feeds_through(i)) continue;
      follows_accelerations_ = true;
      const std::string& name = names()[i];
      if (ends().acts)
        throw std::invalid_argument(
            "signal '" + name + "' depends on accelerations, and the effort follows it at once: the loop " + name +
            " -> this load -> accelerations -> " + name +
            " is algebraic; give this load a 'sample', so that it measures with the effort held before, or put a "
            "filter between: one that measures '" +
            name + "' with 'to: nothing' for this load to measure, or an actuator that measures this load");
    }
  }

  Signals signals_;
  std::vector<std::string> states_;
  const CourseOfTime* course_;          ///< of the block; null: none
  std::vector<int> along_;              ///< one a signal
  bool follows_accelerations_ = false;  ///< what it commands does, at once
  bool commands_at_once_ = false;       ///< what it commands depends on what is measured then, not on states alone
  bool acts_on_speeds_ = false;         ///< not at frames alone
};

/// The same with a law that is not the engine's own. It has no discrete states to fail in.
class ForeignContinuous final : public ContinuousControl, public ForeignLaw {
 public:
  using ContinuousControl::ContinuousControl;
  std::string failure(std::span<const double> discrete) const override { return block().foreign()->failure(discrete); }
  std::string refusal(std::span<const double> discrete) const override { return block().foreign()->refusal(discrete); }
  void forget() const override { block().foreign()->forget(); }
};

std::unique_ptr<BoundLoad> make_continuous(const Model& model, const Terms& terms, const ControlEnds& ends,
                                           const std::shared_ptr<const ControlBlock>& block) {
  if (block->foreign() != nullptr) return std::make_unique<ForeignContinuous>(model, terms, ends, block);
  return std::make_unique<ContinuousControl>(model, terms, ends, block);
}

class Control final : public Load {
 public:
  Control(ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : ends_(std::move(ends)), block_(std::move(block)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    if (ends_.sample > 0) return make_sampled_control(model, ends_, block_);
    return make_continuous(model, Terms{}, ends_, block_);
  }

 private:
  ControlEnds ends_;
  std::shared_ptr<const ControlBlock> block_;
};

}  // namespace

std::unique_ptr<Load> make_control(ControlEnds ends, std::shared_ptr<const ControlBlock> block) {
  return std::make_unique<Control>(std::move(ends), std::move(block));
}

}  // namespace withy
