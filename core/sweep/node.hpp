/// \file
/// What the sweeps keep of each node: constants in the space of the sweep, and the layout of its work memory.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/spatial/space.hpp"
#include "withy/core/sweep/shared_numbers.hpp"
#include "withy/core/tree/invariants.hpp"
#include "withy/core/tree/tree.hpp"

namespace withy::sweep {

/// The end of an evaluation in which all blocks could be solved. It and the other lie elsewhere since the compiler puts
/// an Evaluation together in memory, and who loads it then waits for its parts: 4 ns of the 233 of the slew in
/// ruthless.
extern const Evaluation all_solved;
/// The end of one in which a body's block could not.
[[gnu::cold]] Evaluation singular_at(int body) noexcept;

/// Motions of a hinge that the sweeps inline. In the aligned hinge frame a rotation is about the third axis and a slide
/// along the first; ball and free have local rates (axes of M) equal to the rotated rates of the State.
enum class Joint { fixed, rotate, slide, ball, free, custom };

/// The inertia of a rigid part in the space of the sweep.
template <class Space>
inline typename Space::Inertia inertia_of(const RigidInertia& I) {
  if constexpr (Space::angular == 1) {
    return {I.inertia(2, 2), -I.moment.y(), I.moment.x(), I.mass, 0, I.mass};
  } else {
    typename Space::Inertia sum = Space::Inertia::zero();
    sum.A += Space::block(I.inertia);
    sum.L = Space::Block::skew(-Space::position(I.moment));
    sum.M += Space::block(I.mass * Matrix3::Identity());
    return sum;
  }
}

/// Change of a rigid inertia whose mass stays: first moment and inertia about the origin, as few numbers as there are.
/// As a quadratic form Uᵀ I V it is the dot product with `bilinear` of U and V.
template <class Space>
struct Variation;

template <class S>
struct Variation<PlanarOf<S>> {
  using Planar = PlanarOf<S>;
  S x, y, J;  ///< moment, inertia
  static Variation zero() { return {0, 0, 0}; }
  static Variation of(const RigidInertia& I) { return {I.moment.x(), I.moment.y(), I.inertia(2, 2)}; }
  static Variation bilinear(const typename Planar::Twist& U, const typename Planar::Twist& V) {
    return {U.w * V.y + U.y * V.w, -(U.w * V.x + U.x * V.w), U.w * V.w};
  }
  friend S dot(const Variation& a, const Variation& b) { return a.x * b.x + a.y * b.y + a.J * b.J; }
  void add(const Variation& b, S s) { x += b.x * s, y += b.y * s, J += b.J * s; }
  /// I V.
  [[nodiscard]] typename Planar::Twist times(const typename Planar::Twist& V) const {
    return {J * V.w + x * V.y - y * V.x, -y * V.w, x * V.w};
  }
  [[nodiscard]] typename Planar::Inertia inertia() const { return {J, -y, x, 0, 0, 0}; }
};

template <class S>
struct Variation<SpatialOf<S>> {
  using Spatial = SpatialOf<S>;
  using Triple = TripleOf<S>;
  using Block = BlockOf<S>;
  Triple s, d, o;  ///< moment; inertia xx yy zz; xy xz yz
  static Variation zero() { return {Triple::zero(), Triple::zero(), Triple::zero()}; }
  static Variation of(const RigidInertia& I) {
    return {Spatial::position(I.moment), Triple(I.inertia(0, 0), I.inertia(1, 1), I.inertia(2, 2)),
            Triple(I.inertia(0, 1), I.inertia(0, 2), I.inertia(1, 2))};
  }
  static Variation bilinear(const typename Spatial::Twist& U, const typename Spatial::Twist& V) {
    const Triple &u = U.w, &w = V.w;
    return {cross(V.v, u) + cross(U.v, w), products(u, w),
            Triple(u[0] * w[1] + u[1] * w[0], u[0] * w[2] + u[2] * w[0], u[1] * w[2] + u[2] * w[1])};
  }
  friend S dot(const Variation& a, const Variation& b) { return withy::dot(a.s, b.s, a.d, b.d, a.o, b.o); }
  void add(const Variation& b, S k) { s += b.s * k, d += b.d * k, o += b.o * k; }
  [[nodiscard]] typename Spatial::Twist times(const typename Spatial::Twist& V) const {
    return {tensor() * V.w + cross(s, V.v), cross(V.w, s)};
  }
  [[nodiscard]] typename Spatial::Inertia inertia() const { return {tensor(), Block::skew(-s), Block::zero()}; }

 private:
  [[nodiscard]] Block tensor() const {
    return {{Triple(d[0], o[0], o[1]), Triple(o[0], d[1], o[2]), Triple(o[1], o[2], d[2])}};
  }
};

/// A rigid part in the space of the sweep: as a map of accelerations, and what its velocity terms need.
template <class Space>
struct RigidPart {
  typename Space::Inertia inertia;
  typename Space::Scalar mass = 0;
  typename Space::Position moment;

  RigidPart() : RigidPart(RigidInertia{}) {}
  explicit RigidPart(const RigidInertia& I)
      : inertia(inertia_of<Space>(I)), mass(I.mass), moment(Space::position(I.moment)) {}
  /// V ×* (I V), the wrench that holds the part against its velocity.
  [[nodiscard]] typename Space::Twist velocity_wrench(const typename Space::Twist& V) const {
    if constexpr (Space::angular == 1) {
      const auto cx = -V.w * V.y, cy = V.w * V.x, ww = V.w * V.w;
      return {moment.x * cy - moment.y * cx, mass * cx - ww * moment.x, mass * cy - ww * moment.y};
    } else {
      const auto c = cross(V.w, V.v);
      return {cross(V.w, inertia.A * V.w) + cross(moment, c), mass * c + cross(V.w, cross(V.w, moment))};
    }
  }
};

/// Expansion of a station's section: rotation and displacement of second order, as pairs (angular; linear) parallel to
/// the node's frame.
template <class Space>
struct Fields {
  using Twist = typename Space::Twist;
  typename Space::Position X = Space::Position::zero();
  SharedNumbers<Twist> first;   ///< (Ψ_i; Φ_i)
  SharedNumbers<Twist> second;  ///< (Θ_ij; Γ_ij) for i ≤ j; empty where all are zero

  Fields() = default;
  explicit Fields(const PointExpansion& e) : X(Space::position(e.X)) {
    bool curved = false;
    std::vector<Twist> linear, quadratic;
    for (Eigen::Index i = 0; i < e.phi.cols(); ++i) {
      linear.push_back(Twist::of(Space::angle(e.psi.col(i)), Space::position(e.phi.col(i))));
      for (Eigen::Index j = i; j < e.phi.cols(); ++j) {
        const Vector3 g(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j));
        const Vector3 t(e.theta[0](i, j), e.theta[1](i, j), e.theta[2](i, j));
        quadratic.push_back(Twist::of(Space::angle(t), Space::position(g)));
        curved = curved || !g.isZero(0) || !t.isZero(0);
      }
    }
    first = std::move(linear);
    if (curved) second = std::move(quadratic);
  }
  /// Takes from `other` what is equal.
  void share(const Fields& other) {
    first.share(other.first);
    second.share(other.second);
  }
};

/// Whether a space holds several cases at once.
template <class Space>
constexpr bool in_lanes = !std::is_same_v<typename Space::Scalar, double>;
/// Exact kinematics, sections with rotary inertia in space, and hinges with several rates are of one case alone.
template <class Space>
constexpr bool has_rods = !in_lanes<Space>;
template <class Space>
constexpr bool has_sections = Space::angular == 1 || !in_lanes<Space>;
template <class Space>
constexpr bool has_general_hinges = Space::angular == 3 && !in_lanes<Space>;

/// Hinge of a node.
template <class Space>
struct JointData {
  // What all passes read stands together.
  Joint kind = Joint::fixed;
  bool driven = false;       ///< its rates' accelerations are given, and the efforts on them are found
  bool pose_matters = true;  ///< false on a world without weight, whose accelerations are zero in any axes
  double direction = 1;
  typename Space::Scalar reflected = 0;  ///< inertia on its only rate, beside what hangs on it
  std::size_t position = 0, positions = 0, speed = 0, speeds = 0;
  const Hinge* hinge = nullptr;
  typename Space::Frame F;  ///< in the parent station's section, the parent node's frame, or the world

  JointData() = default;
  explicit JointData(const NodeSpec& node)
      : driven(node.driven),
        direction(node.direction),
        reflected(node.reflected),
        position(node.slot.position),
        positions(node.slot.positions),
        speed(node.slot.speed),
        speeds(node.slot.speeds),
        hinge(node.hinge.get()),
        F(Space::make(node.F)) {
    using enum HingeKernel::Kind;
    kind = Joint::custom;
    if (!node.kernel) return;
    switch (node.kernel->kind) {
      case weld:
        kind = Joint::fixed;
        break;
      case revolute:
        kind = Joint::rotate;
        break;
      case prismatic:
        kind = Joint::slide;
        break;
      case spherical:
        kind = Joint::ball;
        break;
      case HingeKernel::Kind::free:
        kind = Joint::free;
        break;
    }
  }
};

/// Offsets into the work memory, in bytes, of arrays of a type; grows as blocks are asked for.
class WorkLayout {
 public:
  template <class T>
  std::size_t take(std::size_t count) {
    const std::size_t at = size_;
    size_ += (count * sizeof(T) + 63) / 64 * 64;
    return at;
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
};

template <class T>
T* at(std::byte* work, std::size_t offset) {
  return std::launder(reinterpret_cast<T*>(work + offset));
}

}  // namespace withy::sweep
