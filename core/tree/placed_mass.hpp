/// \file
/// The mass of a node's flexible body, where the node has it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

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
  [[nodiscard]] Vector3 place(std::size_t particle) const;
  /// A particle's expansion in the present axes, Γ = Θ = 0 where they were dropped.
  [[nodiscard]] PointExpansion at(std::size_t particle) const { return placed(shape_->particles[particle].at); }
  /// All sections, likewise.
  [[nodiscard]] std::vector<Section> sections() const;

  /// From now on seen from frame A, X_AB the pose of the present frame B in it.
  void move(const Pose& AB);
  /// Drops Γ and Θ.
  void make_linear() { linear_ = true; }
  /// Equal for masses of one shape whose particles are equal to the last bit; empty where there is no shape.
  [[nodiscard]] std::string identity() const;

 private:
  [[nodiscard]] PointExpansion placed(const PointExpansion& e) const;

  std::shared_ptr<const ModalShape> shape_;
  std::vector<Pose> moves_;  ///< in the order they were made
  bool linear_ = false;
};

}  // namespace withy
