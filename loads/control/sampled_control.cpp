#include <algorithm>
#include <cmath>

#include "withy/core/model/signal_source.hpp"
#include "withy/core/plugin/digital_part.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/loads/control/bound_control.hpp"

namespace withy {
namespace {

/// By the clock. Discrete states: whether it has begun, the block's states and memory, and commands from the one that
/// acts to the one just made, later by the delay.
class SampledControl : public BoundControl, public DiscretePart, public SampledPart, public DigitalPart {
 public:
  SampledControl(const Model& model, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : BoundControl(model, std::move(ends), std::move(block)),
        shown_(this->block().states().size()),
        count_(shown_ + this->block().memory()) {
    for (const std::string& name : names()) sources_.push_back(find_signal(model, name));  // throws where there is none
    sees_inputs_ = std::all_of(sources_.begin(), sources_.end(), [](const SignalSource& s) {
      return s.kind == SignalSource::Kind::position || s.kind == SignalSource::Kind::rate;
    });
    if (!sees_inputs_) show_states_alone();
  }

  std::size_t scratch() const override { return names().size(); }
  const DiscretePart* discrete() const override { return this; }
  std::vector<double> discontinuities() const override { return {}; }  // seen at the samples alone
  std::size_t states() const override { return 1 + count_ + (ends().delay + 1) * outputs(); }
  double period() const override { return ends().sample; }
  void renew(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
             const Crossing& /*crossing*/, std::span<double> /*discrete*/,
             std::span<double> /*scratch*/) const noexcept override {}
  std::vector<std::string> measures() const override { return names(); }
  void renew_measured(double t, const Crossing& crossing, std::span<const double> w,
                      std::span<double> discrete) const noexcept override {
    const std::span<double> z = discrete.subspan(1, count_), queue = discrete.subspan(1 + count_);
    // Switched off and on between two samples it has met none while it was off, and what it knew is of before.
    if (crossing.begins) discrete[0] = 0;
    // What begins between two samples waits for the next: nothing is on its way for less than the delay.
    if (crossing.begins && ends().delay > 0 && !at_sample(t)) return;
    if (discrete[0] == 0) block().begin(t, w, z);
    discrete[0] = 1;
    const std::size_t p = outputs();
    // At a sample's instant commands have moved up already, before what switches it on.
    if (!crossing.begins) std::copy(queue.begin() + static_cast<std::ptrdiff_t>(p), queue.end(), queue.begin());
    block().sample(t, w, z, queue.last(p));
  }
  bool waits(std::span<const double> discrete) const override { return discrete[0] == 0; }
  bool gives_steps() const override { return block().gives_steps(); }
  bool draws() const override { return block().draws(); }
  void pass_idle(std::span<double> discrete) const noexcept override {
    const std::span<double> queue = discrete.subspan(1 + count_);
    std::copy(queue.begin() + static_cast<std::ptrdiff_t>(outputs()), queue.end(), queue.begin());
    for (double& command : queue.last(outputs())) command = 0;
    discrete[0] = 0;  // what it knew is of before
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    act(discrete.subspan(1 + count_, outputs()), efforts);
  }
  void add_wrenches(double /*t*/, std::span<const double> discrete, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    act_at_frames(discrete.subspan(1 + count_, outputs()), motions, wrenches);
  }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> v = view.discrete.subspan(1 + count_, outputs());
    std::copy(v.begin(), v.end(), values.begin());
  }
  /// The command that acts, what the block shows of the state as it is, its states since the last sample.
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> z = view.discrete.subspan(1, shown_);
    read(view, values.first(outputs()));
    std::copy(z.begin(), z.end(), values.end() - static_cast<std::ptrdiff_t>(shown_));
    if (!sees_inputs_) return;
    for (std::size_t i = 0; i < sources_.size(); ++i)
      view.scratch[i] = sources_[i].kind == SignalSource::Kind::rate ? view.speeds()[sources_[i].index]
                                                                     : view.positions()[sources_[i].index];
    block().show(view.t, view.scratch.first(sources_.size()), z, values.subspan(outputs()));
  }
  using BoundControl::add;

 protected:
  /// Of all discrete states those of the block.
  [[nodiscard]] std::span<const double> of_block(std::span<const double> discrete) const {
    return discrete.subspan(1, count_);
  }

 private:
  [[nodiscard]] bool at_sample(double t) const noexcept {
    const double samples = t / ends().sample;
    return std::abs(samples - std::round(samples)) <= 1e-9 * std::max(1.0, std::abs(samples));
  }
  std::size_t shown_;  ///< states of the block
  std::size_t count_;  ///< with its memory
  std::vector<SignalSource> sources_;
  bool sees_inputs_ = false;  ///< all are coordinates and rates
};

/// By the clock, with a law that is not the engine's own.
class ForeignControl final : public SampledControl, public ForeignLaw {
 public:
  using SampledControl::SampledControl;
  std::string failure(std::span<const double> discrete) const override {
    return block().foreign()->failure(of_block(discrete));
  }
  std::string refusal(std::span<const double> discrete) const override {
    return block().foreign()->refusal(of_block(discrete));
  }
  void forget() const override { block().foreign()->forget(); }
};

}  // namespace

std::unique_ptr<BoundLoad> make_sampled_control(const Model& model, const ControlEnds& ends,
                                                const std::shared_ptr<const ControlBlock>& block) {
  if (block->foreign() != nullptr) return std::make_unique<ForeignControl>(model, ends, block);
  return std::make_unique<SampledControl>(model, ends, block);
}

}  // namespace withy
