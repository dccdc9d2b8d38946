/// \file
/// The nodes of a tree as an observation sees them: constants, and their motion at one state.
#pragma once

#include <type_traits>
#include <vector>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/sweep/joint_step.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/rod/rod_kinematics.hpp"
#include "withy/core/sweep/rod/rotary_table.hpp"

namespace withy::observed {

constexpr int any_count = -1;  ///< of modes: not known when compiled

/// What a rigid part adds in a plane to the angular momentum across the normal: its mass at another height than the
/// plane's, and products of inertia with the normal.
template <class S>
struct Height {
  S frame = 0;       ///< of its frame above the plane [m]
  S moment = 0;      ///< Σ m z above that [kg m]
  S xz = 0, yz = 0;  ///< elements of its inertia [kg m²]
};

/// Mass that is fixed to a frame.
template <class Space>
struct Fixed {
  sweep::RigidPart<Space> part;
  Height<typename Space::Scalar> height;
  bool empty = true;

  Fixed() = default;
  Fixed(const RigidInertia& I, double frame_height)
      : part(I), height{frame_height, I.moment.z(), I.inertia(0, 2), I.inertia(1, 2)}, empty(I.empty()) {}
};

/// A section of a node where children, rigid bodies or frames are.
template <class Space>
struct Station {
  sweep::Fields<Space> fields;  ///< none of a rod
  Fixed<Space> carried;
  double height = 0;    ///< of the section above the plane [m]
  bool needed = false;  ///< in every pass: it carries bodies
};

/// In lanes there are no rods.
struct NoRod {};
template <class Space>
using RodOf = std::conditional_t<sweep::has_rods<Space>, sweep::RodKinematics<Space>, NoRod>;

template <class Space>
struct Node {
  int parent = -1, parent_station = -1, root_station = -1, modes = 0;
  std::size_t mode_position = 0, mode_speed = 0;
  std::size_t first_station = 0;  ///< of its motions among those of all nodes
  std::size_t rod_work = 0;       ///< of a rod: its place among all rods' packs
  sweep::JointData<Space> joint;
  typename Space::Frame M;  ///< hinge frame in the root station's section
  Fixed<Space> base;
  sweep::SharedNumbers<typename Space::Scalar> stiffness;  ///< n×n
  std::vector<Station<Space>> stations;
  sweep::MassTable<Space> mass;
  sweep::RotaryTable<Space> rotary;
  RodOf<Space> rod;                            ///< in place of these where the kinematics is exact
  typename Space::Scalar flexible_height = 0;  ///< of the flexible part's mass above the plane [m]

  Node() = default;
  /// \param spec with the stations of all frames, the first `carrying` of them those that bodies hang on
  /// \param twin a node whose body's mass is the same, in the same place and terms; null: there is none
  Node(const NodeSpec& spec, StrainOrder order, std::size_t carrying, double height, const Node* twin);
  [[nodiscard]] bool is_rod() const {
    if constexpr (sweep::has_rods<Space>) return rod.integrals.packs > 0;
    return false;
  }
};

/// A frame in motion: where it is in the world (the plane's, in a plane), and its twist in its own axes.
template <class Space>
struct Moving {
  typename Space::Frame X;
  typename Space::Twist V;
};

/// Sums over the tree, in the plane's axes where all moves in a plane.
template <class Space>
struct Sums {
  typename Space::Scalar kinetic = 0;
  typename Space::Twist momentum = Space::Twist::zero();      ///< (angular about the origin; linear)
  typename Space::Position moment = Space::Position::zero();  ///< Σ m p
  typename Space::Position across = Space::Position::zero();  ///< in a plane: angular momentum in it
};

/// Momentum of a part about a frame at X, in that frame's axes; its first moment there; its kinetic energy.
template <class Space>
inline void add_part(const typename Space::Frame& X, const typename Space::Twist& h,
                     const typename Space::Position& moment, const typename Space::Scalar& mass,
                     const typename Space::Scalar& kinetic, const typename Space::Scalar& height, Sums<Space>& sums) {
  sums.kinetic += kinetic;
  sums.momentum += Space::to_parent(X, h);
  sums.moment += X.p * mass + Space::rotate(X.R, moment);
  if constexpr (Space::angular == 1) {
    const typename Space::Position p = Space::rotate(X.R, {h.x, h.y});
    sums.across += typename Space::Position{-height * p.y, height * p.x};  // z n × Σ m v
  }
}

template <class Space>
inline void add_fixed(const Fixed<Space>& fixed, const Moving<Space>& frame, Sums<Space>& sums) {
  if (fixed.empty) return;
  const typename Space::Twist& V = frame.V;
  const typename Space::Twist h = fixed.part.inertia * V;
  add_part<Space>(frame.X, h, fixed.part.moment, fixed.part.mass, 0.5 * Space::dot(V, h), fixed.height.frame, sums);
  if constexpr (Space::angular == 1) {
    const auto& z = fixed.height;
    sums.across += Space::rotate(frame.X.R, {z.xz * V.w - z.moment * V.y, z.yz * V.w + z.moment * V.x});
  }
}

}  // namespace withy::observed
