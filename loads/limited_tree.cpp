#include "withy/loads/limited_tree.hpp"

#include <Eigen/LU>

namespace withy {

LimitedTree::LimitedTree(const Model& model, std::vector<LimitedAxis> axes)
    : dynamics_(model),
      axes_(std::move(axes)),
      x_(model.reference_state().y),
      u_(model.layout().speeds),
      u_dot_(u_),
      tau_(u_),
      scratch_(dynamics_.scratch()) {
  x_.resize(model.layout().positions);
}

void LimitedTree::inverse(const Vector& state, int moving, double* efforts) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const LimitedAxis& axis = axes_[static_cast<std::size_t>(i)];
    x_[axis.position] = state[i];
    u_[axis.speed] = state[n + i];
    u_dot_[axis.speed] = i == moving ? 1 : 0;
  }
  dynamics_.efforts(x_, u_, u_dot_, tau_, scratch_);
  for (std::size_t i = 0; i < axes_.size(); ++i) efforts[i] = tau_[axes_[i].speed];
}

LimitedTree::Vector LimitedTree::derivative(const Vector& state, const double* efforts) const {
  const auto n = static_cast<Eigen::Index>(axes_.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2> M(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> bias(n), applied(n);
  inverse(state, -1, bias.data());
  for (Eigen::Index i = 0; i < n; ++i) {
    inverse(state, static_cast<int>(i), M.col(i).data());
    M.col(i) -= bias;
    applied[i] = efforts[i] - bias[i];
  }
  Vector rate(2 * n);
  rate << state.tail(n), M.partialPivLu().solve(applied);
  return rate;
}

std::vector<double> LimitedTree::holding(double LimitedAxis::*place) const {
  Vector rest = Vector::Zero(2 * static_cast<Eigen::Index>(axes_.size()));
  for (std::size_t i = 0; i < axes_.size(); ++i) rest[static_cast<Eigen::Index>(i)] = axes_[i].*place;
  std::vector<double> efforts(axes_.size());
  inverse(rest, -1, efforts.data());
  return efforts;
}

}  // namespace withy
