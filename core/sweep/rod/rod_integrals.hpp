/// \file
/// Integrals along a rod of exact kinematics, over panels of Gauss's nodes, four nodes a Pack.
#pragma once

#include <vector>

#include "withy/core/deformation/rod_table.hpp"
#include "withy/core/sweep/mass_table.hpp"

namespace withy::sweep {

/// Integrals along a rod, of functions stored one after the other, each `packs` packs of values at the nodes.
///
/// A panel's nodes x_j and x_j′ = −x_j are mirrored, and weights w with them. From its middle on a function that is
/// even has an odd integral and the reverse: with e_j = f_j + f_j′ and o_j = f_j′ − f_j of the lower half's nodes j and
/// T = Σ w_j e_j, all of the panel, the integrals to a node of the upper half and to its mirror image are
///   y, y′ = ½ T + Σ M_j o_j ± Σ D_j e_j,   M_j = ½ (S_j′ − S_j),   D_j = ½ (S_j + S_j′ − w_j),
/// with S_j what node j gives to the upper one: half of the products that S takes.
struct RodIntegrals {
  int packs = 0;                              ///< nodes / 4; 0: no rod
  int packs_per_panel = 0;                    ///< 4 or 2
  SharedNumbers<Pack> from_even;              ///< of the first panel, D_j of the packs of the upper half, j after j
  SharedNumbers<Pack> from_odd;               ///< the same of M_j
  SharedNumbers<Pack> weights;                ///< of the first panel's lower half
  SharedNumbers<double> scale;                ///< lengths of the panels over that of the first
  std::vector<SharedNumbers<Pack>> stations;  ///< ∫₀ˣ to each station, weights of all nodes
  SharedNumbers<Pack> root_mass;              ///< square roots of the nodes' masses
  std::vector<double> station_x;              ///< where the stations are [m]
  double mass = 0;

  RodIntegrals() = default;
  RodIntegrals(const RodTable& table, const std::vector<double>& station_x);

  /// y = ∫₀ˣ f at the nodes.
  void integrate(const Pack* f, Pack* y, int functions) const {
    if (packs_per_panel == RodTable::order / static_cast<int>(lanes)) {
      integrate_over<RodTable::order / static_cast<int>(lanes)>(f, y, functions);
    } else {
      integrate_over<RodTable::short_order / static_cast<int>(lanes)>(f, y, functions);
    }
  }

 private:
  /// Over panels of so many packs.
  template <int m>
  void integrate_over(const Pack* f, Pack* y, int functions) const {
    int function = 0;
    for (; function + 2 <= functions; function += 2) integrate<2, m>(f + function * packs, y + function * packs);
    if (function < functions) integrate<1, m>(f + function * packs, y + function * packs);
  }

  /// Of so many functions at once, which share what is read of D and M.
  template <int count, int m>
  void integrate(const Pack* f, Pack* y) const {
    constexpr int h = m / 2, half = h * static_cast<int>(lanes);  // packs and nodes of half a panel
    double before[count] = {};
    for (int panel = 0; panel < packs; panel += m) {
      const Pack length = spread(scale[static_cast<std::size_t>(panel / m)]);
      double even[count][half], odd[count][half];
      Pack sums[count][h], differences[count][h];
      for (int i = 0; i < count; ++i) {
        const Pack* at = f + i * packs + panel;
        Pack all = spread(0.0);
        for (int k = 0; k < h; ++k) {
          const Pack lower = at[k] * length, upper = mirrored(at[m - 1 - k]) * length;
          const Pack e = lower + upper;
          all += weights[static_cast<std::size_t>(k)] * e;
          store(e, even[i] + 4 * k);
          store(upper - lower, odd[i] + 4 * k);
        }
        const double total = sum(all);
        for (Pack& p : sums[i]) p = spread(before[i] + 0.5 * total);
        for (Pack& p : differences[i]) p = spread(0.0);
        before[i] += total;
      }
      const Pack *D = from_even.data(), *M = from_odd.data();
      for (int j = 0; j < half; ++j, D += h, M += h) {
        for (int i = 0; i < count; ++i) {
          const Pack e = spread(even[i][j]), o = spread(odd[i][j]);
          for (int k = 0; k < h; ++k) {
            differences[i][k] += D[k] * e;
            sums[i][k] += M[k] * o;
          }
        }
      }
      for (int i = 0; i < count; ++i) {
        Pack* at = y + i * packs + panel;
        for (int k = 0; k < h; ++k) {
          at[h + k] = sums[i][k] + differences[i][k];
          at[h - 1 - k] = mirrored(sums[i][k] - differences[i][k]);
        }
      }
    }
  }

 public:
  /// ∫₀ˣ f to a station.
  [[nodiscard]] double to(std::size_t station, const Pack* f) const {
    const SharedNumbers<Pack>& w = stations[station];
    Pack total = spread(0.0);
    for (std::size_t k = 0; k < w.size(); ++k) total += w[k] * f[k];
    return sum(total);
  }
};

}  // namespace withy::sweep
