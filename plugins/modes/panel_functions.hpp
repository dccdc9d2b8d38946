/// \file
/// Shape functions that are known by their strains at the nodes of panels.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "withy/core/plugin/mode_family.hpp"

namespace withy {

/// In each panel a strain is a polynomial, through its values at the panel's nodes; deflection and slope are its
/// integrals from the root, where they are zero, so that they are each other's derivatives to rounding.
class PanelFunctions final : public ShapeFunctions {
 public:
  static constexpr Eigen::Index order = 16;  ///< Gauss nodes of a panel

  /// \param strain φ″ of the functions in bending, else φ′
  /// \param edges of the panels, 0 … L
  /// \param strains a row a node, panel after panel, a column a function
  /// \param kinks among the edges, as ShapeFunctions has them
  PanelFunctions(BeamData::Strain strain, std::vector<double> edges, const Eigen::MatrixXd& strains, double wave_number,
                 std::vector<double> kinks);

  std::size_t count() const override { return static_cast<std::size_t>(root_slope_.cols()); }
  double wave_number() const override { return wave_number_; }
  std::vector<double> kinks() const override { return kinks_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override;

 private:
  bool bends_;
  std::vector<double> edges_, kinks_;
  double wave_number_;
  Eigen::MatrixXd series_;             ///< Legendre coefficients of the strains, `order` rows a panel
  Eigen::MatrixXd root_, root_slope_;  ///< φ and, in bending, φ′ at the beginning of each panel
};

}  // namespace withy
