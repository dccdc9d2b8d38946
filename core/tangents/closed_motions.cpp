#include "withy/core/tangents/closed_motions.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/tangents/displacements.hpp"

namespace withy {
namespace {

/// Of the greatest, what is left of an equation beside the others where it is independent of them, as ClosedLoops has
/// it.
constexpr double independent = 1e-6;
/// Lengths that what follows moves by where what it follows moves by one: there it turns back, and nearer than this the
/// motions are not those of that speed.
constexpr double turns_back = 1e3;

/// [rad], and in lengths of the loop: how far at a time motions are followed, and what follows may have to be moved
/// then.
constexpr double near_by = 0.2;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// An orthonormal basis of what the rows take to nothing, in columns.
Eigen::MatrixXd null_columns(const Eigen::MatrixXd& rows) {
  if (rows.isZero(0)) return Eigen::MatrixXd::Identity(rows.cols(), rows.cols());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(rows.transpose());
  factors.setThreshold(independent);
  const Eigen::MatrixXd Q = factors.householderQ();
  return Q.rightCols(rows.cols() - factors.rank());
}

/// Takes from the candidates the first that moves by at least a share of what moves most, and its motion from the
/// motions. \returns its place; the number of candidates where none does
std::size_t take_first(const std::vector<Eigen::Index>& candidates, double share, Eigen::MatrixXd& motions) {
  const double most = motions.rowwise().norm().maxCoeff();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Eigen::RowVectorXd own = motions.row(candidates[k]);
    if (!(own.norm() >= share * most) || own.isZero(0)) continue;
    motions -= (motions * own.transpose()).eval() * own / own.squaredNorm();
    return k;
  }
  return candidates.size();
}

Eigen::MatrixXd transposed_inverse(const Eigen::MatrixXd& of_followers) {
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors(of_followers.transpose());
  return factors.pseudoInverse();
}

}  // namespace

ClosedMotions::ClosedMotions(const Model& model, std::shared_ptr<const EquationsOfMotion> equations, const State& state,
                             const std::vector<bool>& held)
    : model_(model),
      equations_(std::move(equations)),
      loops_(dynamic_cast<const ClosedLoops&>(*equations_)),
      length_(length_of_loops(model)),
      reaches_(reaches_of_speeds(model, length_)),
      in_loops_(speeds_in_loops(model)),
      follows_(held.size(), false) {
  choose(see(state.y).J, held);
}

void ClosedMotions::choose(const Eigen::MatrixXd& J, const std::vector<bool>& held) {
  /// Of what moves most. Modes rather move by themselves than hinges, whose motion they ask for.
  constexpr double share_of_modes = 0.1, share_of_hinges = 0.8;
  const Layout& layout = model_.layout();
  std::vector<Eigen::Index> all;  // speeds
  std::vector<Eigen::Index> modes, hinges;
  const auto add = [&](const std::vector<Slot>& slots, std::vector<Eigen::Index>& to) {
    for (const Slot& slot : slots)
      for (std::size_t s = slot.speed; s < slot.speed + slot.speeds; ++s)
        if (in_loops_[s] && !held[s]) {
          to.push_back(static_cast<Eigen::Index>(all.size()));
          all.push_back(static_cast<Eigen::Index>(s));
          follows_[s] = true;
        }
  };
  add(layout.bodies, modes);
  add(layout.hinges, hinges);
  Eigen::MatrixXd rows = J(Eigen::all, all);
  for (std::size_t k = 0; k < all.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) *= length_ / reaches_[static_cast<std::size_t>(all[k])];
  Eigen::MatrixXd motions = null_columns(rows);
  const auto take = [&](std::vector<Eigen::Index>& candidates, double share) {
    const std::size_t k = take_first(candidates, share, motions);
    if (k == candidates.size()) return false;
    const Eigen::Index speed = all[static_cast<std::size_t>(candidates[k])];
    follows_[static_cast<std::size_t>(speed)] = false;
    moving_.push_back(speed);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(k));
    return true;
  };
  for (Eigen::Index left = motions.cols(); left > 0; --left)
    if (!take(modes, share_of_modes) && !take(hinges, share_of_hinges) && !take(modes, 0)) break;
  for (std::size_t s = 0; s < follows_.size(); ++s)
    (follows_[s] ? followers_ : others_).push_back(static_cast<Eigen::Index>(s));
}

ClosedMotions::Seen ClosedMotions::see(std::span<const double> y) const {
  const auto equations = static_cast<Eigen::Index>(loops_.closing_equations());
  const auto speeds = static_cast<Eigen::Index>(model_.layout().speeds);
  Eigen::VectorXd gaps(equations), rates(equations);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(equations, speeds);
  const auto all = [](auto& m) { return std::span<double>(m.data(), static_cast<std::size_t>(m.size())); };
  Work work = equations_->make_work();
  loops_.see(y, all(gaps), all(rates), all(J), work);
  // Of what carries loops it is rounding.
  for (std::size_t s = 0; s < in_loops_.size(); ++s)
    if (!in_loops_[s]) J.col(static_cast<Eigen::Index>(s)).setZero();
  return {std::move(gaps), J};
}

ClosedMotions::At ClosedMotions::at(std::span<const double> y) const {
  At at{see(y).J, {}};
  const Eigen::Index n = at.J.cols();
  at.Z = Eigen::MatrixXd::Identity(n, n);
  if (followers_.empty()) return at;
  at.Z(Eigen::all, followers_).setZero();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(at.J(Eigen::all, followers_));
  if (!at.J.allFinite() || factors.rank() < static_cast<Eigen::Index>(followers_.size()))
    at.Z.setConstant(nan);
  else
    at.Z(followers_, others_) = -factors.solve(at.J(Eigen::all, others_));
  for (const Eigen::Index i : moving_)
    if (!(reach(at.Z.col(i)) <= turns_back * reaches_[static_cast<std::size_t>(i)])) at.Z.setConstant(nan);
  return at;
}

Eigen::VectorXd ClosedMotions::multipliers(const At& at, const Eigen::VectorXd& residual) const {
  if (!at.J.allFinite()) return Eigen::VectorXd::Constant(at.J.rows(), nan);
  if (followers_.empty()) return Eigen::VectorXd::Zero(at.J.rows());
  return transposed_inverse(at.J(Eigen::all, followers_)) * residual(followers_);
}

ClosedMotions::Changes ClosedMotions::changes(std::span<const double> y, const At& at,
                                              const Eigen::VectorXd& multipliers,
                                              const Eigen::VectorXd& accelerations) const {
  /// Turns [rad] of anything, and moves in lengths of the loop: eighth powers of it are below rounding.
  constexpr double far = 0.01;
  const Eigen::Index n = at.J.cols();
  Changes by{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  if (!at.Z.allFinite() || !multipliers.allFinite() || !accelerations.allFinite()) {
    by.efforts.setConstant(nan);
    return by;
  }
  if (followers_.empty()) return by;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(at.J(Eigen::all, followers_));
  for (const Eigen::Index i : others_) {
    if (!in_loops_[static_cast<std::size_t>(i)]) continue;
    const auto look = [&](double h) {
      std::vector<double> moved(y.begin(), y.end());
      const Eigen::VectorXd delta = h * at.Z.col(i);
      withy::displace(model_, moved, {delta.data(), static_cast<std::size_t>(n)});
      const Eigen::MatrixXd J = see(moved).J;
      Eigen::VectorXd both(n + J.rows());
      both << J.transpose() * multipliers, J * accelerations;
      return both;
    };
    const double step = far * length_ / reach(at.Z.col(i));
    const Eigen::VectorXd slope = central_difference(look, step);
    by.efforts.col(i) = slope.head(n);
    by.accelerations(followers_, i) = -factors.solve(slope.tail(at.J.rows()));
  }
  return by;
}

double ClosedMotions::reach(const Eigen::VectorXd& delta) const {
  double most = 0;
  for (std::size_t s = 0; s < in_loops_.size(); ++s)
    if (in_loops_[s]) most = std::max(most, reaches_[s] * std::abs(delta[static_cast<Eigen::Index>(s)]));
  return most;
}

bool ClosedMotions::close(std::span<double> y) const {
  constexpr int most = 12;
  const double rounding = 1e-15 * length_, near = near_by * length_;
  double before = std::numeric_limits<double>::infinity(), moved = 0;
  for (int i = 0; i < most && moved <= near; ++i) {
    const Seen now = see(y);
    const double left = now.gaps.cwiseAbs().maxCoeff();
    // Of redundant equations what is left is rounding already.
    if (left <= rounding || (left <= 1e5 * rounding && !(left < 0.5 * before))) return true;
    if (!std::isfinite(left)) return false;
    if (followers_.empty()) return left <= 1e6 * rounding;  // as far open as loops may begin
    before = left;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(now.J(Eigen::all, followers_));
    Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(follows_.size()));
    change(followers_) = -factors.solve(now.gaps);
    moved += reach(change);
    withy::displace(model_, y, {change.data(), follows_.size()});
  }
  return false;
}

void ClosedMotions::displace(std::span<double> y, const Eigen::VectorXd& delta) const {
  constexpr int most_parts = 100;
  Eigen::VectorXd left = delta;
  for (int part = 0; part < most_parts; ++part) {
    const Eigen::MatrixXd Z = at(y).Z;
    if (!Z.allFinite()) break;
    const Eigen::VectorXd all = Z * left;
    const double share = std::min(1.0, near_by * length_ / reach(all));
    const Eigen::VectorXd step = share * all;
    withy::displace(model_, y, {step.data(), follows_.size()});
    if (!close(y)) break;
    if (share == 1) return;
    left *= 1 - share;
  }
  std::fill(y.begin(), y.end(), nan);
}

Eigen::Index ClosedMotions::rank(Eigen::MatrixXd J) const {
  for (Eigen::Index i = 0; i < J.cols(); ++i) J.col(i) /= reaches_[static_cast<std::size_t>(i)];
  if (J.isZero(0)) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(J);
  factors.setThreshold(independent);
  return factors.rank();
}

bool ClosedMotions::singular(std::span<const double> y) const {
  constexpr double beside = 1e-3;  // in lengths, and [rad]
  const At here = at(y);
  if (!here.Z.allFinite()) return true;
  const Eigen::Index independent_here = rank(here.J);
  const auto other_beside = [&](const Eigen::VectorXd& delta) {
    const double far = reach(here.Z * delta);
    if (far == 0) return false;
    std::vector<double> moved(y.begin(), y.end());
    displace(moved, beside * length_ / far * delta);
    return std::isnan(moved[0]) || rank(see(moved).J) > independent_here;
  };
  const auto n = static_cast<Eigen::Index>(follows_.size());
  Eigen::VectorXd mixed = Eigen::VectorXd::Zero(n);
  for (const Eigen::Index i : moving_) {
    const Eigen::VectorXd one = Eigen::VectorXd::Unit(n, i);
    if (other_beside(one) || other_beside(-one)) return true;
    mixed += (1 + std::cos(static_cast<double>(i)) / 2) / reach(here.Z * one) * one;
  }
  return other_beside(mixed);
}

}  // namespace withy
