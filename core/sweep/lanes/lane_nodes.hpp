/// \file
/// Nodes of several cases: whether they are alike but for numbers, and a case's numbers in its lane.
#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "withy/core/sweep/symmetric/straight_mass.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy::sweep {

inline void put(std::size_t lane, double from, Lanes& to) { to.set(lane, from); }

inline void put(std::size_t lane, const Triple& from, LaneTriple& to) {
  for (int i = 0; i < 3; ++i) to.c[i].set(lane, from[i]);
}
inline void put(std::size_t lane, const Block& from, LaneBlock& to) {
  for (int j = 0; j < 3; ++j) put(lane, from.c[j], to.c[j]);
}
/// Of a symmetric matrix.
inline void put(std::size_t lane, const Block& from, LaneSymmetric& to) {
  to.xx.set(lane, from(0, 0)), to.xy.set(lane, from(0, 1)), to.xz.set(lane, from(0, 2));
  to.yy.set(lane, from(1, 1)), to.yz.set(lane, from(1, 2)), to.zz.set(lane, from(2, 2));
}

inline void put(std::size_t lane, const Planar::Position& from, PlanarOf<Lanes>::Position& to) {
  to.x.set(lane, from.x), to.y.set(lane, from.y);
}
inline void put(std::size_t lane, const Planar::Twist& from, PlanarOf<Lanes>::Twist& to) {
  for (int i = 0; i < 3; ++i) to[i].set(lane, from[i]);
}
inline void put(std::size_t lane, const Planar::Frame& from, PlanarOf<Lanes>::Frame& to) {
  to.R.c.set(lane, from.R.c), to.R.s.set(lane, from.R.s);
  put(lane, from.p, to.p);
}
inline void put(std::size_t lane, const Planar::Inertia& from, PlanarOf<Lanes>::Inertia& to) {
  to.ww.set(lane, from.ww), to.wx.set(lane, from.wx), to.wy.set(lane, from.wy);
  to.xx.set(lane, from.xx), to.xy.set(lane, from.xy), to.yy.set(lane, from.yy);
}
inline void put(std::size_t lane, const Variation<Planar>& from, Variation<PlanarOf<Lanes>>& to) {
  to.x.set(lane, from.x), to.y.set(lane, from.y), to.J.set(lane, from.J);
}

inline void put(std::size_t lane, const Spatial::Twist& from, SpatialOf<Lanes>::Twist& to) {
  put(lane, from.w, to.w), put(lane, from.v, to.v);
}
inline void put(std::size_t lane, const Spatial::Frame& from, SpatialOf<Lanes>::Frame& to) {
  put(lane, from.R, to.R), put(lane, from.p, to.p);
}
inline void put(std::size_t lane, const Spatial::Inertia& from, SpatialOf<Lanes>::Inertia& to) {
  put(lane, from.A, to.A), put(lane, from.L, to.L), put(lane, from.M, to.M);
}
inline void put(std::size_t lane, const Variation<Spatial>& from, Variation<SpatialOf<Lanes>>& to) {
  put(lane, from.s, to.s), put(lane, from.d, to.d), put(lane, from.o, to.o);
}

template <class From, class To>
void put(std::size_t lane, const std::vector<From>& from, std::vector<To>& to) {
  to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) put(lane, from[i], to[i]);
}

template <class From, class To>
void put(std::size_t lane, const SharedNumbers<From>& from, SharedNumbers<To>& to) {
  to.edit([&](std::vector<To>& numbers) {
    numbers.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) put(lane, from[i], numbers[i]);
  });
}

template <class From, class To>
void put(std::size_t lane, const SharedValue<From>& from, SharedValue<To>& to) {
  if (!from.empty()) to.edit([&](To& value) { put(lane, *from, value); });
}

template <class Space, class Many>
void put(std::size_t lane, const RigidPart<Space>& from, RigidPart<Many>& to) {
  put(lane, from.inertia, to.inertia);
  put(lane, from.mass, to.mass);
  put(lane, from.moment, to.moment);
}

/// Numbers of `count` points that come four a pack, `stride` packs a pack of points, as groups of one point each.
inline void put(std::size_t lane, const SharedNumbers<Pack>& from, std::size_t stride, std::size_t count,
                SharedNumbers<Lanes>& to) {
  to.edit([&](std::vector<Lanes>& numbers) {
    numbers.resize(count * stride);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < stride; ++i)
        numbers[k * stride + i].set(lane, from[(k / lanes) * stride + i][k % lanes]);
    }
  });
}

/// Straight beams of few modes have products in the place of particles.
template <class Space, class Many>
void put(std::size_t lane, const MassTable<Space>& from, MassTable<Many>& to) {
  to.modes = from.modes;
  to.rank = to.packs = from.rank;
  to.second_order = from.second_order, to.straight = from.straight;
  to.stride = from.stride, to.runs = from.runs;
  put(lane, from.root_mass, to.root_mass);
  if constexpr (has_straight_mass<Many, 2>) {
    const auto put_products = [&](const auto& all) {
      to.products.edit([&](std::vector<Lanes>& numbers) {
        numbers.resize(all.size());
        for (std::size_t i = 0; i < all.size(); ++i) numbers[i].set(lane, all[i]);
      });
    };
    if (from.straight && from.modes == 2) return put_products(straight_mass<2>(from));
    if (from.straight && from.modes == 4) return put_products(straight_mass<4>(from));
  }
  put(lane, from.data, from.stride, from.rank, to.data);
}

inline void put(std::size_t lane, const RotaryTable<Planar>& from, RotaryTable<PlanarOf<Lanes>>& to) {
  to.sections = to.packs = from.sections;
  to.runs = from.runs;
  to.stride = from.stride;
  put(lane, from.fields, from.stride, from.sections, to.fields);
  to.axes.edit([&](auto& axes) {
    axes.resize(from.sections);
    for (std::size_t k = 0; k < from.sections; ++k) axes[k].J.set(lane, from.axes[k / lanes].J[k % lanes]);
  });
}

template <class Space, class Many>
void put(std::size_t lane, const JointData<Space>& from, JointData<Many>& to) {
  to.kind = from.kind, to.direction = from.direction, to.driven = from.driven, to.pose_matters = from.pose_matters;
  to.position = from.position, to.positions = from.positions, to.speed = from.speed, to.speeds = from.speeds;
  put(lane, from.reflected, to.reflected);
  put(lane, from.F, to.F);
}

template <class Space, class Many>
void put(std::size_t lane, const SymmetricStation<Space>& from, SymmetricStation<Many>& to) {
  to.loaded = from.loaded, to.has_children = from.has_children;
  put(lane, from.fields.X, to.fields.X);
  put(lane, from.fields.first, to.fields.first);
  put(lane, from.fields.second, to.fields.second);
  put(lane, from.carried, to.carried);
  put(lane, from.J, to.J);
}

template <class Space, class Many>
void put(std::size_t lane, const SymmetricBody<Space>& from, SymmetricBody<Many>& to) {
  put(lane, from.M, to.M);
  put(lane, from.stiffness, to.stiffness), put(lane, from.damping, to.damping);
  put(lane, from.base, to.base);
  put(lane, from.mass, to.mass);
  if constexpr (has_sections<Many>) put(lane, from.rotary, to.rotary);
  put(lane, from.stations, to.stations);
  put(lane, from.C0, to.C0), put(lane, from.G0, to.G0), put(lane, from.I1, to.I1);
  put(lane, from.factor, to.factor), put(lane, from.Y0, to.Y0);
  put(lane, from.reduced, to.reduced);
}

template <class Space, class Many>
void put(std::size_t lane, const SymmetricNode<Space>& from, SymmetricNode<Many>& to) {
  to.body = from.body, to.parent = from.parent, to.parent_station = from.parent_station;
  to.root_station = from.root_station, to.modes = from.modes, to.flavor = from.flavor, to.leaf = from.leaf;
  to.has_children = from.has_children, to.mode_position = from.mode_position, to.mode_speed = from.mode_speed;
  put(lane, from.joint, to.joint);
  put(lane, from.own, to.own);
}

/// All of a node that its numbers do not tell.
template <class Space>
auto structure(const SymmetricNode<Space>& n) {
  const JointData<Space>& j = n.joint;
  return std::tuple(n.body, n.parent, n.parent_station, n.root_station, n.modes, n.flavor, n.leaf, n.has_children,
                    n.mode_position, n.mode_speed, j.kind, j.direction, j.driven, j.pose_matters, j.position,
                    j.positions, j.speed, j.speeds, n.own->mass.straight, n.own->mass.rank, n.own->mass.second_order,
                    n.own->rotary.sections, n.own->factor.size());
}
template <class Space>
auto structure(const SymmetricStation<Space>& s) {
  return std::tuple(s.loaded, s.has_children, s.fields.first.size(), s.fields.second.size());
}

/// Whether two nodes, of one case or of several, differ in numbers only.
template <class Space, class Many>
bool alike(const SymmetricNode<Space>& a, const SymmetricNode<Many>& b) {
  return structure(a) == structure(b) && a.own->mass.runs == b.own->mass.runs &&
         a.own->rotary.runs == b.own->rotary.runs &&
         std::equal(a.own->stations.begin(), a.own->stations.end(), b.own->stations.begin(), b.own->stations.end(),
                    [](const auto& s, const auto& t) { return structure(s) == structure(t); });
}

}  // namespace withy::sweep
