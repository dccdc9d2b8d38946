#include <algorithm>

#include "withy/core/model/signal_source.hpp"
#include "withy/core/plugin/digital_part.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/loads/control/bound_control.hpp"
#include "withy/loads/sampled.hpp"

namespace withy {
namespace {

/// By the clock. Discrete states: what the block told of itself at the last sample, whether it has begun, the block's
/// states and memory, and commands from the one that acts to the one just made, later by the delay.
class SampledControl : public BoundControl, public DiscretePart, public SampledPart, public DigitalPart {
 public:
  SampledControl(const Model& model, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : BoundControl(model, std::move(ends), std::move(block)),
        told_(this->block().shown().size()),
        shown_(this->block().states().size()),
        count_(shown_ + this->block().memory()),
        queue_((this->ends().delay + 1) * outputs()) {
    for (const std::string& name : names()) static_cast<void>(find_signal(model, name));  // throws where there is none
  }

  std::size_t scratch() const override { return 0; }
  const DiscretePart* discrete() const override { return this; }
  std::vector<double> discontinuities() const override { return {}; }  // seen at the samples alone
  std::size_t states() const override { return told_ + 1 + count_ + queue_; }
  double period() const override { return ends().sample; }
  void renew(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
             const Crossing& /*crossing*/, std::span<double> /*discrete*/,
             std::span<double> /*scratch*/) const noexcept override {}
  std::vector<std::string> measures() const override { return names(); }
  void renew_measured(double t, const Crossing& crossing, std::span<const double> w,
                      std::span<double> discrete) const noexcept override {
    // Switched off and on between two samples it has met none while it was off, and what it knew is of before.
    if (crossing.begins) forget(discrete);
    // What begins between two samples waits for the next: it has no time of its own beside that of its clock.
    if (crossing.begins && !at_sample(t, ends().sample)) return;
    const std::span<double> z = of_block(discrete), queue = commands(discrete);
    if (discrete[told_] == 0) block().begin(t, w, z);
    discrete[told_] = 1;
    const std::size_t p = outputs();
    // At a sample's instant commands have moved up already, before what switches it on.
    if (!crossing.begins) std::copy(queue.begin() + static_cast<std::ptrdiff_t>(p), queue.end(), queue.begin());
    block().tell(t, w, z, discrete.first(told_));
    block().sample(t, w, z, queue.last(p));
  }
  bool waits(std::span<const double> discrete) const override { return discrete[told_] == 0; }
  bool gives_steps() const override { return block().gives_steps(); }
  bool draws() const override { return block().draws(); }
  std::size_t told() const override { return told_; }
  void pass_idle(std::span<double> discrete) const noexcept override {
    const std::span<double> queue = commands(discrete);
    std::copy(queue.begin() + static_cast<std::ptrdiff_t>(outputs()), queue.end(), queue.begin());
    for (double& command : queue.last(outputs())) command = 0;
    forget(discrete);
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    act(acting(discrete), efforts);
  }
  void add_wrenches(double /*t*/, std::span<const double> discrete, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    act_at_frames(acting(discrete), motions, wrenches);
  }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> v = acting(view.discrete);
    std::copy(v.begin(), v.end(), values.begin());
  }
  /// The command that acts, what the block told at the last sample, its states since then.
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<double> shown = values.subspan(outputs(), told_);
    const std::span<const double> z = of_block(view.discrete).first(shown_);
    read(view, values.first(outputs()));
    std::copy_n(view.discrete.begin(), told_, shown.begin());
    block().finish(shown);
    std::copy(z.begin(), z.end(), values.end() - static_cast<std::ptrdiff_t>(shown_));
  }
  using BoundControl::add;

 protected:
  /// Of all discrete states those of the block.
  template <class T>
  [[nodiscard]] std::span<T> of_block(std::span<T> discrete) const noexcept {
    return discrete.subspan(told_ + 1, count_);
  }

 private:
  template <class T>
  [[nodiscard]] std::span<T> commands(std::span<T> discrete) const noexcept {
    return discrete.subspan(told_ + 1 + count_, queue_);
  }
  [[nodiscard]] std::span<const double> acting(std::span<const double> discrete) const noexcept {
    return commands(discrete).first(outputs());
  }
  /// What it knew is of before; what a delay has on its way goes on.
  void forget(std::span<double> discrete) const noexcept {
    const std::size_t count = ends().delay == 0 ? discrete.size() : told_ + 1 + count_;
    std::fill_n(discrete.begin(), count, 0.0);
  }

  std::size_t told_;   ///< numbers beside commands and states
  std::size_t shown_;  ///< states of the block
  std::size_t count_;  ///< with its memory
  std::size_t queue_;  ///< commands
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
