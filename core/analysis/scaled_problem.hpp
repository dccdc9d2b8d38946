/// \file
/// The linear problem of a step to a steady state, and the units it is solved in.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

/// Units of displacements in which inertias are one; one where there is none. \param mass M_ii
inline Eigen::VectorXd unit_inertias(Eigen::VectorXd mass) {
  for (double& m : mass) m = m > 0 ? 1 / std::sqrt(m) : 1.0;
  return mass;
}

/// What balances at a steady state: forces on the free speeds, and rates of the continuous states of loads.
struct Imbalance {
  Eigen::VectorXd forces;  ///< the residual, one a speed
  Eigen::VectorXd rates;
};

/// A change of the free coordinates, spread over all speeds, and of those states.
struct Change {
  Eigen::VectorXd moved, states;
  [[nodiscard]] bool finite() const { return moved.allFinite() && states.allFinite(); }
};

/// Units in which what is free and the states of loads are measured alike, and the linear problem in them.
class ScaledProblem {
 public:
  /// \param mass M_ii of the free speeds
  explicit ScaledProblem(const Eigen::VectorXd& mass) : of_free_(unit_inertias(mass.cwiseAbs())) {}

  /// K of the free coordinates with what states do to them and they to rates. A state's unit is what forces as much as
  /// the stiffest coordinate does; a rate's row is as large as that.
  Eigen::MatrixXd matrix(const Stiffness& t, const std::vector<Eigen::Index>& free) {
    const Eigen::Index m = of_free_.size(), k = t.by_state.cols();
    const auto scale = of_free_.asDiagonal();
    Eigen::MatrixXd J(m + k, m + k);
    J.topLeftCorner(m, m) = scale * t.by_position(free, free) * scale;
    of_states_.setOnes(k), of_rates_.setOnes(k);
    if (k == 0) return J;
    J.topRightCorner(m, k) = scale * t.by_state(free, Eigen::all);
    J.bottomLeftCorner(k, m) = t.rate_by_position(Eigen::all, free) * scale;
    J.bottomRightCorner(k, k) = t.rate_by_state;
    const double stiffest = m > 0 ? J.topLeftCorner(m, m).cwiseAbs().maxCoeff() : 0.0;
    const double like = stiffest > 0 ? stiffest : 1.0;
    for (Eigen::Index j = 0; j < k; ++j) {
      const double force = m > 0 ? J.col(m + j).head(m).cwiseAbs().maxCoeff() : 0.0;
      const double felt = force > 0 ? force : J.col(m + j).tail(k).cwiseAbs().maxCoeff();
      if (felt > 0) of_states_[j] = like / felt;
    }
    J.rightCols(k) *= of_states_.asDiagonal();
    for (Eigen::Index i = 0; i < k; ++i)
      if (const double size = J.row(m + i).cwiseAbs().maxCoeff(); size > 0) of_rates_[i] = like / size;
    J.bottomRows(k) = of_rates_.asDiagonal() * J.bottomRows(k);
    return J;
  }

  /// What the diagonal of K is known against, in these units.
  [[nodiscard]] Eigen::VectorXd floor(const Eigen::VectorXd& in_play, const std::vector<Eigen::Index>& free) const {
    return of_free_.cwiseAbs2().cwiseProduct(in_play(free));
  }
  [[nodiscard]] Eigen::VectorXd right(const Imbalance& left, const std::vector<Eigen::Index>& free) const {
    Eigen::VectorXd all(of_free_.size() + of_rates_.size());
    all << of_free_.cwiseProduct(left.forces(free)), of_rates_.cwiseProduct(left.rates);
    return all;
  }
  [[nodiscard]] Change change(const Eigen::VectorXd& scaled, const std::vector<Eigen::Index>& free,
                              Eigen::Index speeds) const {
    Change c{Eigen::VectorXd::Zero(speeds), of_states_.cwiseProduct(scaled.tail(of_states_.size()))};
    c.moved(free) = of_free_.cwiseProduct(scaled.head(of_free_.size()));
    return c;
  }
  [[nodiscard]] double norm(const Change& c, const std::vector<Eigen::Index>& free) const {
    Eigen::VectorXd all(of_free_.size() + of_states_.size());
    all << c.moved(free).cwiseQuotient(of_free_), c.states.cwiseQuotient(of_states_);
    return all.norm();
  }
  /// Displacements of that size and states of these, not less than what forces as much.
  [[nodiscard]] Eigen::VectorXd sizes(double displacement, const Eigen::VectorXd& states) const {
    Eigen::VectorXd all(of_free_.size() + of_states_.size());
    all << displacement * of_free_.cwiseInverse(), (states + states_like(displacement)).cwiseQuotient(of_states_);
    return all;
  }
  /// What forces as much as a displacement of that size.
  [[nodiscard]] Eigen::VectorXd states_like(double displacement) const {
    return of_states_ * (displacement / (of_free_.size() > 0 ? of_free_.minCoeff() : 1.0));
  }

 private:
  Eigen::VectorXd of_free_, of_states_, of_rates_;
};

}  // namespace withy
