#include "withy/core/simulation/loop_following.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/elastic_modes.hpp"

namespace withy {
namespace {

/// Of the greatest: rows and columns of J below it are rounding.
constexpr double no_part_in_loops = 1e-9;

using RowMajorRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd see_rows(const ClosedLoops& loops, std::size_t speeds, std::span<const double> y, Work& work) {
  const std::size_t m = loops.closing_equations();
  std::vector<double> gaps(m), rates(m), J(m * speeds);
  loops.see(y, gaps, rates, J, work);
  return Eigen::Map<const RowMajorRows>(J.data(), static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(speeds));
}

/// Orthonormal columns z with C z = 0, where what is below `least` counts as zero.
Eigen::MatrixXd null_columns(const Eigen::MatrixXd& C, double least) {
  const Eigen::Index n = C.cols();
  if (C.rows() == 0 || n == 0 || !(C.cwiseAbs().maxCoeff() > least)) return Eigen::MatrixXd::Identity(n, n);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(C, Eigen::ComputeFullV);
  const Eigen::Index rank = (svd.singularValues().array() > least).count();
  return svd.matrixV().rightCols(n - rank);
}

}  // namespace

Eigen::MatrixXd closing_rows(const EquationsOfMotion& equations, std::span<const double> y) {
  const auto* loops = dynamic_cast<const ClosedLoops*>(&equations);
  const std::size_t speeds = equations.layout().speeds;
  if (loops == nullptr) return Eigen::MatrixXd(0, static_cast<Eigen::Index>(speeds));
  Work work = equations.make_work();
  return see_rows(*loops, speeds, y, work);
}

Eigen::MatrixXd closed_motions(const Eigen::MatrixXd& rows, const Eigen::VectorXd& inertia) {
  const Eigen::VectorXd scale =
      inertia.unaryExpr([](double m) { return m > 0 && std::isfinite(m) ? 1 / std::sqrt(m) : 1.0; });
  const Eigen::MatrixXd scaled = rows * scale.asDiagonal();
  const double size = scaled.size() > 0 ? scaled.cwiseAbs().maxCoeff() : 0;
  return scale.asDiagonal() * null_columns(scaled, no_part_in_loops * size);
}

LoopFollowing::LoopFollowing(const Model& model, const EquationsOfMotion& equations)
    : model_(model), equations_(equations), loops_(dynamic_cast<const ClosedLoops*>(&equations)), work_(0) {
  const Layout& layout = model.layout();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    if (const Slot* slot = layout.modes(b); slot != nullptr)
      for (std::size_t i = 0; i < slot->speeds; ++i) elastic_.push_back(static_cast<Eigen::Index>(slot->speed + i));
    if (model.driven(b)) continue;
    const Slot& slot = layout.hinges[b];
    for (std::size_t i = 0; i < slot.speeds; ++i) hinges_.push_back(static_cast<Eigen::Index>(slot.speed + i));
  }
  if (elastic_.empty()) loops_ = nullptr;
  if (loops_ == nullptr) return;
  seen_ = equations.make_observation();
  work_ = equations.make_work();
  y_.resize(equations.size());
  unit_.resize(layout.speeds);
  product_.resize(layout.speeds);
  bounds_.resize(model.bodies().size());
  frequencies_.resize(model.bodies().size());
}

/// M of some speeds, column by column.
Eigen::MatrixXd LoopFollowing::mass_of(const std::vector<Eigen::Index>& speeds) {
  const auto n = static_cast<Eigen::Index>(speeds.size());
  Eigen::MatrixXd M(n, n);
  std::fill(unit_.begin(), unit_.end(), 0.0);
  for (Eigen::Index j = 0; j < n; ++j) {
    double& one = unit_[static_cast<std::size_t>(speeds[static_cast<std::size_t>(j)])];
    one = 1;
    equations_.mass_times(y_, unit_, product_, work_);
    one = 0;
    M.col(j) = Eigen::Map<const Eigen::VectorXd>(product_.data(), static_cast<Eigen::Index>(product_.size()))(speeds);
  }
  return 0.5 * (M + M.transpose());
}

void LoopFollowing::find_followers() {
  const Eigen::MatrixXd of_modes = rows_(Eigen::all, elastic_);
  const double size = rows_.cwiseAbs().maxCoeff();
  following_.clear();
  for (const Eigen::Index i : hinges_)
    if (rows_.col(i).cwiseAbs().maxCoeff() > no_part_in_loops * size) following_.push_back(i);
  if (following_.empty()) {
    follow_.resize(0, of_modes.cols());
    bound_ = of_modes;
    return;
  }
  const Eigen::MatrixXd of_hinges = rows_(Eigen::all, following_), mass = mass_of(following_);
  const Eigen::LLT<Eigen::MatrixXd> factor(mass);
  // A truncated mass matrix need not be positive: then hinges count as if each had the same inertia.
  const bool sound = factor.info() == Eigen::Success && mass.allFinite();
  const Eigen::MatrixXd weighed =
      sound ? Eigen::MatrixXd(factor.matrixL().solve(of_hinges.transpose()).transpose()) : of_hinges;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(weighed, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > no_part_in_loops * values[0]).count();
  const Eigen::MatrixXd along = svd.matrixU().leftCols(rank).transpose() * of_modes;
  follow_ = -svd.matrixV().leftCols(rank) * (values.head(rank).cwiseInverse().asDiagonal() * along);
  if (sound) follow_ = factor.matrixU().solve(follow_).eval();
  bound_ = svd.matrixU().rightCols(of_hinges.rows() - rank).transpose() * of_modes;
  // What rounding leaves binds nothing.
  bound_ = (bound_.array().abs() > no_part_in_loops * size).select(bound_, 0.0).eval();
}

void LoopFollowing::find_turns() {
  const std::size_t speeds = model_.layout().speeds, first = model_.layout().positions;
  std::fill_n(y_.begin() + static_cast<std::ptrdiff_t>(first), speeds, 0.0);
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    const Slot* slot = model_.layout().modes(b);
    const auto n = static_cast<Eigen::Index>(slot != nullptr ? slot->speeds : 0);
    bounds_[b].turn.setZero(3, n);
  }
  for (std::size_t k = 0; k < following_.size(); ++k) {
    double& one = y_[first + static_cast<std::size_t>(following_[k])];
    one = 1;
    seen_->observe(y_);
    one = 0;
    Eigen::Index at = 0;
    for (std::size_t b = 0; b < bounds_.size(); ++b) {
      Matrix3X& turn = bounds_[b].turn;
      if (turn.cols() == 0) continue;
      const std::array<double, 3> w = seen_->frame_velocity(static_cast<int>(b), 0).angular;
      const std::array<double, 9> R = seen_->frame_pose(static_cast<int>(b), 0).rotation;
      const Vector3 in_body =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data()).transpose() * Vector3(w.data());
      turn += in_body * follow_.row(static_cast<Eigen::Index>(k)).segment(at, turn.cols());
      at += turn.cols();
    }
  }
  Eigen::Index at = 0;
  for (LoopBound& bound : bounds_) {
    bound.bound = bound_.middleCols(at, bound.turn.cols());
    at += bound.turn.cols();
  }
}

void LoopFollowing::update(std::span<const double> y) {
  if (loops_ == nullptr) return;
  y_.assign(y.begin(), y.end());
  rows_ = see_rows(*loops_, model_.layout().speeds, y_, work_);
  if (!rows_.allFinite()) return;
  find_followers();
  find_turns();
}

void LoopFollowing::find_frequencies() {
  if (loops_ == nullptr || !rows_.allFinite() || rows_.size() == 0) return;
  const bool known = std::any_of(frequencies_.begin(), frequencies_.end(), [](double f) { return f > 0; });
  if (known && model_.layout().speeds > largest_examined) return;
  std::vector<Eigen::Index> all = following_;
  all.insert(all.end(), elastic_.begin(), elastic_.end());
  const Eigen::MatrixXd M = mass_of(all);
  const Eigen::Index n = follow_.cols();
  Eigen::MatrixXd motions(follow_.rows() + n, n);
  motions << follow_, Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd free = null_columns(bound_, no_part_in_loops * rows_.cwiseAbs().maxCoeff());
  if (free.cols() == 0) return;
  const Eigen::MatrixXd moving = motions * free, mass = moving.transpose() * M * moving,
                        strain = stiffness_of_modes(model_)(elastic_, elastic_),
                        stiffness = free.transpose() * strain * free;
  if (!mass.allFinite() || Eigen::LLT<Eigen::MatrixXd>(stiffness).info() != Eigen::Success) return;
  // By 1/ω², so that a truncated mass matrix need not be positive.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, stiffness);
  if (solver.info() != Eigen::Success) return;
  constexpr double takes_part = 1e-6;
  Eigen::Index at = 0;
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    const Eigen::Index own = bounds_[b].turn.cols();
    for (Eigen::Index k = solver.eigenvalues().size(); own > 0 && k-- > 0 && solver.eigenvalues()[k] > 0;) {
      const Eigen::VectorXd q = (free * solver.eigenvectors().col(k)).segment(at, own);
      if (!(q.dot(strain.block(at, at, own, own) * q) > takes_part)) continue;
      frequencies_[b] = 1 / std::sqrt(solver.eigenvalues()[k]);
      break;
    }
    at += own;
  }
}

}  // namespace withy
