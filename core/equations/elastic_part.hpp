/// \file
/// Stiffness and damping of all bodies, element by element: what evaluations need beside a sweep.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy::equations {

/// K and D over all speeds. Forces and efforts [N m, N], one a speed.
class ElasticPart {
 public:
  /// An element of D, by speeds.
  struct Damper {
    std::size_t i, j;
    double value;
  };
  explicit ElasticPart(const Model& model);
  /// Adds −sign · D u.
  void add_damping(std::span<const double> speeds, std::span<double> efforts, double sign = 1) const noexcept;
  /// Power of damping, −uᵀ D u [W].
  [[nodiscard]] double damping_power(std::span<const double> speeds) const noexcept {
    double power = 0;
    for (const Damper& d : dampers_) power -= speeds[d.i] * d.value * speeds[d.j];
    return power;
  }
  /// The elements that are not zero, by rows.
  [[nodiscard]] const std::vector<Damper>& dampers() const { return dampers_; }
  /// Adds K (q − q_base − δ u_base) and, with `change`, D (u − u_base), without it −D u_base: the difference between
  /// the forces of stiffness and damping at y and at base + δ ẏ but for what is proportional to u̇.
  void add_implicit(std::span<const double> y, std::span<const double> base, double delta, bool change,
                    std::span<double> forces) const noexcept;
  /// Adds δ K r_q + (δ D + δ² K) r_u, r laid out as y.
  void add_coupling(std::span<const double> r, double delta, std::span<double> forces) const noexcept;

 private:
  /// An element of K: speeds of row and column, position of the column.
  struct Spring {
    std::size_t i, j, position;
    double value;
  };
  std::size_t positions_;
  std::vector<Spring> springs_;
  std::vector<Damper> dampers_;
};

}  // namespace withy::equations
