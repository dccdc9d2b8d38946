/// \file
/// Wrenches of loads with their derivatives, for TangentDynamics.
#pragma once

#include <vector>

#include "withy/core/tangents/recursion.hpp"

namespace withy::analysis {

/// Loads that have no derivatives of their own are differentiated with this step [rad, m, s⁻¹ of these], or shorter
/// ones where it is too long (refined_difference.hpp).
constexpr double difference_step = 1e-3;

/// Wrenches at frames in motion; y as State::y, for the load's own states.
std::vector<AppliedWrench<double>> wrenches_of(const LoadNode& load, const Model& model, double t,
                                               std::span<const double> y, const std::vector<FrameState<double>>& frames,
                                               bool& depends);
/// The same with derivatives: those of the wrenches with respect to the frames' motion by central differences, that
/// motion's own exactly. `depends` becomes true where they are not zero.
std::vector<AppliedWrench<Jet>> wrenches_of(const LoadNode& load, const Model& model, double t,
                                            std::span<const double> y, const std::vector<FrameState<Jet>>& frames,
                                            bool& depends);

}  // namespace withy::analysis
