#include "withy/core/analysis/linear_system.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

/// Below this share of its factors a number is rounding of them.
constexpr double rounding_share = 1e-11;

/// Turns the states by a reflection such that y sees one of them alone. \returns what it sees it with; C is as before
double turn_seen_state(LinearSystem& s, Eigen::Index onto) {
  const double seen = s.C.norm();
  Eigen::VectorXd v = s.C.transpose();
  const double sign = v[onto] < 0 ? 1.0 : -1.0;
  v[onto] -= sign * seen;
  const double square = v.squaredNorm();
  if (square > 0) {
    s.A -= (2 / square) * v * (v.transpose() * s.A).eval();
    s.A -= (2 / square) * (s.A * v).eval() * v.transpose();
    s.B -= (2 / square) * v * (v.transpose() * s.B).eval();
  }
  return sign * seen;
}

/// Takes off the state that y alone sees: it and its rate are zero where y is. What is left sees, as its output, what
/// would move that state. \returns what y sees it with, 0 where y sees no state
double drop_seen_state(LinearSystem& s, double scale) {
  const Eigen::Index n = s.A.rows();
  if (!(s.C.norm() > rounding_share * scale)) return 0;
  const double seen = turn_seen_state(s, n - 1);
  const Eigen::MatrixXd A = s.A, B = s.B;
  s.A = A.topLeftCorner(n - 1, n - 1);
  s.C = A.bottomLeftCorner(1, n - 1);
  s.B = B.topRows(n - 1);
  s.D = B.bottomRows(1);
  return seen;
}

/// What rounding of a matrix moves its eigenvalues by: its size times what the vectors of each make of it, and of
/// double ones without two vectors, of which the vectors tell nothing, its root.
Eigen::VectorXd moved_by_rounding(const Eigen::MatrixXcd& vectors, double of_matrix, double size) {
  const Eigen::MatrixXcd left = Eigen::PartialPivLU<Eigen::MatrixXcd>(vectors).inverse();
  Eigen::VectorXd moved(vectors.cols());
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    const double at_most = std::sqrt(of_matrix * size), here = of_matrix * left.row(i).norm() * vectors.col(i).norm();
    moved[i] = here < at_most ? here : at_most;
  }
  return moved;
}

/// Eigenvalues with zero for each direction that A takes to nothing, and again for what is left without it: a chain of
/// integrators, whose eigenvalues rounding would spread by its root, is taken apart link by link. Those are exact.
/// \param rounding of elements, beside that of A itself
KnownRoots eigenvalues_with_zeros(const Eigen::MatrixXd& A, double rounding) {
  constexpr double share = 1e-13;
  if (!A.allFinite()) throw std::domain_error("the linear system is not finite");
  KnownRoots roots{Eigen::VectorXcd::Zero(A.rows()), Eigen::VectorXd::Zero(A.rows())};
  Eigen::MatrixXd left = A, of_elements = rounding_of(A).array() + rounding;
  for (Eigen::MatrixXd gone = unheld_but_for(left, of_elements); gone.cols() > 0;
       gone = unheld_but_for(left, of_elements)) {
    const Quotient link(left, gone);
    of_elements = link.rounding(of_elements);
    left = link.matrix();
  }
  if (left.rows() == 0) return roots;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(left);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  roots.values.head(left.rows()) = solver.eigenvalues();
  const double size = left.norm();
  roots.errors.head(left.rows()) = moved_by_rounding(solver.eigenvectors(), share * size, size);
  return roots;
}

/// What a number beside one is rounded to, in a matrix of so many rows.
double beside_one(Eigen::Index rows) { return 2e-16 * static_cast<double>(rows); }

/// Balances B and C too, as if y were the input: a state that A does not move, or that moves none, has units all the
/// same, by which the others are not to be measured.
void balance_with_ends(LinearSystem& s) {
  const Eigen::Index n = s.A.rows();
  Eigen::MatrixXd closed = Eigen::MatrixXd::Zero(n + 1, n + 1);
  closed << s.A, s.B, s.C, 0;
  LinearSystem all{closed, Eigen::MatrixXd::Zero(n + 1, 0), Eigen::MatrixXd::Zero(0, n + 1), {}};
  balance(all);
  s.A = all.A.topLeftCorner(n, n);
  s.B = all.A.topRightCorner(n, 1);
  s.C = all.A.bottomLeftCorner(1, n);
}

/// A − s E, singular at the zeros of a system with D: [A − s 1, B; C, D] without the column that C and D are turned
/// onto (Emami-Naeini and Van Dooren 1982). Nothing is divided by D, beside which what the states carry to y may be of
/// any size.
struct Pencil {
  Eigen::MatrixXd A, E;
  double turned = 0;  ///< length of C and D
};

/// Of a slight D, with the states turned such that y sees the first alone: that goes with as much of the input as keeps
/// y at zero. E is 1 but for its first element, which is no difference of others, and which QZ keeps however small it
/// is, as the first.
Pencil pencil_of_slight(LinearSystem s, double unit, double turned) {
  const double seen = turn_seen_state(s, 0), share = unit * s.D(0, 0) / turned;
  Pencil p{s.A, Eigen::MatrixXd::Identity(s.A.rows(), s.A.rows()), turned};
  p.A.col(0) = share * s.A.col(0) - (seen / turned) * unit * s.B;
  p.E(0, 0) = share;
  return p;
}

/// \param s balanced; D is not zero
Pencil pencil_of_zeros(const LinearSystem& s) {
  constexpr double slight = 1e-3;
  const Eigen::Index n = s.A.rows();
  const double input = s.B.norm(), unit = input > 0 && s.A.norm() > 0 ? s.A.norm() / input : 1;
  Eigen::VectorXd v(n + 1);
  v << s.C.transpose(), unit * s.D(0, 0);
  const double turned = v.norm();
  // Turned states are mixed, and what is zero beside its own row and column is harder to tell: not without need.
  if (std::abs(v[n]) < slight * turned) return pencil_of_slight(s, unit, turned);
  v[n] += v[n] < 0 ? -turned : turned;
  const Eigen::VectorXd x = v.head(n), along = 2 / v.squaredNorm() * x;
  return {s.A - (s.A * x + unit * v[n] * s.B) * along.transpose(),
          Eigen::MatrixXd::Identity(n, n) - x * along.transpose(), turned};
}

/// Takes directions off that A takes to nothing and E does not, as Quotient does where E is 1.
/// \param of_elements what elements of A may be off by; becomes that of what is left
void drop(Pencil& p, const Eigen::MatrixXd& directions, Eigen::MatrixXd& of_elements) {
  const Apart right(directions), left(p.E * right.columns);
  const auto others = [&](const std::vector<Eigen::Index>& gone) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < p.A.rows(); ++i)
      if (std::find(gone.begin(), gone.end(), i) == gone.end()) kept.push_back(i);
    return kept;
  };
  const std::vector<Eigen::Index> rows = others(left.rows), columns = others(right.rows);
  const Eigen::MatrixXd by = left.columns(rows, Eigen::all);
  const auto without = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return m(rows, columns) - by * m(left.rows, columns);
  };
  of_elements = (of_elements(rows, columns) + by.cwiseAbs() * of_elements(left.rows, columns)).eval();
  p.A = without(p.A);
  p.E = without(p.E);
}

/// Whether another of the values is as near as that.
bool has_neighbour(const Eigen::VectorXcd& values, Eigen::Index i, double near) {
  return (((values.array() - values[i]).abs() <= near).count()) > 1;
}

/// As eigenvalues_with_zeros. \param known how much more than rounding the pencil may be off by
KnownRoots roots_of(Pencil p, double rounding, double known) {
  constexpr double share = 1e-13;
  if (!p.A.allFinite()) throw std::domain_error("the linear system is not finite");
  KnownRoots roots{Eigen::VectorXcd::Zero(p.A.rows()), Eigen::VectorXd::Zero(p.A.rows())};
  Eigen::MatrixXd of_elements = rounding_of(p.A).array() + rounding;
  for (Eigen::MatrixXd gone = unheld_but_for(p.A, of_elements); gone.cols() > 0;
       gone = unheld_but_for(p.A, of_elements))
    drop(p, gone, of_elements);
  if (p.A.rows() == 0) return roots;
  const Eigen::GeneralizedEigenSolver<Eigen::MatrixXd> solver(p.A, p.E);
  if (solver.info() != Eigen::Success) throw std::domain_error("the zeros were not found");
  const Eigen::MatrixXcd right = solver.eigenvectors();
  const Eigen::MatrixXcd left = Eigen::PartialPivLU<Eigen::MatrixXcd>(p.E * right).inverse();
  for (Eigen::Index i = 0; i < p.A.rows(); ++i) {
    // One that is nowhere is as far away as rounding lets it be.
    const double beta = solver.betas()[i], least = 1e-16 * p.E.norm();
    roots.values[i] = solver.alphas()[i] / (std::abs(beta) > least ? beta : std::copysign(least, beta));
  }
  for (Eigen::Index i = 0; i < p.A.rows(); ++i) {
    const double far = std::abs(roots.values[i]), lengths = left.row(i).norm() * right.col(i).norm();
    // Elements of E are known each by itself, but where D is a difference.
    const double of_E = known > 1 ? known * lengths : left.row(i).cwiseAbs() * p.E.cwiseAbs() * right.col(i).cwiseAbs();
    const double here = share * (known * p.A.norm() * lengths + far * of_E);
    // Of double ones without two vectors, of which the vectors tell nothing.
    const double at_most = std::sqrt(share * known) * (p.A.norm() + far);
    const bool alike = !std::isfinite(here) || has_neighbour(roots.values.head(p.A.rows()), i, at_most);
    roots.errors[i] = alike && !(here < at_most) ? at_most : here;
  }
  return roots;
}

}  // namespace

Complex LinearSystem::at_frequency(double omega) const {
  return sampled() ? std::polar(1.0, omega * period) : Complex(0, omega);
}

LinearSystem LinearSystem::between(Eigen::Index input, Eigen::Index output) const {
  return {A, B.col(input), C.row(output), D.block(output, input, 1, 1), period};
}

Eigen::VectorXd balance_of_states(Eigen::MatrixXd A, Eigen::Index first) {
  const Eigen::Index n = A.rows();
  Eigen::VectorXd units = Eigen::VectorXd::Ones(n);
  bool better = true;
  for (int round = 0; better && round < 100; ++round) {
    better = false;
    for (Eigen::Index i = first; i < n; ++i) {
      const double own = std::abs(A(i, i));
      const double column = A.col(i).lpNorm<1>() - own, row = A.row(i).lpNorm<1>() - own;
      if (!(column > 0) || !(row > 0)) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (column * f + row / f > 0.95 * (column + row)) continue;
      A.col(i) *= f;
      A.row(i) /= f;
      units[i] *= f;
      better = true;
    }
  }
  return units;
}

Eigen::VectorXd balance(LinearSystem& s) {
  const Eigen::VectorXd units = balance_of_states(s.A);
  // Powers of two: nothing is rounded.
  s.A = (units.cwiseInverse().asDiagonal() * s.A * units.asDiagonal()).eval();
  s.B = units.cwiseInverse().asDiagonal() * s.B;
  s.C = s.C * units.asDiagonal();
  return units;
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> hold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double T) {
  const Eigen::Index n = A.rows(), m = B.cols();
  // The exponential is exact for the norm of all of it: in units in which states, and inputs beside them, are of one
  // size. What a newton does to a gram is a large number, and what matters to it would be lost beside it.
  LinearSystem s{A, B, Eigen::MatrixXd::Zero(0, n), Eigen::MatrixXd::Zero(0, m)};
  const Eigen::VectorXd of_states = balance(s);
  Eigen::VectorXd of_inputs = Eigen::VectorXd::Ones(m);
  const double size = s.A.norm();
  for (Eigen::Index k = 0; k < m; ++k)
    if (const double felt = s.B.col(k).norm(); felt > 0)
      of_inputs[k] = std::exp2(std::round(std::log2((size > 0 ? size : 1) / felt)));
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = s.A * T;
  both.topRightCorner(n, m) = s.B * of_inputs.asDiagonal() * T;
  if (!both.allFinite()) throw std::domain_error("the linear system is not finite");
  const Eigen::MatrixXd e = both.exp();
  return {of_states.asDiagonal() * e.topLeftCorner(n, n) * of_states.cwiseInverse().asDiagonal(),
          of_states.asDiagonal() * e.topRightCorner(n, m) * of_inputs.cwiseInverse().asDiagonal()};
}

KnownRoots known_poles(const LinearSystem& system) {
  LinearSystem s = system;
  balance(s);
  if (!s.sampled()) return eigenvalues_with_zeros(s.A, 0);
  // What rests between samples stands at 1.
  const double size = std::max(1.0, s.A.size() > 0 ? s.A.cwiseAbs().maxCoeff() : 0.0);
  s.A.diagonal().array() -= 1;
  KnownRoots roots = eigenvalues_with_zeros(s.A, beside_one(s.A.rows()) * size);
  roots.values.array() += 1;
  return roots;
}

Eigen::VectorXcd poles(const LinearSystem& system) { return known_poles(system).values; }

std::size_t zeros_of(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd exact =
      poles({A, Eigen::MatrixXd::Zero(A.rows(), 0), Eigen::MatrixXd::Zero(0, A.rows()), Eigen::MatrixXd()});
  return static_cast<std::size_t>((exact.array() == Complex(0)).count());
}

double unit_of_rates(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) {
  const double stiffest = K.size() > 0 ? K.cwiseAbs().maxCoeff() : 0.0;
  if (stiffest > 0) return std::sqrt(stiffest);
  const double fastest = G.size() > 0 ? G.cwiseAbs().maxCoeff() : 0.0;
  return fastest > 0 ? fastest : 1.0;
}

ZerosAndGain zeros(LinearSystem s) {
  balance_with_ends(s);
  const double output = s.C.norm(), input = s.B.norm(), direct = std::abs(s.D(0, 0));
  double product = 1, scale = output;
  // D by itself, beside what the states carry to y: they have the unit of time between them, which the norm of A tells.
  double least = rounding_share * output * input / std::max(s.A.norm(), 1e-300);
  if (s.A.rows() == 0 || !(input > 0) || !(output > 0)) least = 0;
  double through = direct;
  bool dropped = false;
  while (!(through > least)) {
    if (s.A.rows() == 0) return {};
    const double seen = drop_seen_state(s, scale);
    if (seen == 0) return {};
    product *= seen;
    scale = std::max(s.A.norm(), s.C.norm());
    least = rounding_share * input;
    through = std::abs(s.D(0, 0));
    dropped = true;
  }
  // D of a state that was dropped is what is left of a vector as long as B, and known to the rounding of that; the
  // system's own D is known to its own.
  Pencil pencil = pencil_of_zeros(s);
  const double known = dropped ? std::max(1.0, pencil.A.norm() / pencil.turned) : 1.0;
  if (!s.sampled()) return {roots_of(std::move(pencil), 0, known), product * s.D(0, 0)};
  // As of poles: what the loop neither sees nor moves rests between samples, and stands at 1 with what else is there.
  pencil.A -= pencil.E;
  const double rounding = beside_one(pencil.A.rows()) * std::max(1.0, pencil.A.norm());
  ZerosAndGain found{roots_of(std::move(pencil), rounding, known), product * s.D(0, 0)};
  found.zeros.values.array() += 1;
  return found;
}

TransferFunction::TransferFunction(LinearSystem system) : given_(std::move(system)), of_(given_) {
  if (of_.B.cols() == 1 && of_.C.rows() == 1)
    balance_with_ends(of_);
  else
    balance(of_);
  if (of_.A.rows() < 2) return;
  const Eigen::HessenbergDecomposition<Eigen::MatrixXd> form(of_.A);
  const Eigen::MatrixXd Q = form.matrixQ();
  of_.A = form.matrixH();
  of_.B = Q.transpose() * of_.B;
  of_.C = of_.C * Q;
}

Eigen::MatrixXcd TransferFunction::operator()(Complex s) const {
  const Eigen::Index n = of_.A.rows();
  // Gaussian elimination below the diagonal of a Hessenberg matrix: one row a column, neighbours exchanged.
  Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> H = -of_.A.cast<Complex>(),
                                                                          x = of_.B.cast<Complex>();
  H.diagonal().array() += s;
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    if (std::abs(H(k + 1, k)) > std::abs(H(k, k))) {
      H.row(k).tail(n - k).swap(H.row(k + 1).tail(n - k));
      x.row(k).swap(x.row(k + 1));
    }
    if (H(k + 1, k) == 0.0) continue;
    const Complex factor = H(k + 1, k) / H(k, k);
    H.row(k + 1).tail(n - k) -= factor * H.row(k).tail(n - k);
    x.row(k + 1) -= factor * x.row(k);
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    for (Eigen::Index j = k + 1; j < n; ++j) x.row(k) -= H(k, j) * x.row(j);
    x.row(k) /= H(k, k);
  }
  return of_.C.cast<Complex>() * x + of_.D.cast<Complex>();
}

}  // namespace withy
