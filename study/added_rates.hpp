/// \file
/// Equations of motion with something known added to their rates.
#pragma once

#include <vector>

#include "withy/core/plugin/forwarding_equations.hpp"

namespace withy::study {

/// ẏ = f(t, y) + d(t), where d does not depend on y: an implicit step of f is one of these too. Of one thread.
/// Everything but y is read as other equations of the same model read it.
class AddedRates : public ForwardingEquations, private LinearlyImplicit {
 public:
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override;
  /// None: those on the way are of f alone.
  bool found_efforts(Work& /*work*/, std::span<double> /*loads*/,
                     std::span<double> /*motions*/) const noexcept override {
    return false;
  }
  [[nodiscard]] const LinearlyImplicit* linearly_implicit() const override {
    return implicit_ != nullptr ? this : nullptr;
  }
  /// None: d is not linearized.
  [[nodiscard]] const Linearization* linearization() const override { return nullptr; }
  Evaluation position_rates(double t, std::span<const double> y, std::span<double> y_dot,
                            Work& work) const noexcept override {
    return derivatives(t, y, y_dot, work);
  }

 protected:
  /// \param f which the integrator's work belongs to; `reader` reads energies, poses and deflections. They must outlive
  /// this.
  AddedRates(const EquationsOfMotion& f, const EquationsOfMotion& reader)
      : f_(f), reader_(reader), implicit_(f.linearly_implicit()), base_(f.size()) {}

 private:
  /// sum += factor · d(t)
  virtual void add(double t, double factor, std::span<double> sum) const noexcept = 0;

  [[nodiscard]] const EquationsOfMotion& own() const noexcept override { return f_; }
  [[nodiscard]] const EquationsOfMotion& seen() const noexcept override { return reader_; }
  [[nodiscard]] Work make_factors() const override { return implicit_->make_factors(); }
  Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept override {
    return implicit_->factorize(y, delta, factors);
  }
  void solve(std::span<double> r, Work& factors) const noexcept override { implicit_->solve(r, factors); }
  /// ẏ = ẏ′ + d with z = (base + δ d) + δ ẏ′.
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override;

  const EquationsOfMotion& f_;
  const EquationsOfMotion& reader_;
  const LinearlyImplicit* implicit_;  ///< of f
  mutable std::vector<double> base_;
};

}  // namespace withy::study
