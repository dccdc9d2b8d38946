/// \file
/// Sensing of equations that are one of several at a state.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "withy/core/plugin/sampled_part.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// That of the equations that hold at the state observed.
class ChosenSensing final : public SensedState, public SensedLoads {
 public:
  /// \param all not empty. \param choose the index that holds at a state
  ChosenSensing(std::vector<std::unique_ptr<SensedState>> all, std::function<std::size_t(const State&)> choose)
      : all_(std::move(all)), choose_(std::move(choose)), now_(all_.front().get()) {}
  bool observe(const State& state) noexcept override {
    now_ = all_[choose_(state)].get();
    return now_->observe(state);
  }
  const Layout& layout() const noexcept override { return now_->layout(); }
  double time() const noexcept override { return now_->time(); }
  std::span<const double> y() const noexcept override { return now_->y(); }
  std::span<const double> accelerations() noexcept override { return now_->accelerations(); }
  Vector3 gravity() const noexcept override { return now_->gravity(); }
  FrameMotion motion(FrameIndex frame) noexcept override { return now_->motion(frame); }
  FrameAcceleration acceleration(FrameIndex frame) noexcept override { return now_->acceleration(frame); }
  std::span<const double> load_efforts(int load) noexcept override { return now_->load_efforts(load); }
  std::span<const double> motion_efforts() noexcept override { return now_->motion_efforts(); }
  Wrench reaction(int hinge) noexcept override { return now_->reaction(hinge); }
  SectionLoad section(std::size_t index) noexcept override { return now_->section(index); }
  BodyEnergies energies(int body) noexcept override { return now_->energies(body); }
  const Energies& energies() noexcept override { return now_->energies(); }
  double given(std::size_t load, std::size_t number, std::span<const double> y) noexcept override {
    return dynamic_cast<SensedLoads&>(*now_).given(load, number, y);
  }
  std::span<const double> numbers(std::size_t load) noexcept override {
    return dynamic_cast<SensedLoads&>(*now_).numbers(load);
  }

 private:
  std::vector<std::unique_ptr<SensedState>> all_;
  std::function<std::size_t(const State&)> choose_;
  SensedState* now_;
};

}  // namespace withy
