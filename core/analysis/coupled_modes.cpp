#include "withy/core/analysis/coupled_modes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
using Solver = Eigen::EigenSolver<Eigen::MatrixXd>;

/// Of the greatest multiplier: a pair of smaller ones is found with half of the digits that these have left.
constexpr double least_multiplier = 1e-7;

Solver decomposed(const Eigen::MatrixXd& A) {
  if (!A.allFinite()) throw std::domain_error("the derivatives at this state are not finite");
  Solver solver(A);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  return solver;
}

/// An eigenvalue with its vectors.
struct CoupledRoot {
  Complex value;
  Eigen::VectorXcd right, left;
};

/// Roots of A but for so many at zero, in the order of |λ|.
std::vector<CoupledRoot> roots_beside_zeros(const Eigen::MatrixXd& A, std::size_t zeros) {
  const Solver solver = decomposed(A);
  const Eigen::MatrixXcd z = solver.eigenvectors(), w = left_vectors(A, solver.eigenvalues());
  std::vector<CoupledRoot> roots;
  for (Eigen::Index i = 0; i < A.rows(); ++i) roots.push_back({solver.eigenvalues()[i], z.col(i), w.col(i)});
  std::stable_sort(roots.begin(), roots.end(),
                   [](const CoupledRoot& a, const CoupledRoot& b) { return std::abs(a.value) < std::abs(b.value); });
  roots.erase(roots.begin(), roots.begin() + static_cast<std::ptrdiff_t>(zeros));
  return roots;
}

/// What nothing holds: directions that A takes to nothing, to what derivatives are known to at the worst. Those that A
/// itself leads to are ends of chains, two zeros each: they go on at any rate.
struct Unheld {
  std::vector<Eigen::VectorXd> directions;
  std::vector<Eigen::Index> rows;  ///< in which the direction alone moves
  std::size_t pairs = 0;           ///< the first ones: of two zeros

  explicit Unheld(const Eigen::MatrixXd& A) {
    if (A.rows() == 0) return;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::VectorXd& values = svd.singularValues();
    const Eigen::Index count = (values.array() <= 1e-11 * values[0]).count();
    if (count == 0) return;
    const Eigen::MatrixXd N = svd.matrixV().rightCols(count);
    // What A leads to is seen by no left direction.
    const Eigen::JacobiSVD<Eigen::MatrixXd> seen(svd.matrixU().rightCols(count).transpose() * N, Eigen::ComputeFullV);
    const Eigen::Index alone = (seen.singularValues().array() > 1e-6).count();
    const Apart chained(N * seen.matrixV().rightCols(count - alone));
    add(chained);
    pairs = directions.size();
    add(Apart(N * seen.matrixV().leftCols(alone), &chained));
  }
  [[nodiscard]] std::size_t zeros() const { return directions.size() + pairs; }

 private:
  void add(const Apart& found) {
    for (std::size_t k = 0; k < found.rows.size(); ++k) {
      directions.emplace_back(found.columns.col(static_cast<Eigen::Index>(k)));
      rows.push_back(found.rows[k]);
    }
  }
};

/// Makes modes of eigenvectors.
class Naming {
 public:
  /// \param units of z: what the vectors are times these
  Naming(const Held& held, Eigen::VectorXd units)
      : free_(free_speeds(held)),
        m_(static_cast<Eigen::Index>(free_.size())),
        speeds_(static_cast<Eigen::Index>(held.size())),
        states_(units.size() - 2 * m_),
        units_(std::move(units)) {}

  /// \param single a real eigenvalue
  [[nodiscard]] Mode mode(const CoupledRoot& root, bool single) const {
    Mode mode = of(root.value, root.right, most_taking_part(root.left, root.right, m_));
    mode.single = single;
    mode.partner = mode.single ? root.value : std::conj(root.value);
    return mode;
  }
  /// \param row of z that moves
  [[nodiscard]] Mode unheld(const Eigen::VectorXd& direction, Eigen::Index row, bool single) const {
    Mode mode = of(0, direction.cast<Complex>(), row < m_ ? row : std::max(row - m_, m_));
    mode.rigid = true;
    mode.single = single;
    return mode;
  }

 private:
  /// \param dominant among the free displacements, then the states
  [[nodiscard]] Mode of(Complex value, const Eigen::VectorXcd& vector, Eigen::Index dominant) const {
    Mode mode;
    mode.eigenvalue = mode.partner = value;
    const Eigen::VectorXcd z = units_.cast<Complex>().cwiseProduct(vector);
    mode.shape = Eigen::VectorXcd::Zero(speeds_ + states_);
    mode.shape(free_) = z.head(m_);
    mode.shape.tail(states_) = z.tail(states_);
    mode.dominant = dominant < m_ ? free_[static_cast<std::size_t>(dominant)] : speeds_ + dominant - m_;
    mode.partner_dominant = mode.dominant;
    if (const Complex most = mode.shape[mode.dominant]; most != 0.0) mode.shape /= most;
    return mode;
  }

  std::vector<Eigen::Index> free_;
  Eigen::Index m_, speeds_, states_;
  Eigen::VectorXd units_;
};

/// The modes at zero of a balanced matrix.
struct Zeros {
  std::vector<Mode> modes;
  std::size_t count = 0;  ///< of eigenvalues

  Zeros(const Eigen::MatrixXd& balanced, const Naming& naming) {
    const Unheld unheld(balanced);
    for (std::size_t i = 0; i < unheld.rows.size(); ++i)
      modes.push_back(naming.unheld(unheld.directions[i], unheld.rows[i], i >= unheld.pairs));
    // Chains of more than two, as of the integral of a free coordinate, have more zeros, which show nothing else.
    count = modes.empty() ? 0 : std::max(unheld.zeros(), zeros_of(balanced));
    for (std::size_t i = unheld.zeros(); i < count; ++i) {
      modes.push_back(modes.back());
      modes.back().single = true;
    }
  }
};

/// Of λ + 2πik/T that in which most of the kinetic energy Σ M |λ δ|² is over a period; δ e^{−λt} is periodic. Of a real
/// multiplier the lowest one, unless what vibrates in step with the samples has clearly more: what is held between
/// samples makes a ripple in any motion.
Complex with_most_energy(Complex lambda, bool single, const MotionOverPeriod& motion, Eigen::Index column,
                         const PeriodMap& of) {
  constexpr double clearly = 10;
  const double round = 2 * std::numbers::pi / of.period;
  const auto energy = [&](Complex at) {
    Eigen::VectorXcd part = Eigen::VectorXcd::Zero(of.masses.size());
    for (std::size_t i = 0; i < motion.times.size(); ++i)
      part += motion.weights[i] * std::exp(-at * motion.times[i]) * motion.displacements[i].col(column);
    return std::norm(at) * part.cwiseAbs2().dot(of.masses);
  };
  Complex best = lambda;
  double greatest = (single ? clearly : 1) * energy(lambda);
  const auto most = static_cast<int>(std::min(std::ceil(motion.fastest / round), motion.times.size() / 4.0));
  for (int k = single ? 1 : -most; k <= most; ++k) {
    const Complex at = lambda + Complex(0, k * round);
    const double there = energy(at);
    if (there <= greatest) continue;
    greatest = there, best = at;
  }
  return best;
}

}  // namespace

Eigen::MatrixXcd left_vectors(const Eigen::MatrixXd& A, const Eigen::VectorXcd& values) {
  const Solver solver = decomposed(A.transpose());
  const Eigen::MatrixXcd all = solver.eigenvectors();
  Eigen::MatrixXcd left(A.rows(), values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    Eigen::Index nearest = 0;
    (solver.eigenvalues().array() - values[i]).abs().minCoeff(&nearest);
    left.col(i) = all.col(nearest);
  }
  return left;
}

Eigen::Index most_taking_part(const Eigen::VectorXcd& left, const Eigen::VectorXcd& right, Eigen::Index displacements) {
  const Eigen::VectorXd each = left.cwiseProduct(right).cwiseAbs();
  Eigen::VectorXd part(each.size() - displacements);
  part << each.head(displacements) + each.segment(displacements, displacements),
      each.tail(each.size() - 2 * displacements);
  Eigen::Index most = 0;
  part.maxCoeff(&most);
  return most;
}

std::vector<Mode> modes_with_states(const Tangents& tangents, const Held& held) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  const Eigen::MatrixXd A = whole_first_order_form(tangents, held).A;
  if (!A.allFinite()) throw std::domain_error("the derivatives at this state are not finite");
  const Eigen::VectorXd units = balancing_units(A, tangents.mass.diagonal()(free).cwiseAbs());
  const Eigen::MatrixXd balanced = units.asDiagonal() * A * units.cwiseInverse().asDiagonal();
  const Naming naming(held, units.cwiseInverse());
  Zeros zeros(balanced, naming);
  std::vector<Mode> modes = std::move(zeros.modes);
  for (const CoupledRoot& root : roots_beside_zeros(balanced, zeros.count))
    if (!(root.value.imag() < 0)) modes.push_back(naming.mode(root, root.value.imag() == 0));
  sort_modes(modes);
  return modes;
}

MapModes modes_of_map(const PeriodMap& of, const Held& held) {
  const Eigen::Index n = of.map.rows();
  if (!of.map.allFinite()) throw std::domain_error("the motion grows beyond all bounds between two samples");
  Eigen::VectorXd units = Eigen::VectorXd::Ones(n);
  units.head(of.units.size()) = of.units;
  const auto in_units = [&](const Eigen::MatrixXd& a) -> Eigen::MatrixXd {
    return units.asDiagonal() * a * units.cwiseInverse().asDiagonal();
  };
  // What stays as it is, e^{λT} = 1, is zero in these rates.
  const Eigen::MatrixXd rates = (of.map - Eigen::MatrixXd::Identity(n, n)) / of.period;
  units = units.cwiseQuotient(balance_of_states(in_units(rates))).eval();
  const Eigen::MatrixXd balanced = in_units(rates);
  const Naming naming(held, units.cwiseInverse());
  Zeros zeros(balanced, naming);
  MapModes found{std::move(zeros.modes), zeros_of(in_units(of.map))};

  std::vector<CoupledRoot> roots = roots_beside_zeros(balanced, zeros.count);
  const auto multiplier = [&](const CoupledRoot& r) { return 1.0 + of.period * r.value; };
  std::stable_sort(roots.begin(), roots.end(), [&](const CoupledRoot& a, const CoupledRoot& b) {
    return std::abs(multiplier(a)) > std::abs(multiplier(b));
  });
  roots.resize(roots.size() - std::min(roots.size(), found.gone));
  const double least = least_multiplier * (roots.empty() ? 1.0 : std::max(1.0, std::abs(multiplier(roots.front()))));
  found.gone += std::erase_if(roots, [&](const CoupledRoot& r) { return std::abs(multiplier(r)) < least; });
  std::erase_if(roots, [](const CoupledRoot& r) { return r.value.imag() < 0; });
  Eigen::MatrixXcd motions(n, static_cast<Eigen::Index>(roots.size()));
  for (std::size_t i = 0; i < roots.size(); ++i)
    motions.col(static_cast<Eigen::Index>(i)) = units.cwiseInverse().cast<Complex>().cwiseProduct(roots[i].right);
  const MotionOverPeriod between = of.between(motions);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    CoupledRoot root = roots[i];
    const bool single = root.value.imag() == 0;
    root.value = std::log(multiplier(root)) / of.period;
    root.value = with_most_energy(root.value, single, between, static_cast<Eigen::Index>(i), of);
    if (root.value.imag() < 0) root = {std::conj(root.value), root.right.conjugate(), root.left.conjugate()};
    found.modes.push_back(naming.mode(root, single));
  }
  sort_modes(found.modes);
  return found;
}

}  // namespace withy
