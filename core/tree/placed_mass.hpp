/// \file
/// The mass of a node's flexible body, where the node has it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// A change of the frame that points are seen from: X_AB of the frame B before.
struct FrameMove {
  Pose AB;
  bool turns = false;  ///< its axes are others
};

/// The fields of an expansion in the axes of a chain of frames, found as they are asked for: PointExpansion has eight
/// blocks of memory, and compiling a tree looks at every particle of it several times. Lives as long as what it is of.
class PlacedPoint {
 public:
  explicit PlacedPoint(const PointExpansion& e, std::span<const FrameMove> moves = {}, bool linear = false)
      : e_(&e), moves_(moves), linear_(linear) {}
  [[nodiscard]] Eigen::Index modes() const { return e_->phi.cols(); }
  [[nodiscard]] Vector3 X() const {
    Vector3 X = e_->X;
    for (const FrameMove& move : moves_) X = move.AB.p + move.AB.R * X;
    return X;
  }
  [[nodiscard]] Vector3 phi(Eigen::Index i) const { return turned(e_->phi.col(i)); }
  [[nodiscard]] Vector3 psi(Eigen::Index i) const { return turned(e_->psi.col(i)); }
  [[nodiscard]] Vector3 gamma(Eigen::Index i, Eigen::Index j) const { return second(e_->gamma, i, j); }
  [[nodiscard]] Vector3 theta(Eigen::Index i, Eigen::Index j) const { return second(e_->theta, i, j); }

 private:
  [[nodiscard]] Vector3 turned(Vector3 v) const {
    for (const FrameMove& move : moves_)
      if (move.turns) v = Vector3(move.AB.R * v);
    return v;
  }
  [[nodiscard]] Vector3 second(const std::array<Eigen::MatrixXd, 3>& m, Eigen::Index i, Eigen::Index j) const {
    if (linear_) return Vector3::Zero();
    return turned({m[0](i, j), m[1](i, j), m[2](i, j)});
  }

  const PointExpansion* e_;
  std::span<const FrameMove> moves_;
  bool linear_;
};

/// Particles and sections of a modal shape, seen from the frames that they were moved to. They are placed when they are
/// asked for: the nodes of equal bodies hold one shape, and a tree of many nodes does not hold the particles of all.
class PlacedMass {
 public:
  PlacedMass() = default;
  /// In the axes of the shape itself. A body's shape is held together with the body.
  explicit PlacedMass(std::shared_ptr<const ModalShape> shape) : shape_(std::move(shape)) {}

  /// Number of particles.
  [[nodiscard]] std::size_t size() const { return shape_ != nullptr ? shape_->particles.size() : 0; }
  [[nodiscard]] double mass(std::size_t particle) const { return shape_->particles[particle].mass; }
  /// X of a particle [m], present axes.
  [[nodiscard]] Vector3 place(std::size_t particle) const { return point(particle).X(); }
  /// A particle's expansion in the present axes, Γ = Θ = 0 where they were dropped.
  [[nodiscard]] PointExpansion at(std::size_t particle) const { return placed(shape_->particles[particle].at); }
  /// The same, not copied.
  [[nodiscard]] PlacedPoint point(std::size_t particle) const {
    return PlacedPoint(shape_->particles[particle].at, moves_, linear_);
  }
  /// All sections, likewise.
  [[nodiscard]] std::vector<Section> sections() const;

  /// Whether its axes are others than those of the shape itself.
  [[nodiscard]] bool turned() const;
  /// X_AB of the frame B of the shape itself in the present one.
  [[nodiscard]] Pose placement() const;
  /// The same mass, seen from the frame of the shape itself.
  [[nodiscard]] PlacedMass unmoved() const;

  /// From now on seen from frame A, X_AB the pose of the present frame B in it.
  void move(const Pose& AB);
  /// Drops Γ and Θ.
  void make_linear() { linear_ = true; }
  /// Equal for masses of one shape whose particles are equal to the last bit; empty where there is no shape.
  [[nodiscard]] std::string identity() const;

 private:
  [[nodiscard]] PointExpansion placed(const PointExpansion& e) const;

  std::shared_ptr<const ModalShape> shape_;
  std::vector<FrameMove> moves_;  ///< in the order they were made
  bool linear_ = false;
};

}  // namespace withy
