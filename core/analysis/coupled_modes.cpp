#include "withy/core/analysis/coupled_modes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "withy/core/analysis/eigenpairs.hpp"
#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/still_equations.hpp"
#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

/// Of the greatest multiplier: a pair of smaller ones is found with half of the digits that these have left.
constexpr double least_multiplier = 1e-7;

/// An eigenvalue with its vectors.
struct CoupledRoot {
  Complex value;
  Eigen::VectorXcd right, left;
};

/// Roots but for those at zero, in the order of |λ|. They are found where what nothing holds is gone: beside it a
/// vector would have any part of it that rounding brings in.
std::vector<CoupledRoot> roots_beside_zeros(const Unchained& unchained) {
  const Eigenpairs found = eigenpairs(unchained.matrix());
  const Eigen::MatrixXcd z = unchained.vectors(found.values, found.vectors),
                         w = unchained.left_vectors(left_vectors(unchained.matrix(), found.values));
  std::vector<CoupledRoot> roots;
  for (Eigen::Index i = 0; i < found.values.size(); ++i) roots.push_back({found.values[i], z.col(i), w.col(i)});
  std::stable_sort(roots.begin(), roots.end(),
                   [](const CoupledRoot& a, const CoupledRoot& b) { return std::abs(a.value) < std::abs(b.value); });
  return roots;
}

/// Makes modes of eigenvectors.
class Naming {
 public:
  /// \param units of z: what the vectors are times these
  /// \param mass of the free speeds
  Naming(const Held& held, Eigen::VectorXd units, Eigen::MatrixXd mass)
      : free_(free_speeds(held)),
        m_(static_cast<Eigen::Index>(free_.size())),
        speeds_(static_cast<Eigen::Index>(held.size())),
        states_(units.size() - 2 * m_),
        units_(std::move(units)),
        mass_(std::move(mass)) {}

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
    mode.shares = Eigen::VectorXd::Zero(speeds_ + states_);
    mode.shares(free_) = kinetic_shares(mass_, z.head(m_));
    mode.dominant = dominant < m_ ? free_[static_cast<std::size_t>(dominant)] : speeds_ + dominant - m_;
    mode.partner_dominant = mode.dominant;
    if (const Complex most = mode.shape[mode.dominant]; most != 0.0) mode.shape /= most;
    return mode;
  }

  std::vector<Eigen::Index> free_;
  Eigen::Index m_, speeds_, states_;
  Eigen::VectorXd units_;
  Eigen::MatrixXd mass_;
};

/// The modes at zero. Directions that end chains have two zeros each: they go on at any rate.
std::vector<Mode> modes_at_zero(const Unchained& unchained, const Eigen::MatrixXd& unheld, const Naming& naming) {
  std::vector<Mode> modes;
  if (unheld.cols() == 0) return modes;
  // Of the directions, in their own coordinates: first those that end chains.
  Eigen::MatrixXd apart = Eigen::MatrixXd::Identity(unheld.cols(), unheld.cols());
  Eigen::Index pairs = 0;
  if (unchained.led_to().cols() > 0) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> ends(
        unheld.colPivHouseholderQr().solve(unchained.led_to().colwise().normalized()), Eigen::ComputeFullU);
    apart = ends.matrixU();
    pairs = ends.rank();
  }
  const auto add = [&](const Apart& found, bool single) {
    for (std::size_t k = 0; k < found.rows.size(); ++k)
      modes.push_back(naming.unheld(found.columns.col(static_cast<Eigen::Index>(k)), found.rows[k], single));
  };
  const Apart chained(unheld * apart.leftCols(pairs));
  add(chained, false);
  add(Apart(unheld * apart.rightCols(unheld.cols() - pairs), &chained), true);
  // Chains of more than two, as of the integral of a free coordinate, have more zeros, which show nothing else.
  for (Eigen::Index i = unheld.cols() + pairs; i < unchained.directions().cols(); ++i) {
    modes.push_back(modes.back());
    modes.back().single = true;
  }
  return modes;
}

/// Of λ + 2πik/T that in which most of the kinetic energy Σ M_ii |λ δ_i|² is over a period; δ e^{−λt} is periodic. Of a
/// real multiplier the lowest one, unless what vibrates in step with the samples has clearly more: what is held between
/// samples makes a ripple in any motion.
Complex with_most_energy(Complex lambda, bool single, const MotionOverPeriod& motion, Eigen::Index column,
                         const PeriodMap& of) {
  constexpr double clearly = 10;
  const double round = 2 * std::numbers::pi / of.period;
  const auto energy = [&](Complex at) {
    Eigen::VectorXcd part = Eigen::VectorXcd::Zero(of.mass.rows());
    for (std::size_t i = 0; i < motion.times.size(); ++i)
      part += motion.weights[i] * std::exp(-at * motion.times[i]) * motion.displacements[i].col(column);
    return std::norm(at) * part.cwiseAbs2().dot(of.mass.diagonal().cwiseAbs());
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
  const Eigenpairs all = eigenpairs(A.transpose());
  Eigen::MatrixXcd left(A.rows(), values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    Eigen::Index nearest = 0;
    (all.values.array() - values[i]).abs().minCoeff(&nearest);
    left.col(i) = all.vectors.col(nearest);
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
  const Naming naming(held, units.cwiseInverse(), tangents.mass(free, free));
  const Eigen::MatrixXd unheld = units.asDiagonal() * unheld_motions(tangents, held);
  const Unchained unchained(balanced, unheld);
  std::vector<Mode> modes = modes_at_zero(unchained, unheld, naming);
  for (const CoupledRoot& root : roots_beside_zeros(unchained))
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
  // Motions have units that do for their equations: what nothing holds would be given one by rounding.
  units = units.cwiseQuotient(balance_of_states(in_units(rates), of.units.size())).eval();
  const Naming naming(held, units.cwiseInverse(), of.mass);
  const Eigen::MatrixXd unheld = units.asDiagonal() * of.unheld;
  const Unchained unchained(in_units(rates), unheld);
  MapModes found{modes_at_zero(unchained, unheld, naming), zeros_of(in_units(of.map))};

  std::vector<CoupledRoot> roots = roots_beside_zeros(unchained);
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
