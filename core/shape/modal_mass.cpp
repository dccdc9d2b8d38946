#include "withy/core/shape/modal_mass.hpp"

namespace withy {

void add_products(double w, const Matrix3X& fields, Eigen::MatrixXd& G) {
  const Matrix3X weighted = w * fields;
  G += weighted.transpose().lazyProduct(fields);
}

void add_products(const Matrix3& S, const Matrix3X& fields, Eigen::MatrixXd& G) {
  const Matrix3X turned = S.lazyProduct(fields);
  G += fields.transpose().lazyProduct(turned);
}

Eigen::MatrixXd modal_mass(const ModalShape& shape) {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(shape.modes(), shape.modes());
  for (const Particle& p : shape.particles) add_products(p.mass, p.at.phi, G);
  for (const Section& s : shape.sections) add_products(s.inertia, s.at.psi, G);
  return G;
}

}  // namespace withy
