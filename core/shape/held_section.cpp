#include "withy/core/shape/held_section.hpp"

#include "withy/core/shape/modal_mass.hpp"

namespace withy {

bool HeldSection::leaves_all() const {
  bool turns = !(held * at.psi).isZero(0);
  for (Eigen::Index c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k)
      turns = turns || !(held(c, static_cast<Eigen::Index>(k)) * at.theta[k]).eval().isZero(0);
  return !turns;
}

// With θₛ = ψ q + ½ qᵀΘₛq the held rotation, d = X − Xₛ and δ = Φ − Φₛ:
//   Rₛᵀ(r − rₛ) = d + δ q − θₛ × d − ψ q × δ q + ½ ψ q × (ψ q × d) + ½ qᵀ(Γ − Γₛ)q.
PointExpansion HeldSection::seen(const PointExpansion& point) const {
  const Eigen::Index n = point.phi.cols();
  const Vector3 d = point.X - at.X;
  const Matrix3X psi = held * at.psi, delta = point.phi - at.phi;
  PointExpansion e = PointExpansion::rigid(point.X, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3 turn = psi.col(i);
    e.phi.col(i) = delta.col(i) - turn.cross(d);
    e.psi.col(i) = point.psi.col(i) - turn;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto of = [&](const std::array<Eigen::MatrixXd, 3>& fields) {
        return Vector3(fields[0](i, j), fields[1](i, j), fields[2](i, j));
      };
      const Vector3 a = psi.col(i), b = psi.col(j), turn = held * of(at.theta);
      const Vector3 gamma = of(point.gamma) - of(at.gamma) - turn.cross(d) - a.cross(Vector3(delta.col(j))) -
                            b.cross(Vector3(delta.col(i))) + 0.5 * (a.cross(b.cross(d)) + b.cross(a.cross(d)));
      const Vector3 theta =
          of(point.theta) - turn - 0.5 * (a.cross(Vector3(point.psi.col(j))) + b.cross(Vector3(point.psi.col(i))));
      for (std::size_t c = 0; c < 3; ++c) {
        e.gamma[c](i, j) = gamma[static_cast<Eigen::Index>(c)];
        e.theta[c](i, j) = theta[static_cast<Eigen::Index>(c)];
      }
    }
  }
  return e;
}

Eigen::MatrixXd modal_mass(const ModalShape& shape, const HeldSection& section) {
  ModalShape seen;
  seen.mode_names = shape.mode_names;
  for (const Particle& p : shape.particles) seen.particles.push_back({p.mass, section.seen(p.at)});
  for (const Section& s : shape.sections) seen.sections.push_back({s.inertia, section.seen(s.at)});
  return modal_mass(seen);
}

}  // namespace withy
