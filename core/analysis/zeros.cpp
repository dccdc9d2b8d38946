#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "withy/core/analysis/balance_with_ends.hpp"
#include "withy/core/analysis/beside_one.hpp"
#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/unheld.hpp"
#include "withy/core/analysis/zero_errors.hpp"

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

/// A − s E, singular at the zeros of a system with D: [A − s 1, B; C, D] without the column that C and D are turned
/// onto (Emami-Naeini and Van Dooren 1982). Nothing is divided by D, beside which what the states carry to y may be of
/// any size.
struct Pencil {
  Eigen::MatrixXd A, E;
};

/// Of a slight D, with the states turned such that y sees the first alone: that goes with as much of the input as keeps
/// y at zero. E is 1 but for its first element, which is no difference of others, and which QZ keeps however small it
/// is, as the first.
Pencil pencil_of_slight(LinearSystem s, double unit, double turned) {
  const double seen = turn_seen_state(s, 0), share = unit * s.D(0, 0) / turned;
  Pencil p{s.A, Eigen::MatrixXd::Identity(s.A.rows(), s.A.rows())};
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
  if (std::abs(v[n]) < slight * turned) return pencil_of_slight(s, unit, turned);
  v[n] += v[n] < 0 ? -turned : turned;
  const Eigen::VectorXd x = v.head(n), along = 2 / v.squaredNorm() * x;
  return {s.A - (s.A * x + unit * v[n] * s.B) * along.transpose(),
          Eigen::MatrixXd::Identity(n, n) - x * along.transpose()};
}

/// What elements of [A, B; C, D] may be off by where those of A may be by `of_A`.
Eigen::MatrixXd rounding_of_all(const LinearSystem& s, double of_A) {
  const Eigen::Index n = s.A.rows();
  constexpr double of_greatest = 2e-16;
  const double share = of_greatest * static_cast<double>(n + 1);
  Eigen::MatrixXd all(n + 1, n + 1);
  all << rounding_of(s.A).array() + of_A, Eigen::VectorXd::Constant(n, share * s.B.cwiseAbs().maxCoeff()),
      Eigen::RowVectorXd::Constant(n, share * s.C.cwiseAbs().maxCoeff()), share * std::abs(s.D(0, 0));
  return all;
}

/// Takes off a state x̂ at rest: with some input it neither moves nor shows. States that differ by it are one.
void drop_resting(LinearSystem& s, const Eigen::VectorXd& at_rest, Eigen::MatrixXd& of_elements) {
  const Eigen::Index n = s.A.rows();
  Eigen::Index pivot = 0;
  at_rest.cwiseAbs().maxCoeff(&pivot);
  const Eigen::VectorXd x = at_rest / double(at_rest[pivot]);
  std::vector<Eigen::Index> kept, all;
  for (Eigen::Index i = 0; i <= n; ++i) {
    if (i == pivot) continue;
    all.push_back(i);
    if (i < n) kept.push_back(i);
  }
  Eigen::VectorXd by(n);
  by << x(kept), 0;
  of_elements = (of_elements(all, all) + by.cwiseAbs() * of_elements(pivot, all)).eval();
  s.B = (s.B(kept, Eigen::all) - x(kept) * s.B.row(pivot)).eval();
  s.A = (s.A(kept, kept) - x(kept) * s.A(pivot, kept)).eval();
  s.C = s.C(Eigen::all, kept).eval();
}

/// Takes off zeros at zero, as eigenvalues_with_zeros does of A: before others are sought, while rows and columns are
/// still those of single states, each measured by itself. \returns how many
Eigen::Index drop_zeros_at_zero(LinearSystem& s, double of_A) {
  Eigen::Index count = 0;
  if (s.A.rows() == 0) return count;
  for (Eigen::MatrixXd of_elements = rounding_of_all(s, of_A); s.A.rows() > 0; ++count) {
    const Eigen::Index n = s.A.rows();
    Eigen::MatrixXd all(n + 1, n + 1);
    all << s.A, s.B, s.C, s.D;
    const Eigen::MatrixXd gone = unheld_but_for(all, of_elements).topRows(n);
    if (gone.cols() == 0) break;
    Eigen::Index row = 0, column = 0;
    // An input that moves nothing, but for rounding, is no zero: the output does not feel it.
    if (!(gone.cwiseAbs().maxCoeff(&row, &column) > 0)) {
      s.B.setZero();
      break;
    }
    drop_resting(s, gone.col(column), of_elements);
  }
  return count;
}

/// Eigenvalues of A − s E. QZ comes to no end for one in a hundred of undamped trees, and then mostly does with rows
/// and columns turned. The QR algorithm always has; but what it divides by may be slight, and is so the last to be
/// asked.
Eigen::VectorXcd roots_of(const Pencil& p) {
  const Eigen::Index n = p.A.rows();
  if (!p.A.allFinite()) throw std::domain_error("the linear system is not finite");
  if (n == 0) return {};
  Eigen::GeneralizedEigenSolver<Eigen::MatrixXd> solver;
  solver.compute(p.A, p.E, false);
  if (solver.info() != Eigen::Success) {
    const Eigen::VectorXd across = Eigen::VectorXd::LinSpaced(n, 1, 2).normalized();
    const Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(n, n) - 2 * across * across.transpose();
    solver.compute(turn * p.A * turn, turn * p.E * turn, false);
  }
  if (solver.info() != Eigen::Success) {
    const Eigen::EigenSolver<Eigen::MatrixXd> divided(p.E.partialPivLu().solve(p.A), false);
    if (divided.info() != Eigen::Success) throw std::domain_error("the zeros were not found");
    return divided.eigenvalues();
  }
  Eigen::VectorXcd roots(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // One that is nowhere is as far away as rounding lets it be.
    const double beta = solver.betas()[i], least = 1e-16 * p.E.norm();
    roots[i] = solver.alphas()[i] / (std::abs(beta) > least ? beta : std::copysign(least, beta));
  }
  return roots;
}

/// Takes off what y alone sees until some of the input is seen at once. \returns the product of what it is seen with;
/// 0 where the output does not feel the input
double drop_seen_states(LinearSystem& s) {
  const double output = s.C.norm(), input = s.B.norm();
  double product = 1, scale = output;
  // D by itself, beside what the states carry to y: they have the unit of time between them, which the norm of A tells.
  double least = rounding_share * output * input / std::max(s.A.norm(), 1e-300);
  if (s.A.rows() == 0 || !(input > 0) || !(output > 0)) least = 0;
  while (!(std::abs(s.D(0, 0)) > least)) {
    if (s.A.rows() == 0) return 0;
    const double seen = drop_seen_state(s, scale);
    if (seen == 0) return 0;
    product *= seen;
    scale = std::max(s.A.norm(), s.C.norm());
    least = rounding_share * input;
  }
  return product;
}

}  // namespace

ZerosAndGain zeros(LinearSystem s) {
  balance_with_ends(s);
  const Eigen::Index n = s.A.rows();
  // What the loop neither sees nor moves rests between samples, and stands at 1 with what else is there, as of poles.
  const double one = s.sampled() ? 1 : 0;
  const double known = s.sampled() && n > 0 ? beside_one(n) * std::max(one, s.A.cwiseAbs().maxCoeff()) : 0;
  s.A.diagonal().array() -= one;
  const LinearSystem whole = s;
  const Eigen::Index resting = drop_zeros_at_zero(s, known);
  const double product = drop_seen_states(s);
  if (product == 0) return {};
  const Eigen::VectorXcd others = roots_of(pencil_of_zeros(s));
  ZerosAndGain found{{Eigen::VectorXcd::Zero(others.size() + resting), {}}, product * s.D(0, 0)};
  found.zeros.values.head(others.size()) = others;
  found.zeros.errors.setZero(found.zeros.values.size());
  if (others.size() == 0) {
    found.zeros.values.array() += one;
    return found;
  }
  const ZeroErrors errors(whole, known);
  for (Eigen::Index i = 0; i < others.size(); ++i) {
    const bool pair = i > 0 && others[i] == std::conj(others[i - 1]);
    found.zeros.errors[i] = pair ? found.zeros.errors[i - 1] : errors.of(found.zeros.values, i);
  }
  found.zeros.values.array() += one;
  return found;
}

}  // namespace withy
