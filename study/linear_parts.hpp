/// \file
/// Parts that linear models are made of, whatever goes in and comes out.
#pragma once

#include "withy/study/linear_model.hpp"
#include "withy/study/sampled_loads.hpp"

namespace withy::study {

/// What does not depend on inputs and outputs: names of states, accelerations, whether the state is an equilibrium.
LinearModel about(const Configuration& configuration, const SmallMotions& motions, const SampledLoads& sampled);
/// Gives `system`, which has C by (x, d) and D, its A and B: those of continuous time or, where loads are sampled, of
/// the map between samples, y then just after the sample. \param by_held of ẋ = A x + by_held d + B v
void sample(const SampledLoads& sampled, const Eigen::MatrixXd& A, const Eigen::MatrixXd& by_held,
            const Eigen::MatrixXd& B, LinearSystem& system);

}  // namespace withy::study
