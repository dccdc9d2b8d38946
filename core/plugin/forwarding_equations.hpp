/// \file
/// Equations of motion that are others', but for what a wrapper of them changes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Forwards all that EquationsOfMotion has: a wrapper overrides what it changes, and nothing new is forgotten.
class ForwardingEquations : public EquationsOfMotion {
 public:
  [[nodiscard]] const Layout& layout() const override { return own().layout(); }
  [[nodiscard]] Work make_work() const override { return own().make_work(); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    return at(y).derivatives(t, y, y_dot, work);
  }
  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work& work) const noexcept override {
    at(y).load_efforts(t, y, load, efforts, work);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override {
    return at(y).motion_efforts(t, y, efforts, work);
  }
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override {
    return own().found_efforts(work, loads, motions);
  }
  void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                        Work& work) const override {
    at(y).inverse_dynamics(y, u_dot, efforts, work);
  }
  void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> product,
                  Work& work) const override {
    at(y).mass_times(y, a, product, work);
  }
  [[nodiscard]] std::optional<double> weight_potential(std::span<const double> y, Work& work) const noexcept override {
    return at(y).weight_potential(y, work);
  }
  [[nodiscard]] const LinearlyImplicit* linearly_implicit() const override { return own().linearly_implicit(); }
  [[nodiscard]] const Linearization* linearization() const override { return own().linearization(); }
  Evaluation position_rates(double t, std::span<const double> y, std::span<double> y_dot,
                            Work& work) const noexcept override {
    return own().position_rates(t, y, y_dot, work);
  }
  void normalize(std::span<double> y) const noexcept override { own().normalize(y); }
  [[nodiscard]] std::unique_ptr<Observation> make_observation() const override { return seen().make_observation(); }
  [[nodiscard]] std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override;
  [[nodiscard]] DenseSystem system(double t, std::span<const double> y) const override { return at(y).system(t, y); }
  [[nodiscard]] Energies energies(std::span<const double> y) const override { return seen().energies(y); }
  [[nodiscard]] WorldPose frame_pose(std::span<const double> y, int body, int frame) const override {
    return seen().frame_pose(y, body, frame);
  }
  [[nodiscard]] std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const override {
    return seen().deflection(y, body, frame);
  }
  [[nodiscard]] std::vector<std::string> savings() const override { return own().savings(); }

 private:
  /// Those that are wrapped.
  [[nodiscard]] virtual const EquationsOfMotion& own() const noexcept = 0;
  /// Those of a state, where a wrapper has several.
  [[nodiscard]] virtual const EquationsOfMotion& at(std::span<const double> /*y*/) const noexcept { return own(); }
  /// Those that tell what is seen of a state: energies, poses, deflections.
  [[nodiscard]] virtual const EquationsOfMotion& seen() const noexcept { return own(); }
};

}  // namespace withy
