/// \file
/// Damping that a scene asks of a flexible body, as a matrix in its coordinates.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/parameters.hpp"
#include "withy/core/plugin/value.hpp"

namespace withy {

struct BodyDamping {
  /// ζ of the body's own modes of vibration: with its frame held, carrying nothing (not those of the mounted tree).
  double ratio = 0;
  std::map<int, double> ratios;       ///< ζ of single ones, counted from 1 in the order of frequency
  double stiffness_proportional = 0;  ///< β [s] of a share β K

  /// Whether the scene gives any of the three. \param p with the parameters below
  static bool given(const Value& p);
  /// Nothing after reporting modes in `ratios` that no mode can be the number of.
  static std::optional<BodyDamping> read(const Value& p, Diagnostics& diagnostics);
  /// D = β K + Σ_k 2 ζ_k ω_k (G v_k)(G v_k)ᵀ with K v = ω² G v, vᵀ G v = 1: the body's modes have the ratios ζ_k + β
  /// ω_k/2 whatever functions describe them. Motions without strain are not damped. Where G is singular each coordinate
  /// is taken for a mode.
  [[nodiscard]] Eigen::MatrixXd matrix(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) const;
  /// What is odd about it, a sentence each: ratios above 1, ratios of modes that the body does not have.
  [[nodiscard]] std::vector<std::string> remarks(Eigen::Index modes) const;
};

/// `damping_ratio` (default 0; without a default where the body's data give damping) and `damping`.
std::vector<ParameterSpec> damping_parameters(bool with_default = true);

}  // namespace withy
