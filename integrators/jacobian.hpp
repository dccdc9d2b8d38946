/// \file
/// What implicit methods share: the Jacobian of ẏ = f(t, y) and linear systems with μ − ∂f/∂y, of positions, speeds and
/// continuous states of loads. What follows them in y has no part in these: discrete states, which are constant, and
/// the work, a quadrature on which nothing depends.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

inline constexpr const char* missing_jacobian = "the formulation has no exact Jacobian: differences took its place";

/// ∂f/∂y at the place where it was last found.
class StepJacobian {
 public:
  enum class Source { exact, differences };

  /// Differences serve where the equations have no exact one.
  StepJacobian(const EquationsOfMotion& equations, Source wanted)
      : equations_(equations),
        linearization_(wanted == Source::exact ? equations.linearization() : nullptr),
        missing_(wanted == Source::exact && linearization_ == nullptr),
        positions_(static_cast<Eigen::Index>(equations.layout().positions)),
        speeds_(static_cast<Eigen::Index>(equations.layout().speeds)),
        size_(static_cast<Eigen::Index>(equations.layout().moving())),
        values_(Eigen::VectorXd::Zero(size() * size())),
        moved_(Eigen::ArrayXd::Zero(all())),
        slope_(Eigen::ArrayXd::Zero(all())) {
    std::size_t integrals = 0;
    for (const std::vector<Slot>* slots : {&equations.layout().hinges, &equations.layout().bodies}) {
      for (const Slot& s : *slots)
        if (slots == &equations.layout().bodies || s.positions <= 1)
          integrals += s.positions == s.speeds ? s.positions : 0;
    }
    second_order_ = integrals == equations.layout().positions && positions_ == speeds_ && positions_ > 0 &&
                    equations.layout().continuous == 0;
    if (second_order_) map().topRightCorner(positions_, speeds_).setIdentity();
  }

  /// Finds it at (t, y) where ẏ is `slope` and h is the step at hand; `evaluate(t, y, slope)` as OneStep's.
  /// \param least  no difference is taken over less, where a number of size one has one over more: near rest a part of
  ///               what is there is nothing but rounding
  template <class Values, class Evaluate>
  Evaluation update(double t, double h, const Values& y, const Eigen::ArrayXd& slope, Evaluate&& evaluate,
                    double least = 0) {
    moved_ = y;
    if (linearization_ != nullptr) {
      const auto n = static_cast<std::size_t>(moved_.size());
      return linearization_->jacobian(t, {moved_.data(), n}, {slope.data(), n},
                                      {values_.data(), static_cast<std::size_t>(values_.size())});
    }
    const double root = std::sqrt(std::numeric_limits<double>::epsilon());
    for (Eigen::Index j = 0; j < size(); ++j) {
      const double here = moved_[j];
      double scale = std::max(std::abs(here), std::abs(h * slope[j]));
      if (!(scale > 0)) scale = 1;
      moved_[j] = here + std::max(root * scale, std::min(least, root));
      const Evaluation e = evaluate(t, moved_, slope_);
      if (!e.ok()) return e;
      const Eigen::Index first = second_order_ ? positions_ : 0;
      map().col(j).tail(size() - first) =
          ((slope_ - slope) / (moved_[j] - here)).matrix().segment(first, size() - first);
      moved_[j] = here;
    }
    return {};
  }

  void remember(Memory& memory) { memory(values_); }

  /// Positions, speeds and continuous states of loads.
  [[nodiscard]] Eigen::Index size() const { return size_; }
  /// Speeds and continuous states.
  [[nodiscard]] Eigen::Index rates() const { return size_ - positions_; }
  /// Of y.
  [[nodiscard]] Eigen::Index all() const { return static_cast<Eigen::Index>(equations_.size()); }
  [[nodiscard]] Eigen::Index positions() const { return positions_; }
  [[nodiscard]] Eigen::Index speeds() const { return speeds_; }
  /// ẋ = u throughout, and nothing else: systems have the size of the speeds alone.
  [[nodiscard]] bool second_order() const { return second_order_; }
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> matrix() const { return {values_.data(), size(), size()}; }
  [[nodiscard]] std::vector<std::string> remarks() const {
    if (!missing_) return {};
    return {missing_jacobian};
  }

 private:
  Eigen::Map<Eigen::MatrixXd> map() { return {values_.data(), size(), size()}; }

  const EquationsOfMotion& equations_;
  const Linearization* linearization_;
  bool missing_, second_order_ = false;
  Eigen::Index positions_, speeds_, size_;
  Eigen::VectorXd values_;
  Eigen::ArrayXd moved_, slope_;
};

inline ParameterSpec jacobian_parameter() {
  return text("jacobian", "where the iteration's Jacobian comes from")
      .one_of({"exact", "differences"})
      .otherwise("differences");
}
inline StepJacobian::Source jacobian_source(const Value& p) {
  return p.at("jacobian").text() == "exact" ? StepJacobian::Source::exact : StepJacobian::Source::differences;
}

/// Factors of μ − ∂f/∂y. Where ẋ = u throughout and ∂u̇/∂(x, u) = (A, B), they are those of μ − B − A/μ:
///   μ z_x − z_u = r_x, −A z_x + (μ − B) z_u = r_u  give  (μ − B − A/μ) z_u = r_u + A r_x/μ.
template <class Scalar>
class ShiftedSystem {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit ShiftedSystem(const StepJacobian& jacobian)
      : jacobian_(jacobian), matrix_(Matrix::Identity(rows(), rows())), lu_(matrix_), right_(Vector::Zero(rows())) {}

  void factorize(Scalar mu) {
    mu_ = mu;
    const auto J = jacobian_.matrix();
    const Eigen::Index n = jacobian_.speeds();
    if (jacobian_.second_order()) {
      matrix_ =
          -(J.bottomRightCorner(n, n).template cast<Scalar>() + J.bottomLeftCorner(n, n).template cast<Scalar>() / mu);
    } else {
      matrix_ = -J.template cast<Scalar>();
    }
    matrix_.diagonal().array() += mu;
    lu_.compute(matrix_);
  }
  /// μ.
  [[nodiscard]] Scalar shift() const { return mu_; }
  /// Replaces r by the solution.
  void solve(Vector& r) const {
    if (!jacobian_.second_order()) {
      right_ = lu_.solve(r);
      r = right_;
      return;
    }
    const Eigen::Index n = jacobian_.speeds();
    const auto A = jacobian_.matrix().bottomLeftCorner(n, n);
    r.head(n) /= mu_;
    right_ = r.tail(n);
    for (Eigen::Index j = 0; j < n; ++j) right_ += A.col(j).template cast<Scalar>() * r[j];
    r.tail(n) = lu_.solve(right_);
    r.head(n) += r.tail(n) / mu_;
  }

 private:
  [[nodiscard]] Eigen::Index rows() const { return jacobian_.second_order() ? jacobian_.speeds() : jacobian_.size(); }
  const StepJacobian& jacobian_;
  Scalar mu_ = 1;
  Matrix matrix_;
  Eigen::PartialPivLU<Matrix> lu_;
  mutable Vector right_;
};

// Compiled once, in collocation.cpp.
extern template class ShiftedSystem<double>;
extern template class ShiftedSystem<std::complex<double>>;

}  // namespace withy
