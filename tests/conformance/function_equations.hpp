/// \file
/// Equations of motion given by functions: test problems for integrators and the run loop.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/dynamics/equations.hpp"

namespace withy {

/// ẏ = f(t, y), y being positions, speeds and work. What is not given stands for a system of unit mass without
/// energies, frames or deflections.
class FunctionEquations : public EquationsOfMotion {
 public:
  using Function = std::function<Evaluation(double t, std::span<const double> y, std::span<double> y_dot)>;

  FunctionEquations(std::size_t positions, std::size_t speeds, Function f) : derivatives_(std::move(f)) {
    layout_.positions = positions;
    layout_.speeds = speeds;
    for (std::size_t i = 0; i < speeds; ++i) layout_.speed_names.push_back("speed." + std::to_string(i));
  }
  FunctionEquations(Layout layout, Function f) : derivatives_(std::move(f)), layout_(std::move(layout)) {}

  const Layout& layout() const override { return layout_; }
  Work make_work() const override { return Work(64); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot, Work&) const noexcept override {
    Evaluation evaluation = derivatives_(t, y, y_dot);
    if (system_) evaluation.determinant_sign = determinant_sign(system_(t, y));
    return evaluation;
  }
  void normalize(std::span<double> y) const noexcept override {
    if (normalize_) normalize_(y);
  }
  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work&) const noexcept override {
    for (double& e : efforts) e = 0;
    if (load_efforts_) load_efforts_(t, y, load, efforts);
  }
  Evaluation motion_efforts(double, std::span<const double>, std::span<double> efforts, Work&) const noexcept override {
    for (double& e : efforts) e = 0;
    return {};
  }
  void inverse_dynamics(std::span<const double>, std::span<const double>, std::span<double>, Work&) const override {}
  void mass_times(std::span<const double>, std::span<const double>, std::span<double>, Work&) const override {}
  DenseSystem system(double t, std::span<const double> y) const override {
    if (system_) return system_(t, y);
    DenseSystem s{layout_.speeds, std::vector<double>(layout_.speeds * layout_.speeds),
                  std::vector<double>(layout_.speeds), std::vector<double>(layout_.speeds)};
    for (std::size_t i = 0; i < layout_.speeds; ++i) s.mass[i * (layout_.speeds + 1)] = 1;
    return s;
  }
  Energies energies(std::span<const double> y) const override { return energies_ ? energies_(y) : Energies{}; }
  WorldPose frame_pose(std::span<const double>, int, int) const override { return {}; }
  std::array<double, 3> deflection(std::span<const double>, int, int) const override { return {}; }
  std::vector<std::string> savings() const override { return {}; }

  std::function<void(std::span<double>)> normalize_;
  std::function<DenseSystem(double, std::span<const double>)> system_;
  std::function<void(double, std::span<const double>, int, std::span<double>)> load_efforts_;
  std::function<Energies(std::span<const double>)> energies_;

 private:
  Function derivatives_;
  Layout layout_;
};

}  // namespace withy
