#include "withy/core/analysis/floquet.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/modes.hpp"
#include "withy/core/analysis/turning.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
constexpr int most_steps = 1 << 17;
/// Steps times the cube of rows: some ten seconds.
constexpr double most_work = 1e9;
/// What halving the steps may still change of the greatest element.
constexpr double followed = 1e-6;
/// Instants of a period at which eigenfunctions are looked at, and the fewest steps: a power of two, and more than the
/// samples of A, whose highest harmonic then takes two steps and more to go round. On longer steps two numbers of them
/// could agree and both not see it.
int fewest(const PeriodicMatrix& A) {
  int count = 64;
  while (count < A.samples()) count *= 2;
  return count;
}

Eigen::MatrixXd commutator(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b - b * a; }

/// z(t + h) = e^Ω z(t) to order six, from A at the three points of Gauss.
Eigen::MatrixXd step_matrix(const PeriodicMatrix& A, double t, double h) {
  const double apart = h * std::sqrt(15.0) / 10;
  const Eigen::MatrixXd before = A.at(t + h / 2 - apart), middle = A.at(t + h / 2), after = A.at(t + h / 2 + apart);
  const Eigen::MatrixXd a1 = h * middle, a2 = std::sqrt(15.0) / 3 * h * (after - before),
                        a3 = 10.0 / 3 * h * (after - 2 * middle + before);
  const Eigen::MatrixXd c1 = commutator(a1, a2), c2 = -1.0 / 60 * commutator(a1, 2 * a3 + c1);
  const Eigen::MatrixXd omega = a1 + a3 / 12 + 1.0 / 240 * commutator(-20 * a1 - a3 + c1, a2 + c2);
  return omega.exp();
}

struct Multipliers {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

Multipliers multipliers(const Eigen::MatrixXd& product) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(product);
  if (solver.info() != Eigen::Success) throw std::domain_error("the multipliers were not found");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

/// What is seen of the eigenfunctions over a turn: displacements at equal intervals, and mean frequencies.
struct Seen {
  std::vector<Eigen::MatrixXcd> displacements;  ///< of p(t): a column a mode
  Eigen::VectorXd frequency;  ///< [rad/s] mean of Im (δᴴ W δ̇)/(δᴴ W δ): of all harmonics, by share
};

/// \param units those of A and m
Seen look(const PeriodicMatrix& A, const Multipliers& m, const Eigen::VectorXcd& exponents,
          const Eigen::VectorXd& masses, const Eigen::VectorXd& units, int steps) {
  const Eigen::Index n = masses.size(), count = exponents.size();
  const double h = A.period() / steps;
  const Eigen::VectorXcd back = (-h * exponents).array().exp();
  Eigen::MatrixXcd x = m.vectors;
  Seen seen;
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(count), size = turned;
  const Eigen::VectorXcd from = units.head(n).cwiseInverse().cast<Complex>(), weights = masses.cast<Complex>();
  for (int k = 0; k < steps; ++k) {
    const Eigen::MatrixXcd rates = from.asDiagonal() * (A.at(k * h) * x).topRows(n),
                           at = from.asDiagonal() * x.topRows(n);
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::VectorXcd weighted = weights.cwiseProduct(at.col(c));
      turned[c] += weighted.dot(rates.col(c)).imag();
      size[c] += weighted.dot(at.col(c)).real();
    }
    if (k % (steps / fewest(A)) == 0) seen.displacements.push_back(at);
    x = step_matrix(A, k * h, h) * x * back.asDiagonal();
  }
  seen.frequency = turned.cwiseQuotient(size.cwiseMax(1e-300));
  return seen;
}

/// Harmonics of one eigenfunction, and from them the frequency that is seen and the shape.
void read_harmonics(const Seen& seen, Eigen::Index column, const Eigen::VectorXd& masses, double turn_rate,
                    CharacteristicMode& mode) {
  struct Harmonic {
    double share;
    double frequency;
    Eigen::VectorXcd shape;
  };
  std::vector<Harmonic> found;
  double total = 0;
  const auto instants = static_cast<int>(seen.displacements.size());
  for (int n = 0; n < instants; ++n) {
    Eigen::VectorXcd c = Eigen::VectorXcd::Zero(masses.size());
    for (int k = 0; k < instants; ++k)
      c += std::polar(1.0 / instants, -full_turn * n * k / instants) *
           seen.displacements[static_cast<std::size_t>(k)].col(column);
    const double share = (c.cwiseAbs2().array() * masses.array()).sum();
    total += share;
    // Samples tell a harmonic but for multiples of their number: it is the one nearest to the mean frequency.
    const double low = mode.exponent.imag() + n * turn_rate, round = instants * turn_rate;
    found.push_back({share, low + round * std::round((seen.frequency[column] - low) / round), std::move(c)});
  }
  // A motion of a real multiplier is real: what lies at f and at −f is one line of what is seen.
  if (mode.multiplier.imag() == 0) {
    for (Harmonic& f : found) {
      if (!(f.frequency > 0)) continue;
      const auto other = std::find_if(found.begin(), found.end(), [&](const Harmonic& g) {
        return std::abs(g.frequency + f.frequency) < 1e-6 * turn_rate;
      });
      if (other == found.end()) continue;
      f.share += other->share;
      other->share = 0;
    }
  }
  // Of equal ones that with the greater frequency, so that rounding decides nothing.
  std::stable_sort(found.begin(), found.end(), [&](const Harmonic& a, const Harmonic& b) {
    if (std::abs(a.share - b.share) > 1e-6 * total) return a.share > b.share;
    return a.frequency > b.frequency;
  });
  mode.exponent.imag(found[0].frequency);
  mode.share = total > 0 ? found[0].share / total : 1.0;
  for (const Harmonic& f : found) {
    if (total > 0 && f.share >= 0.01 * total) mode.lines.emplace_back(f.frequency, f.share / total);
  }
  mode.shape = found[0].shape;
  mode.shape.cwiseAbs2().cwiseProduct(masses).maxCoeff(&mode.dominant);
  if (mode.shape[mode.dominant] != 0.0) mode.shape /= Complex(mode.shape[mode.dominant]);
}

void conjugate(CharacteristicMode& mode) {
  mode.multiplier = std::conj(mode.multiplier);
  mode.exponent = std::conj(mode.exponent);
  mode.shape = mode.shape.conjugate().eval();
  for (auto& [frequency, share] : mode.lines) frequency = -frequency;
}

struct Integrated {
  Eigen::MatrixXd product;
  int steps = 0;
  double changed = 1;  ///< by halving the steps, of the greatest element
};

/// With steps halved until the product stays. \param A in units that balance it
Integrated integrated(const PeriodicMatrix& A) {
  constexpr double beyond = std::numeric_limits<double>::infinity();
  const auto rows = static_cast<double>(A.rows());
  Integrated whole{monodromy(A, fewest(A)), fewest(A)};
  double before = 2;
  // Where halving the step brings nothing more, rounding is all that is left. Steps that are much too long may leave
  // nothing finite.
  while (whole.changed > 1e-11 && !(whole.changed < 1e-7 && whole.changed > 0.5 * before)) {
    if (2 * whole.steps > most_steps || 2 * whole.steps * rows * rows * rows > most_work) break;
    whole.steps *= 2;
    Eigen::MatrixXd finer = monodromy(A, whole.steps);
    before = whole.changed;
    const double change = (finer - whole.product).cwiseAbs().maxCoeff() / finer.cwiseAbs().maxCoeff();
    whole.changed = std::isfinite(change) ? change : beyond;
    whole.product = std::move(finer);
  }
  if (whole.changed <= followed) return whole;
  const double turns = A.mean().eigenvalues().imag().cwiseAbs().maxCoeff() * A.period() / full_turn;
  throw std::domain_error("the fastest vibration goes to and fro " + std::to_string(std::llround(turns)) +
                          " times within it, and small motions are not followed through all of them in " +
                          std::to_string(whole.steps) + " steps: take fewer modes");
}

}  // namespace

PeriodicMatrix::PeriodicMatrix(const std::vector<Eigen::MatrixXd>& samples, double period)
    : period_(period), samples_(static_cast<int>(samples.size())) {
  const auto count = static_cast<int>(samples.size());
  const Eigen::Index rows = samples[0].rows(), columns = samples[0].cols();
  Eigen::MatrixXd sizes = Eigen::MatrixXd::Zero(rows, columns);
  for (const Eigen::MatrixXd& s : samples) sizes = sizes.cwiseMax(s.cwiseAbs());
  const double greatest = sizes.size() > 0 ? sizes.maxCoeff() : 0.0;
  // What goes round as often as the samples show is known as its angles are, to rounding of these.
  const double rounding = std::numeric_limits<double>::epsilon() * count;
  mean_ = Eigen::MatrixXd::Zero(rows, columns);
  for (const Eigen::MatrixXd& s : samples) mean_ += s / count;
  for (int n = 1; 2 * n < count; ++n) {
    Eigen::MatrixXcd c = Eigen::MatrixXcd::Zero(rows, columns);
    // n k may be large: its multiples of the count would leave rounding of the angle that is no harmonic.
    for (int k = 0; k < count; ++k)
      c += std::polar(2.0 / count, -full_turn * (n * k % count) / count) *
           samples[static_cast<std::size_t>(k)].cast<Complex>();
    const double size = greatest > 0 ? c.cwiseAbs().maxCoeff() / greatest : 0.0;
    change_ = std::max(change_, size);
    if (size > 1e-16 && (c.cwiseAbs().array() > rounding * sizes.array()).any())
      harmonics_.emplace_back(n, std::move(c));
  }
}

Eigen::MatrixXd PeriodicMatrix::at(double t) const {
  Eigen::MatrixXd a = mean_;
  for (const auto& [n, c] : harmonics_) {
    const double angle = full_turn * n * t / period_;
    a += std::cos(angle) * c.real() - std::sin(angle) * c.imag();
  }
  return a;
}

PeriodicMatrix PeriodicMatrix::in_units(const Eigen::VectorXd& units) const {
  PeriodicMatrix scaled = *this;
  const Eigen::VectorXd inverse = units.cwiseInverse();
  scaled.mean_ = units.asDiagonal() * mean_ * inverse.asDiagonal();
  for (auto& [n, c] : scaled.harmonics_) c = (units.asDiagonal() * c * inverse.asDiagonal()).eval();
  return scaled;
}

Eigen::MatrixXd monodromy(const PeriodicMatrix& A, int steps) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Identity(A.rows(), A.rows());
  const double h = A.period() / steps;
  for (int k = 0; k < steps; ++k) product = step_matrix(A, k * h, h) * product;
  return product;
}

FloquetAnalysis floquet(const PeriodicMatrix& A, const Eigen::VectorXd& masses) {
  FloquetAnalysis result;
  result.period = A.period();
  if (masses.size() == 0) return result;
  // Elsewhere fast vibrations make exponentials of numbers beyond all bounds on their way.
  const Eigen::VectorXd units = balancing_units(A.mean(), masses);
  const PeriodicMatrix balanced = A.in_units(units);
  const Integrated whole = integrated(balanced);
  result.steps = whole.steps;
  const Multipliers m = multipliers(whole.product);
  const double greatest = std::max(1.0, m.values.cwiseAbs().maxCoeff());
  // What a double multiplier without two eigenvectors, as of a motion that nothing holds back, is found to.
  result.resolution = std::max(std::max(whole.changed, 1e-7) / A.period(), A.unseen());

  const Eigen::Index count = m.values.size();
  Eigen::VectorXcd exponents(count);
  for (Eigen::Index i = 0; i < count; ++i) exponents[i] = std::log(m.values[i] + 1e-300) / A.period();
  const Seen seen = look(balanced, m, exponents, masses, units, whole.steps);
  for (Eigen::Index i = 0; i < count; ++i) {
    CharacteristicMode mode;
    mode.multiplier = m.values[i];
    mode.exponent = exponents[i];
    mode.resolved = std::abs(m.values[i]) > 1e-9 * greatest;
    if (m.values[i].imag() < 0) continue;  // the conjugate says the same
    if (mode.resolved) read_harmonics(seen, i, masses, full_turn / A.period(), mode);
    if (mode.exponent.imag() < 0) conjugate(mode);
    result.modes.push_back(std::move(mode));
  }
  // Of those that neither grow nor decay as far as can be told the slowest first.
  const auto growth = [&](const CharacteristicMode& mode) {
    return std::abs(mode.exponent.real()) <= result.resolution ? 0.0 : mode.exponent.real();
  };
  std::stable_sort(result.modes.begin(), result.modes.end(),
                   [&](const CharacteristicMode& a, const CharacteristicMode& b) {
                     const double of_a = growth(a), of_b = growth(b);
                     return of_a != of_b ? of_a > of_b : a.exponent.imag() < b.exponent.imag();
                   });
  return result;
}

}  // namespace withy
