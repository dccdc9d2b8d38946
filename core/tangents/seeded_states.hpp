/// \file
/// States of hinges and bodies in numbers that carry derivatives: what the passes of TangentDynamics start from.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "withy/core/tangents/recursion.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

/// Which directions the derivatives of one pass are along, at most 8: directions 0 … n−1 are displacements, then
/// speeds, then accelerations.
struct TangentDynamics::Seeds {
  std::span<const std::size_t> directions;
  /// Of the derivatives the one along a direction; the count of them where it is not among them.
  [[nodiscard]] std::size_t place(std::size_t direction) const {
    const auto found = std::find(directions.begin(), directions.end(), direction);
    return static_cast<std::size_t>(found - directions.begin());
  }
  /// Whether any of `count` directions from `from` on is among them.
  [[nodiscard]] bool meet(std::size_t from, std::size_t count) const {
    return std::any_of(directions.begin(), directions.end(),
                       [&](std::size_t d) { return d >= from && d < from + count; });
  }
};

/// States of hinges and bodies in numbers T, double or Jet.
template <class T>
struct TangentDynamics::Builder {
  const TangentDynamics& dynamics;
  std::span<const double> y;
  const Eigen::VectorXd& a;
  Seeds seeds;
  bool at_rest = false;  ///< all speeds count as zero

  /// `value`, with a unit derivative along direction `direction`.
  [[nodiscard]] T seeded(double value, std::size_t direction) const {
    T x(value);
    if constexpr (std::is_same_v<T, Jet>) {
      if (const std::size_t i = seeds.place(direction); i < seeds.directions.size()) x.derivatives()[i] = 1;
    }
    return x;
  }
  [[nodiscard]] std::size_t speeds() const { return dynamics.model_->layout().speeds; }

  [[nodiscard]] analysis::HingeState<T> hinge(std::size_t h) const {
    const Layout& layout = dynamics.model_->layout();
    const Slot& slot = layout.hinges[h];
    const Hinge& hinge = *dynamics.model_->hinges()[h].hinge;
    const auto n = static_cast<Eigen::Index>(slot.speeds);
    const auto x = y.subspan(slot.position, slot.positions);
    const std::vector<double> none(at_rest ? slot.speeds : 0, 0.0);
    const auto rates = at_rest ? std::span<const double>(none) : y.subspan(layout.positions + slot.speed, slot.speeds);
    HingeMotion m;
    m.H.resize(6, n);
    hinge.motion(x, rates, m);
    analysis::HingeState<T> s{m.pose.R.cast<T>(),
                              m.pose.p.cast<T>(),
                              m.H.cast<T>(),
                              m.bias.cast<T>(),
                              Eigen::Matrix<T, Eigen::Dynamic, 1>(n),
                              Eigen::Matrix<T, Eigen::Dynamic, 1>(n)};
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::size_t at = slot.speed + static_cast<std::size_t>(k);
      s.rates[k] = at_rest ? T(0.0) : seeded(rates[static_cast<std::size_t>(k)], speeds() + at);
      s.accelerations[k] = seeded(a[static_cast<Eigen::Index>(at)], 2 * speeds() + at);
    }
    if constexpr (std::is_same_v<T, Jet>) differentiate(hinge, slot, x, rates, m, s);
    return s;
  }

  /// Fills in the derivatives of pose, H and bias.
  void differentiate(const Hinge& hinge, const Slot& slot, std::span<const double> x, std::span<const double> rates,
                     const HingeMotion& m, analysis::HingeState<Jet>& s) const {
    const std::size_t n = slot.speeds;
    for (std::size_t k = 0; k < n; ++k) {
      if (const std::size_t i = seeds.place(slot.speed + k); i < seeds.directions.size()) {
        const auto set = [&](auto& target, const auto& derivative) {
          for (Eigen::Index e = 0; e < target.size(); ++e) target(e).derivatives()[i] = derivative(e);
        };
        const auto column = m.H.col(static_cast<Eigen::Index>(k));
        set(s.R, Matrix3(m.pose.R * skew<double>(Vector3(column.template head<3>()))));
        set(s.p, Vector3(m.pose.R * column.template tail<3>()));
        HingeMotion derivative;
        derivative.H.resize(6, static_cast<Eigen::Index>(n));
        hinge.motion_derivative(x, rates, k, derivative);
        set(s.H, derivative.H);
        set(s.bias, derivative.bias);
      }
      if (const std::size_t i = seeds.place(speeds() + slot.speed + k); i < seeds.directions.size()) {
        // The bias is a quadratic form of the rates, b(u, u): its derivative is 2 b(u, e) = b(u+e, u+e) − b(u, u) −
        // b(e, e).
        std::vector<double> unit(n, 0.0), sum(rates.begin(), rates.end());
        unit[k] = 1;
        sum[k] += 1;
        HingeMotion along, both;
        along.H.resize(6, static_cast<Eigen::Index>(n));
        both.H.resize(6, static_cast<Eigen::Index>(n));
        hinge.motion(x, unit, along);
        hinge.motion(x, sum, both);
        const Vector6 derivative = both.bias - m.bias - along.bias;
        for (Eigen::Index e = 0; e < 6; ++e) s.bias[e].derivatives()[i] = derivative[e];
      }
    }
  }

  /// q, q̇, q̈ of a body. Which of them a truncation keeps is the caller's.
  [[nodiscard]] analysis::BodyState<T> body(std::size_t b) const {
    const Layout& layout = dynamics.model_->layout();
    analysis::BodyState<T> s;
    s.order = dynamics.terms_[b].strain;
    s.rod = dynamics.rods_[b].get();
    const Slot* slot = dynamics.slots_[b];
    const auto n = static_cast<Eigen::Index>(slot != nullptr ? slot->speeds : 0);
    s.q.resize(n), s.q_dot.resize(n), s.q_ddot.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t at = slot->speed + static_cast<std::size_t>(i);
      s.q[i] = seeded(y[slot->position + static_cast<std::size_t>(i)], at);
      s.q_dot[i] = at_rest ? T(0.0) : seeded(y[layout.positions + at], speeds() + at);
      s.q_ddot[i] = seeded(a[static_cast<Eigen::Index>(at)], 2 * speeds() + at);
    }
    s.plain = std::is_same_v<T, Jet> && (slot == nullptr || (!seeds.meet(slot->speed, slot->speeds) &&
                                                             !seeds.meet(speeds() + slot->speed, slot->speeds)));
    return s;
  }

  [[nodiscard]] std::vector<analysis::HingeState<T>> hinges() const {
    std::vector<analysis::HingeState<T>> all;
    for (std::size_t h = 0; h < dynamics.model_->hinges().size(); ++h) all.push_back(hinge(h));
    return all;
  }
  /// Bodies with q, q̇ zero where `undeformed` says so.
  template <class Undeformed>
  [[nodiscard]] std::vector<analysis::BodyState<T>> bodies(Undeformed&& undeformed) const {
    std::vector<analysis::BodyState<T>> all;
    for (std::size_t b = 0; b < dynamics.model_->bodies().size(); ++b) {
      all.push_back(body(b));
      if (!undeformed(b)) continue;
      all.back().q.setZero();
      all.back().q_dot.setZero();
    }
    return all;
  }
};
}  // namespace withy
