#include "withy/core/analysis/modes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/core/analysis/coupled_modes.hpp"
#include "withy/core/analysis/eigenpairs.hpp"
#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/scaled_problem.hpp"
#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

/// The matrices of the free speeds in coordinates scaled so that the diagonal of M is ±1: masses of modes and hinges
/// may differ by many powers of ten.
struct Scaled {
  Eigen::VectorXd scale;
  Eigen::MatrixXd M, G, K, C;

  Scaled(const Tangents& t, const std::vector<Eigen::Index>& free) {
    scale = unit_inertias(t.mass.diagonal()(free).cwiseAbs());
    const auto of_free = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
      return scale.asDiagonal() * m(free, free) * scale.asDiagonal();
    };
    M = of_free(t.mass), G = of_free(t.by_speed), K = of_free(t.by_position);
    C = scale.cwiseInverse().asDiagonal() * t.drift(free, free) * scale.asDiagonal();
    if (!M.allFinite() || !G.allFinite() || !K.allFinite() || !C.allFinite())
      throw std::domain_error("the derivatives at this state are not finite");
  }
};

/// In scaled coordinates; none where nobody asked for it.
Eigen::VectorXd in_play_of(const Tangents& t, const std::vector<Eigen::Index>& free, const Scaled& s) {
  if (t.in_play.size() == 0) return {};
  return t.in_play(free).cwiseProduct(s.scale.cwiseAbs2());
}

Eigen::MatrixXd solve_mass(const Eigen::MatrixXd& M, const Eigen::MatrixXd& right) {
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(M);
  if (!lu.isInvertible()) throw std::domain_error("the mass matrix is singular at this state");
  return lu.solve(right);
}

struct Root {
  Complex value;
  Eigen::VectorXcd shape;  ///< scaled coordinates
};

/// Constant displacements, u = −C δ, that ask for no acceleration.
struct Neutral {
  Eigen::MatrixXd directions;  ///< columns
  bool simple = true;          ///< at rest: each has the two zeros of a motion at any rate, and none has more

  Neutral(const Scaled& s, const Eigen::VectorXd& in_play) {
    const GradedMatrix stiffness(s.K - s.G * s.C, in_play);
    directions = stiffness.unheld();
    if (directions.cols() == 0) return;
    directions = Apart(directions).columns;
    // A force on one of these moves it: else it moves another without end.
    constexpr double moves = 1e-9;
    const Apart pushed(stiffness.unreached());
    const Eigen::FullPivLU<Eigen::MatrixXd> masses(pushed.columns.transpose() * s.M * directions);
    const Eigen::VectorXd pivots = masses.matrixLU().diagonal().cwiseAbs();
    simple = pivots.minCoeff() > moves * pivots.maxCoeff();
  }
};

/// K that takes the directions to nothing but for G C, to the last digit where they are single coordinates.
Eigen::MatrixXd cleared(const Scaled& s, const Neutral& neutral) {
  Eigen::MatrixXd K = s.K;
  if (neutral.directions.cols() == 0) return K;
  K(Eigen::all, Apart(neutral.directions).rows) -= (s.K - s.G * s.C) * neutral.directions;
  return K;
}

/// λ² of M λ² + K, where nothing depends on speeds: keeps pairs exact and zeros simple.
std::vector<Root> roots_at_rest(const Scaled& s, const Neutral& neutral) {
  const Quotient held(-solve_mass(s.M, cleared(s, neutral)), neutral.directions);
  const Eigenpairs found = eigenpairs(held.matrix());
  const Eigen::MatrixXcd shapes = held.vectors(found.values, found.vectors);
  std::vector<Root> roots;
  for (const auto& direction : neutral.directions.colwise()) roots.insert(roots.end(), 2, {0, direction});
  for (Eigen::Index i = 0; i < found.values.size(); ++i) {
    const Complex square = found.values[i];
    const Complex value = square.imag() == 0 ? (square.real() < 0 ? Complex(0, std::sqrt(-square.real()))
                                                                  : Complex(std::sqrt(square.real()), 0))
                                             : std::sqrt(square);
    roots.push_back({value, shapes.col(i)});
    roots.push_back({-value, shapes.col(i)});
  }
  return roots;
}

std::vector<Root> roots_in_motion(const Scaled& s, const Neutral& neutral) {
  const Eigen::Index n = s.M.rows();
  Eigen::MatrixXd A(2 * n, 2 * n);
  A << s.C, Eigen::MatrixXd::Identity(n, n), -solve_mass(s.M, cleared(s, neutral)), -solve_mass(s.M, s.G);
  Eigen::VectorXd units = Eigen::VectorXd::Ones(2 * n);
  units.tail(n).array() = unit_of_rates(A.bottomLeftCorner(n, n), A.bottomRightCorner(n, n));
  A = (units.cwiseInverse().asDiagonal() * A * units.asDiagonal()).eval();
  const Eigen::VectorXd balance = balance_of_states(A);
  A = (balance.cwiseInverse().asDiagonal() * A * balance.asDiagonal()).eval();
  units = units.cwiseProduct(balance).eval();
  Eigen::MatrixXd still(2 * n, neutral.directions.cols());
  still << neutral.directions, -s.C * neutral.directions;
  const Unchained unchained(A, units.cwiseInverse().asDiagonal() * still);
  std::vector<Root> roots;
  for (const auto& direction : unchained.directions().colwise()) {
    // Of a motion at a constant rate that rate is the shape: the displacements of a chain's later links are any.
    const Eigen::VectorXd z = units.cwiseProduct(direction);
    const bool moves = static_cast<Eigen::Index>(roots.size()) >= neutral.directions.cols() && !z.tail(n).isZero(0);
    roots.push_back({0, (moves ? z.tail(n) : z.head(n)).cast<Complex>()});
  }
  Eigenpairs found = eigenpairs(unchained.matrix());
  found.vectors = unchained.vectors(found.values, found.vectors);
  for (Eigen::Index i = 0; i < found.values.size(); ++i)
    roots.push_back({found.values[i], units.head(n).cast<Complex>().cwiseProduct(found.vectors.col(i).head(n))});
  return roots;
}

Mode mode_of(const Root& first, const Root& partner, const Scaled& s, const std::vector<Eigen::Index>& free,
             const Tangents& t) {
  Mode mode;
  mode.eigenvalue = first.value;
  mode.partner = partner.value;
  mode.rigid = first.value == 0.0 && partner.value == 0.0;
  const auto displacements = [&](const Root& root) {
    Eigen::VectorXcd shape = Eigen::VectorXcd::Zero(t.mass.rows());
    shape(free) = s.scale.cast<Complex>().cwiseProduct(root.shape);
    return shape;
  };
  mode.shape = displacements(first);
  mode.shares = kinetic_shares(t.mass, mode.shape);
  mode.shares.maxCoeff(&mode.dominant);
  kinetic_shares(t.mass, displacements(partner)).maxCoeff(&mode.partner_dominant);
  if (mode.shape[mode.dominant] != 0.0) mode.shape /= Complex(mode.shape[mode.dominant]);
  return mode;
}

/// Real eigenvalues belong together whose shapes are alike. The greatest first, so that zeros are left for each other.
std::vector<Mode> pairs_of(std::vector<const Root*> real, const Scaled& s, const std::vector<Eigen::Index>& free,
                           const Tangents& tangents) {
  std::vector<Mode> modes;
  std::sort(real.begin(), real.end(),
            [](const Root* a, const Root* b) { return std::abs(a->value) > std::abs(b->value); });
  const Eigen::VectorXd even = Eigen::VectorXd::Ones(s.M.rows());
  while (real.size() >= 2) {
    const Root* first = real.front();
    real.erase(real.begin());
    const auto likeness = [&](const Root* r) {
      const double alike = modal_assurance(first->shape, r->shape, even);
      return (r->value == 0.0) == (first->value == 0.0) ? alike : alike - 2;
    };
    const auto other = std::max_element(real.begin(), real.end(),
                                        [&](const Root* a, const Root* b) { return likeness(a) < likeness(b); });
    const Root* second = *other;
    real.erase(other);
    if ((first->value == 0.0) != (second->value == 0.0)) {
      // What nothing holds and something brakes: it stays anywhere, and comes to rest.
      for (const Root* r : {first, second}) {
        modes.push_back(mode_of(*r, *r, s, free, tangents));
        modes.back().single = true;
      }
      continue;
    }
    if (second->value.real() > first->value.real()) std::swap(first, second);
    modes.push_back(mode_of(*first, *second, s, free, tangents));
  }
  return modes;
}

}  // namespace

Eigen::VectorXd kinetic_shares(const Eigen::MatrixXd& mass, const Eigen::VectorXcd& shape) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(shape.size());
  const auto moved = shape.head(mass.rows());
  Eigen::VectorXd each = moved.conjugate().cwiseProduct(mass.cast<Complex>() * moved).real();
  if (!(each.sum() > 0)) each = moved.cwiseAbs2().cwiseProduct(mass.diagonal().cwiseAbs());
  if (const double all = each.sum(); all > 0) shares.head(mass.rows()) = each / all;
  return shares;
}

double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b, const Eigen::VectorXd& weights) {
  const auto product = [&](const Eigen::VectorXcd& x, const Eigen::VectorXcd& y) {
    return x.dot(weights.cast<Complex>().cwiseProduct(y));
  };
  const double size = product(a, a).real() * product(b, b).real();
  return size > 0 ? std::norm(product(a, b)) / size : 0.0;
}

std::vector<Mode> natural_modes(const Tangents& tangents, const Held& held) {
  if (tangents.by_state.cols() > 0) return modes_with_states(tangents, held);
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return {};
  const Scaled s(tangents, free);
  const bool at_rest = s.G.isZero(0) && s.C.isZero(0);
  const Neutral neutral(s, in_play_of(tangents, free, s));
  const std::vector<Root> roots = at_rest && neutral.simple ? roots_at_rest(s, neutral) : roots_in_motion(s, neutral);

  std::vector<Mode> modes;
  std::vector<const Root*> real;
  for (const Root& r : roots) {
    if (r.value.imag() > 0) modes.push_back(mode_of(r, {std::conj(r.value), r.shape}, s, free, tangents));
    if (r.value.imag() == 0) real.push_back(&r);
  }
  for (Mode& mode : pairs_of(std::move(real), s, free, tangents)) modes.push_back(std::move(mode));
  sort_modes(modes);
  return modes;
}

void sort_modes(std::vector<Mode>& modes) {
  double greatest = 0;
  for (const Mode& m : modes) greatest = std::max({greatest, std::abs(m.eigenvalue), std::abs(m.partner)});
  const auto key = [&](const Mode& m) {
    const double modulus = std::min(std::abs(m.eigenvalue), std::abs(m.partner));
    return std::pair(m.growth() <= m.resolution(greatest), modulus);
  };
  std::stable_sort(modes.begin(), modes.end(), [&](const Mode& a, const Mode& b) { return key(a) < key(b); });
}

FirstOrderForm first_order_form(const Tangents& tangents, const Held& held) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  const auto m = static_cast<Eigen::Index>(free.size());
  FirstOrderForm form{Eigen::MatrixXd::Zero(2 * m, 2 * m), Eigen::MatrixXd::Zero(2 * m, tangents.mass.rows())};
  if (m == 0) return form;
  const Scaled s(tangents, free);
  const auto scale = s.scale.asDiagonal();
  const Eigen::VectorXd inverse = s.scale.cwiseInverse();
  form.A.topLeftCorner(m, m) = tangents.drift(free, free);
  form.A.topRightCorner(m, m).setIdentity();
  form.A.bottomLeftCorner(m, m) = -(scale * solve_mass(s.M, s.K) * inverse.asDiagonal());
  form.A.bottomRightCorner(m, m) = -(scale * solve_mass(s.M, s.G) * inverse.asDiagonal());
  const Eigen::MatrixXd by_effort = scale * solve_mass(s.M, Eigen::MatrixXd(scale));
  for (Eigen::Index j = 0; j < m; ++j) form.B.col(free[static_cast<std::size_t>(j)]).tail(m) = by_effort.col(j);
  return form;
}

FirstOrderForm whole_first_order_form(const Tangents& tangents, const Held& held) {
  const FirstOrderForm form = first_order_form(tangents, held);
  const std::vector<Eigen::Index> free = free_speeds(held);
  const Eigen::Index n = form.A.rows(), m = n / 2, k = tangents.by_state.cols();
  if (k == 0) return form;
  FirstOrderForm whole{Eigen::MatrixXd::Zero(n + k, n + k), Eigen::MatrixXd::Zero(n + k, form.B.cols())};
  whole.A.topLeftCorner(n, n) = form.A;
  whole.A.topRightCorner(n, k) = -form.B * tangents.by_state;  // the residual has efforts on its other side
  whole.A.block(n, 0, k, m) = tangents.rate_by_position(Eigen::all, free);
  whole.A.block(n, m, k, m) = tangents.rate_by_speed(Eigen::all, free);
  whole.A.bottomRightCorner(k, k) = tangents.rate_by_state;
  whole.B.topRows(n) = form.B;
  const Eigen::MatrixXd G = tangents.rate_by_acceleration(Eigen::all, free);
  whole.A.bottomRows(k) += G * whole.A.middleRows(m, m);
  whole.B.bottomRows(k) = G * form.B.bottomRows(m);
  return whole;
}

Eigen::VectorXd balancing_units(const Eigen::MatrixXd& A, const Eigen::VectorXd& masses) {
  const Eigen::Index m = masses.size();
  Eigen::VectorXd units = Eigen::VectorXd::Ones(A.rows());
  const Eigen::VectorXd root = masses.cwiseMax(1e-300).cwiseSqrt();
  if (m > 0) {
    const auto scaled = [&](const auto& block) -> Eigen::MatrixXd {
      return root.asDiagonal() * block * root.cwiseInverse().asDiagonal();
    };
    const double unit = unit_of_rates(scaled(A.block(m, 0, m, m)), scaled(A.block(m, m, m, m)));
    units.head(2 * m) << root, root / unit;
  }
  if (A.rows() == 2 * m) return units;
  return units.cwiseQuotient(balance_of_states(units.asDiagonal() * A * units.cwiseInverse().asDiagonal()));
}

}  // namespace withy
