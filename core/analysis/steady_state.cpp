#include "withy/core/analysis/steady_state.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

namespace withy {
namespace {

constexpr int most_iterations = 100;
/// A step this small against the coordinates and what they have moved is rounding.
constexpr double converged_step = 1e-11;
/// Below this share of the largest singular value the stiffness counts as singular.
constexpr double singular_share = 1e-12;

using Solver = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

class Newton {
 public:
  Newton(const TangentDynamics& dynamics, const State& start, const Held& held)
      : dynamics_(dynamics), free_(free_speeds(held)), n_(static_cast<Eigen::Index>(held.size())) {
    state_ = start;
    const Layout& layout = dynamics.model().layout();
    for (const Slot& slot : layout.bodies) {
      for (std::size_t i = 0; i < slot.speeds; ++i) state_.y[layout.positions + slot.speed + i] = 0;
    }
    rest_ = dynamics.steady_accelerations(start.time);
    set_scale();
  }

  SteadyState solve() {
    SteadyState result;
    double moved = 0;
    for (; result.iterations < most_iterations; ++result.iterations) {
      const Stiffness t = dynamics_.stiffness(state_.time, state_.y, rest_);
      result.efforts = t.residual;
      result.step = rest_ * 0;
      // Nothing is free to move.
      if (free_.empty()) {
        result.converged = t.residual.allFinite();
        break;
      }
      if (!factorize(t)) break;
      const Eigen::VectorXd step = solve_for(t.residual);
      result.step = spread(step);
      if (!step.allFinite()) break;
      if (step.size() == 0 || greatest(step) <= converged_step * (moved + size())) {
        // The least-squares step may be zero where the residual is not: nothing can balance it.
        result.converged = balanced(t);
        break;
      }
      const double length = advance(step);
      if (length == 0) break;
      moved += length * greatest(step);
    }
    result.state = state_;
    if (singular_) result.neutral = neutral_;
    return result;
  }

 private:
  /// Coordinates are scaled by √M_ii at the start, so that angles and modes are measured alike.
  void set_scale() {
    const Eigen::VectorXd mass = dynamics_.mass_diagonal(state_.time, state_.y);
    scale_ = mass(free_).cwiseAbs().cwiseSqrt();
    for (double& s : scale_) s = s > 0 ? 1 / s : 1.0;
  }
  bool factorize(const Stiffness& t) {
    const auto m = static_cast<Eigen::Index>(free_.size());
    const Eigen::MatrixXd K = scale_.asDiagonal() * t.by_position(free_, free_) * scale_.asDiagonal();
    if (!K.allFinite()) return false;
    solver_.setThreshold(singular_share);
    solver_.compute(K);
    singular_ = m > 0 && solver_.rank() < m;
    if (singular_) {
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(K, Eigen::ComputeFullV);
      neutral_ = spread(scale_.cwiseProduct(svd.matrixV().col(m - 1))).normalized();
    }
    matrix_ = K;
    return true;
  }
  [[nodiscard]] Eigen::VectorXd solve_for(const Eigen::VectorXd& residual) const {
    const Eigen::VectorXd scaled = scale_.cwiseProduct(residual(free_)), least = solver_.solve(scaled);
    return -scale_.cwiseProduct(least);
  }
  /// Whether what is left over is rounding of the terms in it.
  [[nodiscard]] bool balanced(const Stiffness& t) const {
    if (free_.empty()) return true;
    const Eigen::VectorXd left = scale_.cwiseProduct(t.residual(free_));
    if (!singular_) return left.allFinite();
    const double stiffness = matrix_.cwiseAbs().maxCoeff();
    return left.cwiseAbs().maxCoeff() <= 1e-9 * std::max(stiffness, t.residual.cwiseAbs().maxCoeff());
  }
  /// The part of the step that is taken: 0 where none makes the next one smaller.
  double advance(const Eigen::VectorXd& step) {
    const double size = step.cwiseQuotient(scale_).norm();
    for (double part = 1; part > 1e-8; part *= 0.5) {
      State trial = state_;
      dynamics_.displace(trial.y, spread(part * step));
      const Eigen::VectorXd next = solve_for(dynamics_.residual(trial.time, trial.y, rest_));
      const double next_size = next.cwiseQuotient(scale_).norm();
      // At rounding a full step cannot improve any more; the test of convergence follows.
      if (next_size <= (1 - 0.25 * part) * size || (part == 1 && greatest(step) < 1e-9 * this->size())) {
        state_ = std::move(trial);
        return part;
      }
    }
    return 0;
  }
  [[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& of_free) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(n_);
    all(free_) = of_free;
    return all;
  }
  static double greatest(const Eigen::VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }
  /// Of the coordinates; not less than what no drawing shows.
  [[nodiscard]] double size() const {
    const Layout& layout = dynamics_.model().layout();
    double s = 1e-6;
    for (std::size_t i = 0; i < layout.positions; ++i) s = std::max(s, std::abs(state_.y[i]));
    return s;
  }

  const TangentDynamics& dynamics_;
  std::vector<Eigen::Index> free_;
  Eigen::Index n_;
  State state_;
  Eigen::VectorXd rest_, scale_, neutral_;
  Eigen::MatrixXd matrix_;
  Solver solver_;
  bool singular_ = false;
};

}  // namespace

std::vector<Eigen::Index> free_speeds(const Held& held) {
  std::vector<Eigen::Index> indices;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (!held[i]) indices.push_back(static_cast<Eigen::Index>(i));
  }
  return indices;
}

Eigen::VectorXd accelerations(const TangentDynamics& dynamics, const State& state, const Held& held) {
  Eigen::VectorXd a = dynamics.steady_accelerations(state.time);
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return a;
  const Tangents t = dynamics.tangents(state.time, state.y, a);
  const Eigen::MatrixXd M = t.mass(free, free);
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(M);
  if (!lu.isInvertible()) throw std::domain_error("the mass matrix is singular at this state");
  a(free) = -lu.solve(t.residual(free));
  return a;
}

SteadyState find_steady_state(const TangentDynamics& dynamics, const State& start, const Held& held) {
  return Newton(dynamics, start, held).solve();
}

bool stays_steady(const TangentDynamics& dynamics, const Tangents& tangents, const State& state, const Held& held) {
  const auto n = static_cast<Eigen::Index>(held.size());
  const auto free = free_speeds(held);
  if (free.empty()) return true;
  const Eigen::Map<const Eigen::VectorXd> u(state.y.data() + dynamics.model().layout().positions, n);
  const Eigen::VectorXd change = tangents.by_position * u;
  const double terms = (tangents.by_position.cwiseAbs() * u.cwiseAbs()).maxCoeff() +
                       tangents.by_position.cwiseAbs().maxCoeff() * u.cwiseAbs().maxCoeff();
  return change(free).cwiseAbs().maxCoeff() <= 1e-9 * terms;
}

}  // namespace withy
