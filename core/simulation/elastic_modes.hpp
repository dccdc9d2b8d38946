/// \file
/// A flexible body's own vibrations with its frame held: from K and its modal mass alone, whatever the body carries.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/shape/modal_shape.hpp"

namespace withy {

struct ElasticModes {
  Eigen::MatrixXd mass;         ///< G = Σ m ΦᵀΦ + Σ Ψᵀ I Ψ
  Eigen::VectorXd frequencies;  ///< [rad/s], increasing; motions without strain (of families whose root moves) left out
  Eigen::MatrixXd vectors;      ///< columns v with vᵀ G v = 1, vᵀ K v = ω²
};

/// Of all coordinates, or of those listed (the others held at zero; rows of `vectors` are those listed).
ElasticModes elastic_modes(const ModalShape& shape);
ElasticModes elastic_modes(const ModalShape& shape, const std::vector<Eigen::Index>& coordinates);

/// Coordinates of one family of modes, those whose names have the same text before '['.
struct ModeGroup {
  std::string name;  ///< "bending_y"
  std::vector<Eigen::Index> coordinates;
};
std::vector<ModeGroup> mode_groups(const ModalShape& shape);

/// K of the whole tree, over all speeds: the stiffness matrices of the bodies on its diagonal.
Eigen::MatrixXd stiffness_of_modes(const Model& model);

}  // namespace withy
