/// \file
/// The fields of a beam's assumed modes: linear ones, and what its strain kinematics make of them to second order. The
/// relations are in beam_body.cpp.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "beam_body.hpp"
#include "beam_quadrature.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy {

/// Values of every coordinate's fields at one x.
struct LinearFields {
  Matrix3X phi, psi, psi_slope, gamma;  ///< Φ; ψ; curvature and twist rate κ = ψ′; elongation γ

  [[nodiscard]] SectionField field(Eigen::Index i) const { return {psi.col(i), psi_slope.col(i), gamma.col(i)}; }
};

/// Θ′, Γ′, Θ and Γ at the nodes of quadrature, a row each: the upper triangles of their three components.
struct SecondFields {
  Eigen::MatrixXd theta_slope, gamma_slope, theta, gamma;
};

/// Points of beams that are no more, for the next with the same fields: from case to case of a sweep they differ in
/// their masses alone. Of any thread.
class SparePoints {
 public:
  SparePoints() { spare_.reserve(most); }
  /// One for each node, with masses of another beam; none: there are no spare ones.
  [[nodiscard]] std::vector<Particle> take();
  /// Of a beam with these fields.
  void give_back(std::vector<Particle>&& points) noexcept;

 private:
  static constexpr std::size_t most = 9;  ///< as many cases as a thread has at once, and one
  std::mutex mutex_;
  std::vector<std::vector<Particle>> spare_;
};

/// What a beam's nodes of quadrature have whatever its stiffness and mass are.
struct NodeFields {
  std::shared_ptr<const std::vector<LinearFields>> linear;
  std::shared_ptr<const SecondFields> pairs;
  std::shared_ptr<SparePoints> points = nullptr;  ///< null: none are kept
};

LinearFields linear_fields(const std::vector<BeamStrain>& strains, double x);
/// At the nodes of a quadrature over [0, length].
NodeFields fields_at_nodes(const std::vector<BeamStrain>& strains, double length, const BeamQuadrature& quadrature,
                           const StrainKinematics& kinematics);

/// A row of SecondFields.
using PairFields = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

/// Of the section at x, with its fields of first and second order.
PointExpansion expansion(double x, const LinearFields& f, const PairFields& gamma, const PairFields& theta);

}  // namespace withy
