#include "withy/core/tree/rigid_inertia.hpp"

namespace withy {

RigidInertia rigid_inertia(const ModalShape& shape) {
  RigidInertia I;
  for (const Particle& p : shape.particles) {
    I.mass += p.mass;
    I.moment += p.mass * p.at.X;
    I.inertia += p.mass * (p.at.X.squaredNorm() * Matrix3::Identity() - p.at.X * p.at.X.transpose());
  }
  for (const Section& s : shape.sections) I.inertia += s.inertia;
  return I;
}

}  // namespace withy
