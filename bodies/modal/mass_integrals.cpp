#include "mass_integrals.hpp"

#include <Eigen/Eigenvalues>

namespace withy {
namespace {

Vector3 component(const std::array<Eigen::MatrixXd, 3>& m, Eigen::Index i, Eigen::Index j) {
  return {m[0](i, j), m[1](i, j), m[2](i, j)};
}

/// A mass at s·r(q) + R(q) e: a particle has s = 1, e = 0, an axis of rotary inertia s = 0.
struct Piece {
  double weight;
  double s;
  Vector3 e;
  const PointExpansion* at;

  [[nodiscard]] Vector3 X() const { return s * at->X + e; }
  [[nodiscard]] Vector3 phi(Eigen::Index k) const { return s * at->phi.col(k) + Vector3(at->psi.col(k)).cross(e); }
  [[nodiscard]] Vector3 gamma(Eigen::Index k, Eigen::Index l) const {
    const Vector3 pk = at->psi.col(k), pl = at->psi.col(l);
    return s * component(at->gamma, k, l) + component(at->theta, k, l).cross(e) +
           0.5 * (pk.cross(pl.cross(e)) + pl.cross(pk.cross(e)));
  }
};

void add(const Piece& piece, MassIntegrals& sum) {
  const Eigen::Index n = sum.modes();
  const Vector3 X = piece.X();
  sum.mass += piece.weight * piece.s * piece.s;
  sum.x += piece.weight * piece.s * X;
  sum.xx += piece.weight * X * X.transpose();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector3 pk = piece.phi(k);
    sum.phi.col(k) += piece.weight * piece.s * pk;
    sum.x_phi[static_cast<std::size_t>(k)] += piece.weight * X * pk.transpose();
    for (Eigen::Index l = 0; l < n; ++l) {
      const Vector3 g = piece.gamma(k, l);
      sum.phi_phi[sum.pair(k, l)] += piece.weight * pk * piece.phi(l).transpose();
      sum.gamma[sum.pair(k, l)] += piece.weight * piece.s * g;
      sum.x_gamma[sum.pair(k, l)] += piece.weight * X * g.transpose();
    }
  }
}

}  // namespace

MassIntegrals::MassIntegrals(Eigen::Index modes)
    : phi(Matrix3X::Zero(3, modes)),
      x_phi(static_cast<std::size_t>(modes), Matrix3::Zero()),
      phi_phi(static_cast<std::size_t>(modes * modes), Matrix3::Zero()),
      gamma(static_cast<std::size_t>(modes * modes), Vector3::Zero()),
      x_gamma(static_cast<std::size_t>(modes * modes), Matrix3::Zero()) {}

MassIntegrals integrals_of(const ModalShape& shape) {
  MassIntegrals sum(shape.modes());
  for (const Particle& p : shape.particles) add({p.mass, 1, Vector3::Zero(), &p.at}, sum);
  for (const Section& s : shape.sections) {
    // The central second moment ½ tr(J) 1 − J along its principal axes; a weight may be negative, as a rod's twist has
    // inertia about one axis alone.
    const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(0.5 * s.inertia.trace() * Matrix3::Identity() - s.inertia);
    for (Eigen::Index a = 0; a < 3; ++a) add({eigen.eigenvalues()[a], 0, eigen.eigenvectors().col(a), &s.at}, sum);
  }
  return sum;
}

}  // namespace withy
