/// \file
/// Efforts of loads as a vector.
#pragma once

#include <Eigen/Core>

#include "withy/core/plugin/equations.hpp"

namespace withy::study {

/// On all speeds [N m, N], at a state but at a time of its own [s].
/// \param load as of EquationsOfMotion::load_efforts
inline Eigen::VectorXd load_efforts(const EquationsOfMotion& equations, double time, const State& state, int load,
                                    Work& work) {
  Eigen::VectorXd efforts(static_cast<Eigen::Index>(equations.layout().speeds));
  equations.load_efforts(time, state.y, load, {efforts.data(), equations.layout().speeds}, work);
  return efforts;
}

}  // namespace withy::study
