/// \file
/// Damping of bodies that gives the modes of the mounted tree the ratios one wants.
#pragma once

#include <string>
#include <vector>

#include "withy/study/configuration.hpp"
#include "withy/study/point.hpp"

namespace withy::study {

/// One of the lowest vibrations of the mounted tree.
struct DampedMode {
  double frequency = 0;  ///< undamped [rad/s]
  double asked = 0;      ///< ratio of critical damping
  double reached = 0;    ///< by the eigenvalues of the tree with the damping found
};

struct MountedDamping {
  std::vector<DampedMode> modes;  ///< lowest first
  /// The bodies' `damping` and `damping_ratio` that do it. Bodies that take no damping are left as they are.
  std::vector<Change> changes;
  /// Loads damp a mode more than was asked by themselves: [index of the mode].
  std::vector<std::size_t> beyond;
  /// The equations of small motions change as hinges turn, or with time: all this is at one angle, where bodies that
  /// are equal need not be given the same.
  bool frozen = false;
};

/// Ratios z_bk ≥ 0 of the bodies' own modes (BodyDamping::ratios) such that the lowest undamped modes φ of the free
/// speeds, of the symmetric parts of K and M about the configuration's state, have the ratios asked, what loads give
/// included:
///
///     Σ_bk z_bk φᵀ D_bk φ / 2ω = ζ − φᵀ G φ / 2ω,   D_bk the body's damping matrix at z_bk = 1, G without any of them,
///
/// in the least squares of relative errors, with a small cost on ratios far from one for all: what is asked of few
/// modes shall not make others stiff with damping. Bodies damped each by itself cannot give a tree any ratios one
/// likes: `reached` says what they give. \param ratios of the lowest vibrations, at least one \throws InputError where
/// no body takes such damping, one is in segments, or there are fewer vibrations; SceneError; std::domain_error where
/// the mass matrix of the free speeds is not positive, or anything grows
MountedDamping mounted_damping(const Configuration& configuration, Registry& registry,
                               const std::vector<double>& ratios);

/// Ratios between 0 and 1 from their texts, as 0.01 or "1 %". \throws InputError
std::vector<double> read_damping_ratios(const std::vector<std::string>& texts);

}  // namespace withy::study
