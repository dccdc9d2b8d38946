#include "withy/core/analysis/loop_motions.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/core/analysis/adaptive_difference.hpp"

namespace withy {
namespace {

/// The one decomposition of this file, since each takes seconds to compile.
using Decomposition = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Share of the largest pivot below which a closing equation depends on others.
constexpr double dependent_share = 1e-9;

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& right) {
  Decomposition solver;
  solver.setThreshold(dependent_share);
  solver.compute(A);
  return solver.solve(right);
}

}  // namespace

LoopMotions::LoopMotions(const EquationsOfMotion& equations, const TangentDynamics& dynamics, Held held)
    : equations_(equations),
      loops_(dynamic_cast<const ClosedLoops&>(equations)),
      dynamics_(dynamics),
      held_(std::move(held)),
      free_(free_speeds(held_)),
      work_(equations.make_work()) {}

LoopMotions::Seen LoopMotions::see(const State& state) const {
  const auto rows = static_cast<Eigen::Index>(loops_.closing_equations());
  const auto n = static_cast<Eigen::Index>(held_.size());
  Seen seen{Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, n)};
  Eigen::VectorXd rates(rows);
  Rows J = Rows::Zero(rows, n);
  const auto count = static_cast<std::size_t>(rows);
  loops_.see(state.y, {seen.gaps.data(), count}, {rates.data(), count}, {J.data(), static_cast<std::size_t>(J.size())},
             work_);
  for (const Eigen::Index i : free_) seen.J.col(i) = J.col(i);
  return seen;
}

LoopChart LoopMotions::chart(const State& state, const std::vector<Eigen::Index>& independent) const {
  const Seen seen = see(state);
  LoopChart chart{independent, {}, Held(held_.size(), true)};
  if (independent.empty()) {
    const Eigen::VectorXd masses = dynamics_.mass_diagonal(state.time, state.y).cwiseAbs();
    Eigen::MatrixXd scaled = seen.J(Eigen::all, free_);
    for (Eigen::Index k = 0; k < scaled.cols(); ++k)
      scaled.col(k) /= std::sqrt(std::max(masses[free_[static_cast<std::size_t>(k)]], 1e-300));
    Decomposition pivots;
    pivots.setThreshold(dependent_share);
    pivots.compute(scaled);
    for (Eigen::Index k = pivots.rank(); k < scaled.cols(); ++k)
      chart.independent.push_back(free_[static_cast<std::size_t>(pivots.colsPermutation().indices()[k])]);
    std::sort(chart.independent.begin(), chart.independent.end());
  }
  std::vector<Eigen::Index> dependent;
  std::set_difference(free_.begin(), free_.end(), chart.independent.begin(), chart.independent.end(),
                      std::back_inserter(dependent));
  const auto m = static_cast<Eigen::Index>(chart.independent.size());
  chart.T = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(held_.size()), m);
  for (Eigen::Index k = 0; k < m; ++k) {
    chart.held[static_cast<std::size_t>(chart.independent[static_cast<std::size_t>(k)])] = false;
    chart.T(chart.independent[static_cast<std::size_t>(k)], k) = 1;
  }
  if (m > 0 && !dependent.empty())
    chart.T(dependent, Eigen::all) =
        -least_squares(seen.J(Eigen::all, dependent), seen.J(Eigen::all, chart.independent));
  return chart;
}

Eigen::VectorXd LoopMotions::accelerations(const State& state) const {
  const LoopChart free = chart(state);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held_.size()));
  if (free.independent.empty()) return none;
  const Tangents tree = dynamics_.tangents(state.time, state.y, none);
  const Eigen::MatrixXd M = free.T.transpose() * tree.mass * free.T;
  const Decomposition solver(M);
  if (solver.rank() < M.rows()) throw std::domain_error("the mass matrix is singular at this state");
  const Eigen::VectorXd force = free.T.transpose() * tree.residual;
  return -free.T * solver.solve(force);
}

/// Of all that are alike, the smallest.
Eigen::VectorXd LoopMotions::multipliers(const Eigen::MatrixXd& J, const Eigen::VectorXd& residual) const {
  return least_squares(J(Eigen::all, free_).transpose(), residual(free_));
}

/// Over which nothing changes much: 0.01 rad or m of what moves most.
double LoopMotions::step(const LoopChart& chart, Eigen::Index i) const {
  return 1e-2 / std::max(1.0, chart.T.col(i).cwiseAbs().maxCoeff());
}

State LoopMotions::moved(const State& state, const Eigen::VectorXd& displacement) const {
  State there = state;
  dynamics_.displace(there.y, displacement);
  return there;
}

Eigen::MatrixXd LoopMotions::curvature(const State& state, const LoopChart& chart,
                                       const Eigen::VectorXd& lambda) const {
  const Eigen::Index m = chart.T.cols();
  Eigen::MatrixXd of(m, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto exerted = [&](double h) -> Eigen::VectorXd {
      return chart.T.transpose() * (see(moved(state, h * chart.T.col(i))).J.transpose() * lambda);
    };
    of.col(i) = adaptive_difference(exerted, step(chart, i)).slope;
  }
  return of;
}

Tangents LoopMotions::reduced(const Tangents& tree, const State& state, const Eigen::VectorXd& accelerations,
                              const LoopChart& chart) const {
  const Eigen::MatrixXd& T = chart.T;
  const std::vector<Eigen::Index>& I = chart.independent;
  const Eigen::Index n = tree.mass.rows(), z = tree.by_state.cols();
  Eigen::MatrixXd stiffness =
      T.transpose() * tree.by_position * T - curvature(state, chart, multipliers(see(state).J, tree.residual));
  Eigen::MatrixXd by_turning = Eigen::MatrixXd::Zero(n, T.cols());  // (∂T/∂x · T) u̇_I
  const Eigen::VectorXd a = accelerations(I);
  if (!a.isZero(0)) {
    for (Eigen::Index i = 0; i < T.cols(); ++i) {
      const auto turned = [&](double h) -> Eigen::VectorXd { return this->chart(moved(state, h * T.col(i)), I).T * a; };
      by_turning.col(i) = adaptive_difference(turned, step(chart, i)).slope;
    }
    stiffness += T.transpose() * tree.mass * by_turning;
  }
  const auto spread = [&](const Eigen::MatrixXd& m) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    all(I, I) = m;
    return all;
  };
  Tangents r = tree;
  r.residual = Eigen::VectorXd::Zero(n);
  r.residual(I) = T.transpose() * tree.residual;
  r.mass = spread(T.transpose() * tree.mass * T);
  r.by_speed = spread(T.transpose() * tree.by_speed * T);
  r.by_position = spread(stiffness);
  r.drift = Eigen::MatrixXd::Zero(n, n);
  r.by_state = Eigen::MatrixXd::Zero(n, z);
  r.by_state(I, Eigen::all) = T.transpose() * tree.by_state;
  for (Eigen::MatrixXd Tangents::*part :
       {&Tangents::rate_by_position, &Tangents::rate_by_speed, &Tangents::rate_by_acceleration}) {
    if ((tree.*part).size() == 0) continue;
    (r.*part).setZero();
    (r.*part)(Eigen::all, I) = tree.*part * T;
  }
  if (tree.rate_by_acceleration.size() > 0) r.rate_by_position(Eigen::all, I) += tree.rate_by_acceleration * by_turning;
  return r;
}

bool LoopMotions::close(State& state) const {
  constexpr int most = 50;
  constexpr double closed_gap = 1e-10, finest_gap = 1e-15;  // [m]
  Seen seen = see(state);
  double gap = seen.gaps.cwiseAbs().maxCoeff();
  for (int i = 0; i < most && gap > finest_gap; ++i) {
    const Eigen::VectorXd root =
        dynamics_.mass_diagonal(state.time, state.y).cwiseAbs().cwiseMax(1e-300).cwiseSqrt()(free_);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held_.size()));
    const Eigen::MatrixXd scaled = seen.J(Eigen::all, free_) * root.cwiseInverse().asDiagonal();
    change(free_) = least_squares(scaled, -seen.gaps).col(0).cwiseQuotient(root);
    if (!change.allFinite()) return false;
    State next = moved(state, change);
    Seen there = see(next);
    const double left = there.gaps.cwiseAbs().maxCoeff();
    if (!(left < gap)) break;
    state = std::move(next), seen = std::move(there), gap = left;
  }
  return gap <= closed_gap;
}

/// The reduced stiffness at a state, in units in which inertias are alike.
class LoopMotions::Balance {
 public:
  Balance(const LoopMotions& motions, const State& state)
      : tree_(motions.dynamics_.stiffness(state.time, state.y, Eigen::VectorXd::Zero(motions.size()))),
        chart_(motions.chart(state)) {
    const Eigen::MatrixXd J = motions.see(state).J;
    const Eigen::VectorXd lambda = motions.multipliers(J, tree_.residual);
    efforts_ = tree_.residual - J.transpose() * lambda;
    const Eigen::VectorXd masses = motions.dynamics_.mass_diagonal(state.time, state.y).cwiseAbs();
    const Eigen::MatrixXd& T = chart_.T;
    units_ = (T.cwiseAbs2().transpose() * masses).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    K_ = units_.asDiagonal() * (T.transpose() * tree_.by_position * T - motions.curvature(state, chart_, lambda)) *
         units_.asDiagonal();
    constexpr double singular_share = 1e-12;
    solver_.setThreshold(singular_share);
    if (K_.size() > 0 && K_.allFinite()) solver_.compute(K_);
  }

  [[nodiscard]] const LoopChart& chart() const { return chart_; }
  /// What held speeds need, what is left over on others.
  [[nodiscard]] const Eigen::VectorXd& efforts() const { return efforts_; }
  [[nodiscard]] bool finite() const { return K_.allFinite() && efforts_.allFinite(); }
  [[nodiscard]] bool singular() const { return K_.size() > 0 && solver_.rank() < K_.rows(); }
  [[nodiscard]] Eigen::VectorXd step() const { return step_for(chart_.T, tree_.residual); }
  /// The simplified Newton step elsewhere: the residual there, the stiffness here.
  [[nodiscard]] Eigen::VectorXd step_for(const Eigen::MatrixXd& T, const Eigen::VectorXd& residual) const {
    return -units_.cwiseProduct(solver_.solve(units_.cwiseProduct(T.transpose() * residual)));
  }
  [[nodiscard]] double length(const Eigen::VectorXd& step) const { return step.cwiseQuotient(units_).norm(); }
  [[nodiscard]] Eigen::VectorXd neutral() const {
    const Eigen::VectorXd null = solver_.colsPermutation() * solver_.matrixZ().bottomRows(1).transpose();
    return (chart_.T * units_.cwiseProduct(null)).normalized();
  }
  /// Whether what is left over is rounding: a least-squares step may be zero where nothing can balance the residual.
  [[nodiscard]] bool balanced() const {
    if (!singular()) return true;
    const Eigen::VectorXd left = units_.cwiseProduct(chart_.T.transpose() * tree_.residual);
    return left.cwiseAbs().maxCoeff() <=
           1e-9 * std::max(K_.cwiseAbs().maxCoeff(), tree_.residual.cwiseAbs().maxCoeff());
  }

 private:
  Stiffness tree_;
  LoopChart chart_;
  Eigen::VectorXd efforts_, units_;
  Eigen::MatrixXd K_;
  Decomposition solver_;
};

/// Takes the part of a step after which the next one is smaller. \returns that part; 0 where there is none
double LoopMotions::advance(const Balance& balance, const Eigen::VectorXd& step, State& state) const {
  const Eigen::VectorXd displacement = balance.chart().T * step;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(size());
  constexpr double rounding = 1e-9;  // a step this short cannot get any shorter
  for (double part = 1; part > 1e-8; part *= 0.5) {
    State trial = moved(state, part * displacement);
    if (!close(trial)) continue;
    const Eigen::VectorXd next =
        balance.step_for(chart(trial, balance.chart().independent).T, dynamics_.residual(trial.time, trial.y, none));
    const bool shorter = balance.length(next) <= (1 - 0.25 * part) * balance.length(step);
    if (!shorter && !(part == 1 && displacement.cwiseAbs().maxCoeff() < rounding)) continue;
    state = std::move(trial);
    return part;
  }
  return 0;
}

SteadyState LoopMotions::rest(const State& start) const {
  constexpr int most_iterations = 100;
  constexpr double converged_step = 1e-11, least_size = 1e-6;
  SteadyState result;
  result.state = start;
  result.step = result.efforts = Eigen::VectorXd::Zero(size());
  double travelled = 0;
  for (bool closed = close(result.state); closed && result.iterations < most_iterations; ++result.iterations) {
    const Balance balance(*this, result.state);
    result.efforts = balance.efforts();
    if (!balance.finite()) break;
    if (balance.chart().independent.empty()) {
      result.converged = true;
      break;
    }
    result.neutral = balance.singular() ? balance.neutral() : Eigen::VectorXd();
    const Eigen::VectorXd step = balance.step();
    result.step = balance.chart().T * step;
    if (!step.allFinite()) break;
    const double longest = result.step.cwiseAbs().maxCoeff();
    double coordinates = least_size;
    for (std::size_t i = 0; i < dynamics_.model().layout().positions; ++i)
      coordinates = std::max(coordinates, std::abs(result.state.y[i]));
    if (longest <= converged_step * (travelled + coordinates)) {
      result.converged = balance.balanced();
      break;
    }
    const double part = advance(balance, step, result.state);
    if (part == 0) break;
    travelled += part * longest;
  }
  return result;
}

}  // namespace withy
