/// \file
/// Modes of bodies together with what loads have of differential equations: controllers, actuators, filters.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "withy/core/analysis/modes.hpp"

namespace withy {

/// natural_modes where loads have continuous states: the eigenvalues of the whole first-order form.
/// \throws std::domain_error as natural_modes.
std::vector<Mode> modes_with_states(const Tangents& tangents, const Held& held);

/// Displacements of the free speeds over a period.
struct MotionOverPeriod {
  double fastest = 0;                           ///< greatest frequency in it [rad/s]
  std::vector<double> times, weights;           ///< [s], and shares of the period
  std::vector<Eigen::MatrixXcd> displacements;  ///< at those, a column a motion
};

/// Small motions from one instant to the same a period later, z of displacements of the free speeds, their rates and
/// the states of loads.
struct PeriodMap {
  Eigen::MatrixXd map;
  double period = 0;       ///< [s]
  Eigen::VectorXd units;   ///< of the first elements of z, as from balancing_units
  Eigen::MatrixXd mass;    ///< of the free speeds
  Eigen::MatrixXd unheld;  ///< columns of z that stay as they are, as from unheld_motions
  /// δ over a period, of motions that begin with these columns of z. A multiplier e^{λT} tells the frequency of λ but
  /// for multiples of 2π/T: it is the one with most of the kinetic energy in between.
  std::function<MotionOverPeriod(const Eigen::MatrixXcd&)> between;
};

/// Modes of a map: λ is that of e^{λT} an eigenvalue. A real one is a mode by itself, also where it
/// is negative, or where what vibrates is in step with the periods: λ is complex then.
struct MapModes {
  std::vector<Mode> modes;
  std::size_t gone = 0;  ///< multipliers that are zero, or too small to be told: what is forgotten within some periods
};

/// \throws std::domain_error as natural_modes.
MapModes modes_of_map(const PeriodMap& of, const Held& held);

/// The left eigenvectors of A, a column for each of its eigenvalues.
Eigen::MatrixXcd left_vectors(const Eigen::MatrixXd& A, const Eigen::VectorXcd& values);
/// The greatest |w_i z_i| of the eigenvectors w, z of a first-order form, of a displacement with that of its rate:
/// index among so many displacements, then the states of loads.
Eigen::Index most_taking_part(const Eigen::VectorXcd& left, const Eigen::VectorXcd& right, Eigen::Index displacements);

/// Those that grow first, then in the order of the smaller |λ| of each pair.
void sort_modes(std::vector<Mode>& modes);

}  // namespace withy
