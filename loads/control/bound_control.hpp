/// \file
/// What continuous and sampled controllers have in common.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/changing_law.hpp"
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/loads/control/control_load.hpp"

namespace withy {

/// A controller of one model: what it measures by name, and where it acts. It adds nothing by itself.
class BoundControl : public EffortlessLoad, public LoadOutput, public LoadNumbers, public ChangingLaw {
 public:
  /// \throws std::invalid_argument where the ends do not fit the model or the block.
  BoundControl(const Model& model, ControlEnds ends, std::shared_ptr<const ControlBlock> block);

  std::span<const FrameIndex> frames() const override { return frames_; }
  void wrenches(double /*t*/, std::span<const FrameMotion> /*motions*/,
                std::span<Wrench> wrenches) const noexcept override;
  double end() const override { return block_->end(); }
  const LoadOutput* output() const override { return this; }
  std::size_t outputs() const override { return block_->outputs(); }
  /// Commands, what the block shows, its states.
  std::vector<SensorColumn> numbers() const override { return numbers_; }
  bool changes_gain() const override { return block_->changes_gain(); }

 protected:
  [[nodiscard]] const ControlEnds& ends() const { return ends_; }
  [[nodiscard]] const ControlBlock& block() const { return *block_; }
  [[nodiscard]] const std::shared_ptr<const ControlBlock>& shared_block() const { return block_; }
  /// Names of what is measured, one an input of the block.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const std::vector<InputPlace>& places() const { return places_; }
  /// Adds the efforts of commands v where they act on speeds, or to the wrenches where at frames.
  void act(std::span<const double> v, std::span<double> efforts) const noexcept;
  void act_at_frames(std::span<const double> v, std::span<const FrameMotion> motions,
                     std::span<Wrench> wrenches) const noexcept;

 private:
  ControlEnds ends_;
  std::shared_ptr<const ControlBlock> block_;
  std::vector<std::string> names_;
  std::vector<InputPlace> places_;
  std::vector<FrameIndex> frames_;
  std::vector<SensorColumn> numbers_;
};

/// The controller of a model by the clock.
std::unique_ptr<BoundLoad> make_sampled_control(const Model& model, const ControlEnds& ends,
                                                const std::shared_ptr<const ControlBlock>& block);

}  // namespace withy
