#include "withy/core/analysis/turning_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "withy/core/analysis/between_instants.hpp"
#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/modes.hpp"

namespace withy {
namespace {

/// What rounding leaves of A, of its elements' sizes, and of the residual, of its terms.
constexpr double of_elements = 1e-11, of_terms = 1e-9;
/// Below it, what twice the instants do not halve is rounding too: where loads are differentiated by differences there
/// is more of it.
constexpr double may_be_rounding = 1e-6;
/// Beyond it not three digits of what is shown are known.
constexpr double three_digits = 1e-3;
/// Two rotors at 23 : 24 are together once in 24 turns of the faster; what goes round twice a turn of it is the 48th
/// harmonic of that period, and its tenth multiple is below half of these.
constexpr Eigen::Index most_instants = 1023;
/// Unknowns of a motion beyond 127 instants: some ten seconds of Newton's method.
constexpr Eigen::Index certain_instants = 127, most_unknowns = 4096;

/// The samples of A in units in which the frequency of each coordinate is the size of its own elements: beside
/// vibrations that are a million times stiffer what happens to a slow motion is nothing in any other.
struct OwnUnits {
  Eigen::VectorXd units;  ///< of z: units A units⁻¹
  Eigen::VectorXd rates;  ///< [1/s] of each state

  OwnUnits(const std::vector<Eigen::MatrixXd>& samples, const Eigen::VectorXd& masses, double period)
      : units(balancing_units(samples[0], masses)), rates(Eigen::VectorXd::Constant(units.size(), full_turn / period)) {
    const Eigen::Index m = masses.size();
    for (const Eigen::MatrixXd& sample : samples) {
      const Eigen::MatrixXd A = (units.asDiagonal() * sample * units.cwiseInverse().asDiagonal()).cwiseAbs();
      for (Eigen::Index i = 0; i < m; ++i)
        rates[i] = std::max({rates[i], std::sqrt(A(i, m + i) * A(m + i, i)), A(m + i, m + i)});
      for (Eigen::Index i = 2 * m; i < A.rows(); ++i)
        rates[i] = std::max({rates[i], A.row(i).maxCoeff(), A.col(i).maxCoeff()});
    }
    rates.segment(m, m) = rates.head(m);
    // δ̇ = u: rates of displacements of one have this size.
    const Eigen::VectorXd root = units.head(m);
    units.segment(m, m) = root.cwiseQuotient(rates.head(m));
  }
};

/// By how much A and the motion are others between the instants than the trigonometric polynomials say.
struct Missed {
  double share = 0;  ///< greatest, of elements and of terms
  double rate = 0;   ///< [1/s] greatest, of elements; what the motion misses changes A by this share of what varies
  bool none = true;  ///< but for rounding
};

/// What one instant shows. \param said A by its polynomial \param left of the motion, as in Between
void meet(Missed& missed, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& said, const Eigen::MatrixXd& mean,
          double left, const OwnUnits& own) {
  const auto in_units = [&](const Eigen::MatrixXd& of) -> Eigen::MatrixXd {
    return own.units.asDiagonal() * of * own.units.cwiseInverse().asDiagonal();
  };
  const Eigen::MatrixXd off = in_units(truth - said).cwiseAbs(),
                        sizes = in_units(truth).cwiseAbs() + (own.rates * own.rates.transpose()).cwiseSqrt();
  const double share = off.cwiseQuotient(sizes).maxCoeff(), varies = in_units(truth - mean).cwiseAbs().maxCoeff();
  missed.share = std::max({missed.share, share, left});
  missed.rate = std::max({missed.rate, off.maxCoeff(), left * varies});
  missed.none = missed.none && share <= of_elements && left <= of_terms;
}

/// A at one instant, of loads' states in units.
Eigen::MatrixXd form_at(const Tangents& t, const Held& held, const Eigen::VectorXd& units) {
  return units.cwiseInverse().asDiagonal() * whole_first_order_form(t, held).A * units.asDiagonal();
}

std::string why_not(Eigen::Index instants, const Missed& missed) {
  return "the equations of small motions change faster within it, or less smoothly, than " + std::to_string(instants) +
         " instants show: between these they are others by up to " +
         std::to_string(std::max(1LL, std::llround(100 * missed.share))) +
         " % of their terms, and whether small motions grow is not known";
}

}  // namespace

TurningForm turning_form(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
                         Eigen::Index least) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  const auto m = static_cast<Eigen::Index>(free.size());
  double before = std::numeric_limits<double>::infinity();
  for (Eigen::Index count = least;; count = 2 * count + 1) {
    Turn turn = find_turn(dynamics, start, held, turning, count);
    const Eigen::VectorXd units = balance_of_states(whole_first_order_form(turn.points[0], held).A, 2 * m);
    std::vector<Eigen::MatrixXd> samples;
    for (const Tangents& t : turn.points) samples.push_back(form_at(t, held, units));
    Eigen::VectorXd masses = turn.points[0].mass.diagonal()(free).cwiseAbs();
    PeriodicMatrix A(samples, turning.period);
    if (m == 0) return {std::move(A), std::move(masses), std::move(turn)};
    const OwnUnits own(samples, masses, turning.period);
    Missed missed;
    for (const double share : in_no_ratio) {
      const Between here = between_instants(dynamics, start, held, turning, turn, share, own.rates.head(m));
      meet(missed, form_at(here.tangents, held, units), A.at(share * turning.period), A.mean(), here.left, own);
    }
    A.set_unseen(missed.rate);
    const bool rounding = missed.share <= may_be_rounding && missed.share > 0.5 * before;
    before = missed.share;
    const Eigen::Index next = 2 * count + 1;
    const bool last = next > most_instants || (!turn.constant && next > certain_instants && m * next > most_unknowns);
    if (!missed.none && !rounding && !last) continue;
    if (!missed.none && missed.share > three_digits) throw std::domain_error(why_not(count, missed));
    return {std::move(A), std::move(masses), std::move(turn)};
  }
}

}  // namespace withy
