/// \file
/// What the sweeps keep of each node: constants in the space of the sweep, and the layout of its work memory.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "withy/core/dynamics/invariants.hpp"
#include "withy/core/dynamics/tree.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/spatial/space.hpp"

namespace withy::sweep {

/// Motions of a hinge that the sweeps inline. In the aligned hinge frame a rotation is about the third axis and a slide
/// along the first; ball and free have local rates (axes of M) equal to the rotated rates of the State.
enum class Joint { fixed, rotate, slide, ball, free, custom };

/// Projections from three dimensions into the space of a sweep; in the plane the third axis is the normal.
template <class Space>
struct Project;

template <>
struct Project<Spatial> {
  static Spatial::Twist twist(const Vector6& v) { return v; }
  static Spatial::Position position(const Vector3& a) { return a; }
  static Spatial::Angular angular(const Vector3& a) { return a; }
  static Spatial::Matrix inertia(const RigidInertia& I) {
    Spatial::Matrix m;
    const Matrix3 s = skew<double>(I.moment);
    m << I.inertia, s, s.transpose(), I.mass * Matrix3::Identity();
    return m;
  }
};

template <>
struct Project<Planar> {
  static Planar::Twist twist(const Vector6& v) { return {v[2], v[3], v[4]}; }
  static Planar::Position position(const Vector3& a) { return a.head<2>(); }
  static Planar::Angular angular(const Vector3& a) { return Planar::Angular(a.z()); }
  static Planar::Matrix inertia(const RigidInertia& I) {
    Planar::Matrix m;
    m << I.inertia(2, 2), -I.moment.y(), I.moment.x(), -I.moment.y(), I.mass, 0, I.moment.x(), 0, I.mass;
    return m;
  }
};

/// Change of a rigid inertia whose mass stays: first moment and inertia about the origin, as few numbers as there are.
/// As a quadratic form Vᵀ I V it is a dot product with `square` of V.
template <class Space>
struct Variation;

template <>
struct Variation<Planar> {
  static constexpr int size = 3;
  Eigen::Vector3d a = Eigen::Vector3d::Zero();  ///< moment x, moment y, inertia
  static Variation of(const RigidInertia& I) { return {{I.moment.x(), I.moment.y(), I.inertia(2, 2)}}; }
  /// I V.
  [[nodiscard]] Planar::Twist times(const Planar::Twist& V) const {
    return {a[2] * V[0] + a[0] * V[2] - a[1] * V[1], -a[1] * V[0], a[0] * V[0]};
  }
  /// b with b·a = Uᵀ I V.
  static Eigen::Vector3d bilinear(const Planar::Twist& U, const Planar::Twist& V) {
    return {U[0] * V[2] + U[2] * V[0], -(U[0] * V[1] + U[1] * V[0]), U[0] * V[0]};
  }
  [[nodiscard]] Planar::Matrix matrix() const {
    Planar::Matrix m;
    m << a[2], -a[1], a[0], -a[1], 0, 0, a[0], 0, 0;
    return m;
  }
};

template <>
struct Variation<Spatial> {
  static constexpr int size = 9;
  Eigen::Matrix<double, 9, 1> a = Eigen::Matrix<double, 9, 1>::Zero();  ///< moment; inertia xx yy zz xy xz yz
  static Variation of(const RigidInertia& I) {
    Variation v;
    v.a << I.moment, I.inertia(0, 0), I.inertia(1, 1), I.inertia(2, 2), I.inertia(0, 1), I.inertia(0, 2),
        I.inertia(1, 2);
    return v;
  }
  [[nodiscard]] Spatial::Twist times(const Spatial::Twist& V) const {
    const Eigen::Vector3d s = a.head<3>(), w = V.head<3>(), v = V.tail<3>();
    Spatial::Twist r;
    r.head<3>() = Eigen::Vector3d(a[3] * w[0] + a[6] * w[1] + a[7] * w[2], a[6] * w[0] + a[4] * w[1] + a[8] * w[2],
                                  a[7] * w[0] + a[8] * w[1] + a[5] * w[2]) +
                  s.cross(v);
    r.tail<3>() = w.cross(s);
    return r;
  }
  static Eigen::Matrix<double, 9, 1> bilinear(const Spatial::Twist& U, const Spatial::Twist& V) {
    const Eigen::Vector3d u = U.head<3>(), p = U.tail<3>(), w = V.head<3>(), v = V.tail<3>();
    Eigen::Matrix<double, 9, 1> b;
    b.head<3>() = v.cross(u) + p.cross(w);
    b.tail<6>() << u[0] * w[0], u[1] * w[1], u[2] * w[2], u[0] * w[1] + u[1] * w[0], u[0] * w[2] + u[2] * w[0],
        u[1] * w[2] + u[2] * w[1];
    return b;
  }
  [[nodiscard]] Spatial::Matrix matrix() const {
    Spatial::Matrix m = Spatial::Matrix::Zero();
    m.topLeftCorner<3, 3>() << a[3], a[6], a[7], a[6], a[4], a[8], a[7], a[8], a[5];
    const Matrix3 s = skew<double>(Eigen::Vector3d(a.head<3>()));
    m.topRightCorner<3, 3>() = s;
    m.bottomLeftCorner<3, 3>() = s.transpose();
    return m;
  }
};

/// Expansion of a station's section, coefficients in the order the sweeps read them.
template <class Space>
struct Fields {
  typename Space::Position X;
  bool second_order = false;                    ///< Γ or Θ are there
  std::vector<typename Space::Position> phi;    ///< n
  std::vector<typename Space::Position> gamma;  ///< n×n
  std::vector<typename Space::Angular> psi;     ///< n
  std::vector<typename Space::Angular> theta;   ///< n×n

  Fields() = default;
  explicit Fields(const PointExpansion& e) : X(Project<Space>::position(e.X)) {
    const Eigen::Index n = e.phi.cols();
    for (Eigen::Index i = 0; i < n; ++i) {
      phi.push_back(Project<Space>::position(e.phi.col(i)));
      psi.push_back(Project<Space>::angular(e.psi.col(i)));
      for (Eigen::Index j = 0; j < n; ++j) {
        const Vector3 g(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j));
        const Vector3 t(e.theta[0](i, j), e.theta[1](i, j), e.theta[2](i, j));
        gamma.push_back(Project<Space>::position(g));
        theta.push_back(Project<Space>::angular(t));
        second_order = second_order || !g.isZero(0) || !t.isZero(0);
      }
    }
  }
};

/// Hinge of a node.
template <class Space>
struct JointData {
  Joint kind = Joint::fixed;
  double direction = 1;
  typename Space::Frame F;  ///< in the parent station's section, the parent node's frame, or the world
  const Hinge* hinge = nullptr;
  bool pose_matters = true;  ///< false on a world without weight, whose accelerations are zero in any axes
  std::size_t position = 0, positions = 0, speed = 0, speeds = 0;

  explicit JointData(const NodeSpec& node)
      : direction(node.direction),
        F(Space::make(node.F)),
        hinge(node.hinge.get()),
        position(node.slot.position),
        positions(node.slot.positions),
        speed(node.slot.speed),
        speeds(node.slot.speeds) {
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
  /// First row of the twist that the local rates fill, for the inlined kinds.
  [[nodiscard]] static constexpr int row(Joint kind) {
    if (kind == Joint::rotate) return Space::angular - 1;
    if (kind == Joint::slide) return Space::angular;
    return 0;
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
