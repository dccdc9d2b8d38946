/// \file
/// Momentum and kinetic energy of a flexible body's own mass: the integrals of mass_table.hpp, rotary_terms.hpp and
/// rod_terms.hpp without their accelerations.
#pragma once

#include "withy/core/kinematics/observed_node.hpp"
#include "withy/core/sweep/rod/rotary_terms.hpp"
#include "withy/core/sweep/symmetric/straight_mass.hpp"

namespace withy::observed {

/// Of a part about its node's frame, in that frame's axes.
template <class Space>
struct PartMomentum {
  typename Space::Twist h = Space::Twist::zero();             ///< (∫ r × v; ∫ v)
  typename Space::Position moment = Space::Position::zero();  ///< ∫ r
  typename Space::Scalar mass = 0, kinetic = 0;
};

/// Adds a group of particles: r, their velocities v beside those that V.v gives; both times the weights of the mass.
/// `m`: the weights of the constant function.
template <class Space>
requires(Space::angular == 1) inline void add_particles(const typename Space::Twist& V, const typename Space::Group& m,
                                                        const typename Space::Group* r, const typename Space::Group* v,
                                                        PartMomentum<Space>& part) {
  const auto w = spread(V.w);
  const auto x = v[0] + m * spread(V.x) - w * r[1], y = v[1] + m * spread(V.y) + w * r[0];
  part.kinetic += 0.5 * sum(x * x + y * y);
  part.h += typename Space::Twist{sum(r[0] * y - r[1] * x), sum(m * x), sum(m * y)};
  part.moment += typename Space::Position{sum(m * r[0]), sum(m * r[1])};
}

template <class Space>
requires(Space::angular == 3) inline void add_particles(const typename Space::Twist& V, const typename Space::Group& m,
                                                        const typename Space::Group* r, const typename Space::Group* v,
                                                        PartMomentum<Space>& part) {
  using Triple = typename Space::Triple;
  const auto wx = V.w[0], wy = V.w[1], wz = V.w[2];
  const auto x = v[0] + m * spread(V.v[0]) + wy * r[2] - wz * r[1];
  const auto y = v[1] + m * spread(V.v[1]) + wz * r[0] - wx * r[2];
  const auto z = v[2] + m * spread(V.v[2]) + wx * r[1] - wy * r[0];
  part.kinetic += 0.5 * sum(x * x + y * y + z * z);
  part.h += typename Space::Twist{Triple(sum(r[1] * z - r[2] * y), sum(r[2] * x - r[0] * z), sum(r[0] * y - r[1] * x)),
                                  Triple(sum(m * x), sum(m * y), sum(m * z))};
  part.moment += Triple(sum(m * r[0]), sum(m * r[1]), sum(m * r[2]));
}

/// The constant function, whose only weight is that of the first particle.
inline Pack constant_function(double root_mass) {
  Pack m = spread(0.0);
  set_lane(m, 0, root_mass);
  return m;
}
inline Lanes constant_function(const Lanes& root_mass) { return root_mass; }

/// Generalized particles of a body of N modes, or of `modes`.
template <class Space, int N>
inline void add_mass(const sweep::MassTable<Space>& table, int modes, const typename Space::Scalar* q,
                     const typename Space::Scalar* q_dot, const typename Space::Twist& V, typename Space::Group* P,
                     PartMomentum<Space>& part) {
  typename Space::Group m = constant_function(table.root_mass);
  for (std::size_t k = 0; k < table.packs; ++k) {
    const sweep::ParticleMotion<Space, N> x(table, k, modes, q, q_dot, P);
    add_particles<Space>(V, m, x.r, x.v, part);
    m = spread(typename Space::Scalar(0));
  }
  part.mass += table.root_mass * table.root_mass;
}

/// The same of a straight body of several cases, by its products. Flat: half of the integrals are not looked at.
template <class Space, int N>
[[gnu::flatten]] inline void add_straight_mass(const typename Space::Scalar* products, const typename Space::Scalar* q,
                                               const typename Space::Scalar* q_dot, const typename Space::Twist& V,
                                               PartMomentum<Space>& part) {
  using Twist = typename Space::Twist;
  using Scalar = typename Space::Scalar;
  auto I = Space::Inertia::zero();
  Twist C[N], p = Twist::zero();
  Scalar G[N * N], h[N];
  sweep::integrate_straight<Space, N>(products, q, q_dot, V, I, C, G, p, h);
  Twist of_modes = C[0] * q_dot[0];
  for (int i = 1; i < N; ++i) of_modes += C[i] * q_dot[i];
  const Twist of_frame = I * V;
  part.h += of_frame + of_modes;
  part.kinetic += 0.5 * Space::dot(V, of_frame) + Space::dot(V, of_modes);
  for (int i = 0; i < N; ++i) {
    Scalar row = 0.5 * G[i * N + i] * q_dot[i];
    for (int j = 0; j < i; ++j) row += G[i * N + j] * q_dot[j];
    part.kinetic += row * q_dot[i];
  }
  part.moment += typename Space::Position{I.wy, -I.wx};
  part.mass += products[sweep::StraightMass<N>::m];
}

/// Rotary inertia J t tᵀ of four sections with angular velocity V.w + ω.
inline void add_turning(const Pack& J, const sweep::PackVector& t, const sweep::PackVector& omega,
                        const Spatial::Twist& V, PartMomentum<Spatial>& part) {
  const Pack rate =
      t[0] * (omega[0] + spread(V.w[0])) + t[1] * (omega[1] + spread(V.w[1])) + t[2] * (omega[2] + spread(V.w[2]));
  const Pack roll = J * rate;
  part.kinetic += 0.5 * sum(roll * rate);
  part.h.w += Triple(sum(roll * t[0]), sum(roll * t[1]), sum(roll * t[2]));
}

/// θ = Ψq + ½qᵀΘq and θ̇ of group k of sections.
template <class Space, class S>
inline void section_angles(const sweep::RotaryTable<Space>& table, std::size_t k, int n, const S* q, const S* q_dot,
                           typename Space::Group* theta, typename Space::Group* rate) {
  constexpr int A = Space::angular;
  const typename Space::Group* field = table.fields.data() + k * table.stride;
  for (int c = 0; c < A; ++c) theta[c] = rate[c] = spread(S(0));
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < A; ++c, ++field) {
      theta[c] += *field * spread(q[i]);
      rate[c] += *field * spread(q_dot[i]);
    }
  }
  for (const sweep::FieldRun& run : table.runs) {
    const int i = run.row;
    for (int j = run.first; j < run.last; ++j, ++field) {
      theta[run.component] += *field * spread((i == j ? 0.5 : 1.0) * q[i] * q[j]);
      rate[run.component] += *field * spread(i == j ? q[i] * q_dot[i] : q_dot[i] * q[j] + q[i] * q_dot[j]);
    }
  }
}

template <class S>
inline void add_sections(const sweep::RotaryTable<PlanarOf<S>>& table, int modes, const S* q, const S* q_dot,
                         const typename PlanarOf<S>::Twist& V, PartMomentum<PlanarOf<S>>& part) {
  for (std::size_t k = 0; k < table.packs; ++k) {
    GroupOf<S> theta, rate;
    section_angles(table, k, modes, q, q_dot, &theta, &rate);
    rate += spread(V.w);
    const GroupOf<S> roll = table.axes[k].J * rate;
    part.kinetic += 0.5 * sum(roll * rate);
    part.h.w += sum(roll);
  }
}

inline void add_sections(const sweep::RotaryTable<Spatial>& table, int modes, const double* q, const double* q_dot,
                         const Spatial::Twist& V, PartMomentum<Spatial>& part) {
  using sweep::PackVector;
  const auto times = [](const PackVector& v, const Pack& s) { return PackVector{v[0] * s, v[1] * s, v[2] * s}; };
  const bool apart = table.frame.apart;
  const Spatial::Twist V_here = apart ? Spatial::to_child(table.frame.X, V) : V;
  PartMomentum<Spatial> sections;
  for (std::size_t k = 0; k < table.packs; ++k) {
    PackVector theta, rate;
    section_angles(table, k, modes, q, q_dot, theta.c, rate.c);
    const sweep::PackExponential e(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]);
    const PackVector x = cross(theta, rate);
    const PackVector omega = rate + times(x, e.b) + times(cross(theta, x), e.c);
    for (std::size_t j = 0; j < table.axes_each; ++j) {
      const auto& axis = table.axes[k * table.axes_each + j];
      const PackVector fixed{axis.e[0], axis.e[1], axis.e[2]}, y = cross(theta, fixed);
      add_turning(axis.J, fixed + times(y, e.a) + times(cross(theta, y), e.b), omega, V_here, sections);
    }
  }
  part.kinetic += sections.kinetic;
  part.h += apart ? Spatial::to_parent(table.frame.X, sections.h) : sections.h;
}

/// A rod at the state that `work` holds.
inline void add_rod(const sweep::RodKinematics<Planar>& rod, const sweep::RodWork& work, int n, const double* q_dot,
                    const Planar::Twist& V, PartMomentum<Planar>& part) {
  using Rod = sweep::RodKinematics<Planar>;
  const int packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const Pack m = rod.integrals.root_mass[static_cast<std::size_t>(k)];
    const Pack* y = work.value + k;
    Pack r[2], v[2];
    for (int c = 0; c < 2; ++c) {
      r[c] = m * y[c * packs];
      v[c] = spread(0.0);
      for (int i = 0; i < n; ++i) v[c] += y[(Rod::P(n) + 2 * i + c) * packs] * spread(q_dot[i]);
      v[c] = m * v[c];
    }
    add_particles<Planar>(V, m, r, v, part);
  }
  part.mass += rod.integrals.mass;
  if (rod.rotary.empty()) return;
  // ½ (1, q̇ᵀ) J (1, q̇) with the rates of the sections about the normal, V.w + Σ ψ_i q̇_i.
  const double *of_modes = rod.rotary.data() + 1, *gram = of_modes + n;
  double h = rod.rotary[0] * V.w, along = 0;
  for (int i = 0; i < n; ++i) {
    h += of_modes[i] * q_dot[i];
    double row = of_modes[i] * V.w;
    for (int j = 0; j < n; ++j) row += gram[i * n + j] * q_dot[j];
    along += row * q_dot[i];
  }
  part.h.w += h;
  part.kinetic += 0.5 * (V.w * h + along);
}

inline void add_rod(const sweep::RodKinematics<Spatial>& rod, const sweep::RodWork& work, int n, const double* q_dot,
                    const Spatial::Twist& V, PartMomentum<Spatial>& part) {
  using Rod = sweep::RodKinematics<Spatial>;
  const int packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const Pack m = rod.integrals.root_mass[static_cast<std::size_t>(k)];
    const Pack* y = work.value + k;
    Pack r[3], v[3];
    sweep::PackVector omega;
    for (int c = 0; c < 3; ++c) {
      r[c] = m * y[c * packs];
      v[c] = omega[c] = spread(0.0);
      for (int i = 0; i < n; ++i) {
        v[c] += y[(Rod::P(n) + 3 * i + c) * packs] * spread(q_dot[i]);
        omega[c] += y[(Rod::w + 3 * i + c) * packs] * spread(q_dot[i]);
      }
      v[c] = m * v[c];
    }
    add_particles<Spatial>(V, m, r, v, part);
    for (std::size_t j = 0; j < rod.axes_each; ++j) {
      const Pack& J = rod.axes[static_cast<std::size_t>(k) * rod.axes_each + j].J;
      add_turning(J, sweep::inertia_axis(rod, n, k, j, work), omega, V, part);
    }
  }
  part.mass += rod.integrals.mass;
}

}  // namespace withy::observed
