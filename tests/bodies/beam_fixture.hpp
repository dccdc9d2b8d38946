/// \file
/// Values that describe beams, and what beams are made of, for tests.
#pragma once

#include <Eigen/Core>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/value.hpp"

namespace withy::test {

/// One kind of strain of a beam in clamped-free modes; `inertia` [kg m] where it is torsion.
inline Value strain(double stiffness, double modes, double inertia = 0) {
  Value v = Value::map(
      {{"stiffness", Value(stiffness)}, {"modes", Value(modes)}, {"family", Value(std::string("clamped-free"))}});
  if (inertia > 0) v.set("inertia", Value(inertia));
  return v;
}

/// Mass matrix of the modes alone [kg].
inline Eigen::MatrixXd modal_mass(const Body& body) {
  const Eigen::Index n = body.shape().modes();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (const Particle& p : body.shape().particles) M += p.mass * p.at.phi.transpose() * p.at.phi;
  for (const Section& s : body.shape().sections) M += s.at.psi.transpose() * s.inertia * s.at.psi;
  return M;
}

}  // namespace withy::test
