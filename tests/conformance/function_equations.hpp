/// \file
/// Equations of motion given by functions: test problems for integrators and the run loop.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// ẏ = f(t, y), y being positions, speeds and work. What is not given stands for a system of unit mass without
/// energies, frames or deflections. To linearly implicit methods it offers the springs of `stiffness_`.
class FunctionEquations : public EquationsOfMotion, public LinearlyImplicit {
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
  const LinearlyImplicit* linearly_implicit() const override { return this; }
  Work make_factors() const override { return Work(sizeof(double)); }
  Evaluation factorize(std::span<const double>, double delta, Work& factors) const noexcept override {
    *reinterpret_cast<double*>(factors.data()) = delta;
    return {};
  }
  void solve(std::span<double> r, Work& factors) const noexcept override {
    const double delta = *reinterpret_cast<const double*>(factors.data());
    for (std::size_t i = 0; i < stiffness_.size(); ++i) {
      double& u = r[layout_.positions + i];
      u = (u - delta * stiffness_[i] * r[i]) / (1 + delta * delta * stiffness_[i]);
      r[i] += delta * u;
    }
  }
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    const Evaluation evaluation = derivatives(t, y, y_dot, work);
    for (std::size_t i = 0; i < stiffness_.size(); ++i) {
      const double u = base[layout_.positions + i], k = stiffness_[i];
      double& rate = y_dot[layout_.positions + i];
      rate = (rate + k * (y[i] - base[i] - delta * u)) / (1 + delta * delta * k);
      if (std::isfinite(y_dot[i])) y_dot[i] = u + delta * rate;
    }
    return evaluation;
  }
  DenseSystem system(double t, std::span<const double> y) const override {
    if (system_) return system_(t, y);
    DenseSystem s{layout_.speeds, std::vector<double>(layout_.speeds * layout_.speeds),
                  std::vector<double>(layout_.speeds), std::vector<double>(layout_.speeds)};
    for (std::size_t i = 0; i < layout_.speeds; ++i) s.mass[i * (layout_.speeds + 1)] = 1;
    return s;
  }
  Energies energies(std::span<const double> y) const override { return energies_ ? energies_(y) : Energies{}; }
  std::unique_ptr<Observation> make_observation() const override { return std::make_unique<Seen>(*this); }
  WorldPose frame_pose(std::span<const double>, int, int) const override { return {}; }
  std::array<double, 3> deflection(std::span<const double>, int, int) const override { return {}; }
  std::vector<std::string> savings() const override { return {}; }

  std::function<void(std::span<double>)> normalize_;
  std::function<DenseSystem(double, std::span<const double>)> system_;
  std::function<void(double, std::span<const double>, int, std::span<double>)> load_efforts_;
  std::function<Energies(std::span<const double>)> energies_;
  /// k_i [1/s²]: the part of u̇_i that is −k_i x_i, where ẋ_i = u_i; of the first coordinates, the others have none.
  std::vector<double> stiffness_;

 private:
  class Seen final : public Observation {
   public:
    explicit Seen(const FunctionEquations& equations) : equations_(equations), y_(equations.size()) {}
    void observe(std::span<const double> y) noexcept override { std::copy(y.begin(), y.end(), y_.begin()); }
    Energies energies() const noexcept override { return equations_.energies(y_); }
    WorldPose frame_pose(int, int) const noexcept override { return {}; }
    WorldVelocity frame_velocity(int, int) const noexcept override { return {}; }
    double turning(int) const noexcept override { return 0; }
    std::array<double, 3> deflection(int, int) const noexcept override { return {}; }

   private:
    const FunctionEquations& equations_;
    std::vector<double> y_;
  };

  Function derivatives_;
  Layout layout_;
};

}  // namespace withy
