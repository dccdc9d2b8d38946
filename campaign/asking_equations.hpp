/// \file
/// Equations of motion whose evaluations somebody else makes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"

namespace withy::campaign {

/// Those of a model, but that `derivatives` asks: a run with them stops in the middle of a step and goes on when it has
/// been answered. The equations must outlive it.
class AskingEquations : public EquationsOfMotion, public ForwardDynamics {
 public:
  /// Of equations that take efforts, as all that have lanes do.
  explicit AskingEquations(const EquationsOfMotion& own)
      : own_(own), forward_(dynamic_cast<const ForwardDynamics&>(own)) {}

  [[nodiscard]] const Layout& layout() const override { return own_.layout(); }
  [[nodiscard]] Work make_work() const override { return own_.make_work(); }
  void load_efforts(double t, std::span<const double> y, int load, std::span<double> efforts,
                    Work& work) const noexcept override {
    own_.load_efforts(t, y, load, efforts, work);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override {
    return own_.motion_efforts(t, y, efforts, work);
  }
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override {
    return own_.found_efforts(work, loads, motions);
  }
  void inverse_dynamics(std::span<const double> y, std::span<const double> u_dot, std::span<double> efforts,
                        Work& work) const override {
    own_.inverse_dynamics(y, u_dot, efforts, work);
  }
  void mass_times(std::span<const double> y, std::span<const double> a, std::span<double> product,
                  Work& work) const override {
    own_.mass_times(y, a, product, work);
  }
  Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts, std::span<double> u_dot,
                              Work& work) const noexcept override {
    return forward_.forward_dynamics(y, efforts, u_dot, work);
  }
  [[nodiscard]] const LinearlyImplicit* linearly_implicit() const override { return own_.linearly_implicit(); }
  [[nodiscard]] const Linearization* linearization() const override { return own_.linearization(); }
  Evaluation position_rates(double t, std::span<const double> y, std::span<double> y_dot,
                            Work& work) const noexcept override {
    return own_.position_rates(t, y, y_dot, work);
  }
  void normalize(std::span<double> y) const noexcept override { own_.normalize(y); }
  [[nodiscard]] std::unique_ptr<Observation> make_observation() const override { return own_.make_observation(); }
  [[nodiscard]] std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override;
  [[nodiscard]] DenseSystem system(double t, std::span<const double> y) const override { return own_.system(t, y); }
  [[nodiscard]] Energies energies(std::span<const double> y) const override { return own_.energies(y); }
  [[nodiscard]] WorldPose frame_pose(std::span<const double> y, int body, int frame) const override {
    return own_.frame_pose(y, body, frame);
  }
  [[nodiscard]] std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const override {
    return own_.deflection(y, body, frame);
  }
  [[nodiscard]] std::vector<std::string> savings() const override { return own_.savings(); }

 private:
  const EquationsOfMotion& own_;
  const ForwardDynamics& forward_;
};

}  // namespace withy::campaign
