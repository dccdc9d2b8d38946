#include "withy/core/analysis/closed_pole.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "withy/core/analysis/adaptive_difference.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/loop_following.hpp"

namespace withy {
namespace {

/// What changes the fastest motion of modes by more than this factor is no mode's own.
constexpr double beyond_modes = 1.1;
/// Greatest change of a coordinate [rad, m] or of a speed over the speeds there, from which differences begin.
constexpr double first_change = 1e-3;

/// States about one, loops closed, in coordinates (ξ, η, ζ): displacements N Z ξ, speeds Z η, states of loads ζ, with
/// the columns of Z the free motions, Zᵀ M Z = 1.
class StatesAbout {
 public:
  StatesAbout(const Model& model, const EquationsOfMotion& equations, const State& state, const Held& resting)
      : equations_(equations),
        loops_(dynamic_cast<const ClosedLoops&>(equations)),
        layout_(model.layout()),
        state_(state),
        work_(equations.make_work()),
        slope_(equations.size()) {
    const Held held = driven_speeds(model, state);
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!held[i] && (resting.empty() || !resting[i])) free_.push_back(static_cast<Eigen::Index>(i));
    find_motions();
    find_rates();
  }
  [[nodiscard]] Eigen::Index motions() const { return Z_.cols(); }
  [[nodiscard]] Eigen::Index size() const { return 2 * motions() + static_cast<Eigen::Index>(layout_.continuous); }
  /// Share of each speed in a motion, Σ over speeds of z M_ii z.
  [[nodiscard]] std::vector<double> shares(const Eigen::VectorXcd& xi) const {
    std::vector<double> all(layout_.speeds);
    const Eigen::VectorXd moved = (Z_.cast<std::complex<double>>() * xi).cwiseAbs2().cwiseProduct(masses_);
    for (Eigen::Index i = 0; i < moved.size(); ++i)
      all[static_cast<std::size_t>(free_[static_cast<std::size_t>(i)])] = moved[i];
    return all;
  }
  /// The slope of the coordinates where one of them is `by`.
  Eigen::VectorXd slope(Eigen::Index coordinate, double by);
  /// Of a coordinate.
  [[nodiscard]] double first_step(Eigen::Index coordinate) const {
    if (coordinate >= 2 * motions()) {
      const auto k = static_cast<std::size_t>(coordinate - 2 * motions());
      return first_change * (1 + std::abs(state_.y[layout_.positions + layout_.speeds + k]));
    }
    const bool of_speeds = coordinate >= motions();
    double fastest = 0;
    for (std::size_t i = 0; of_speeds && i < layout_.speeds; ++i)
      fastest = std::max(fastest, std::abs(state_.y[layout_.positions + i]));
    return first_change * (1 + fastest) / Z_.col(coordinate % motions()).cwiseAbs().maxCoeff();
  }

 private:
  void find_motions() {
    const auto n = static_cast<Eigen::Index>(layout_.speeds);
    const DenseSystem system = equations_.system(state_.time, state_.y);
    const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(system.mass.data(), n, n)(free_, free_);
    const Eigen::MatrixXd rows = closing_rows(equations_, state_.y)(Eigen::all, free_);
    masses_ = M.diagonal();
    const Eigen::MatrixXd any = closed_motions(rows, masses_);
    const Eigen::LLT<Eigen::MatrixXd> factor(any.transpose() * M * any);
    if (!M.allFinite() || !rows.allFinite() || factor.info() != Eigen::Success)
      throw std::domain_error("the mass matrix of the closed loops is not positive");
    Z_ = factor.matrixL().solve(any.transpose()).transpose();
    to_motions_ = Z_.transpose() * M;
  }
  /// ẋ = N u, and u of ẋ: what hinges turn by is more than one number where they have quaternions.
  void find_rates() {
    N_.resize(static_cast<Eigen::Index>(layout_.positions), static_cast<Eigen::Index>(free_.size()));
    std::vector<double> y = state_.y;
    for (Eigen::Index j = 0; j < N_.cols(); ++j) {
      std::fill_n(y.begin() + static_cast<std::ptrdiff_t>(layout_.positions), layout_.speeds, 0.0);
      y[layout_.positions + static_cast<std::size_t>(free_[static_cast<std::size_t>(j)])] = 1;
      if (!equations_.position_rates(state_.time, y, slope_, work_).ok()) throw std::domain_error("no rates there");
      N_.col(j) = Eigen::Map<const Eigen::VectorXd>(slope_.data(), N_.rows());
    }
    to_speeds_ = N_.completeOrthogonalDecomposition().pseudoInverse();
  }

  const EquationsOfMotion& equations_;
  const ClosedLoops& loops_;
  const Layout& layout_;
  const State& state_;
  Work work_;
  std::vector<double> slope_;
  std::vector<Eigen::Index> free_;
  Eigen::MatrixXd Z_, N_, to_motions_, to_speeds_;  ///< of the free speeds
  Eigen::VectorXd masses_;
};

Eigen::VectorXd StatesAbout::slope(Eigen::Index coordinate, double by) {
  const Eigen::Index d = motions();
  const auto positions = static_cast<Eigen::Index>(layout_.positions);
  std::vector<double> y = state_.y;
  Eigen::Map<Eigen::VectorXd> x(y.data(), positions);
  const auto speeds = [&](std::vector<double>& of) {
    return Eigen::Map<Eigen::VectorXd>(of.data() + positions, static_cast<Eigen::Index>(layout_.speeds));
  };
  if (coordinate < d) {
    x += by * (N_ * Z_.col(coordinate));
  } else if (coordinate < 2 * d) {
    speeds(y)(free_) += by * Z_.col(coordinate - d);
  } else {
    y[layout_.positions + layout_.speeds + static_cast<std::size_t>(coordinate - 2 * d)] += by;
  }
  Eigen::VectorXd slope(size());
  if (!loops_.close(y, work_).closed || !equations_.derivatives(state_.time, y, slope_, work_).ok())
    return slope.setConstant(std::numeric_limits<double>::quiet_NaN());
  slope.head(d) = to_motions_ * (to_speeds_ * Eigen::Map<const Eigen::VectorXd>(slope_.data(), positions));
  slope.segment(d, d) = to_motions_ * speeds(slope_)(free_);
  for (Eigen::Index k = 2 * d; k < size(); ++k)
    slope[k] = slope_[layout_.positions + layout_.speeds + static_cast<std::size_t>(k - 2 * d)];
  return slope;
}

}  // namespace

FastestPole fastest_pole_of_loops(const Model& model, const EquationsOfMotion& equations, const State& state,
                                  const Held& resting) {
  FastestPole result;
  StatesAbout about(model, equations, state, resting);
  if (about.motions() == 0) return result;
  Eigen::MatrixXd A(about.size(), about.size());
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    A.col(j) = adaptive_difference([&](double by) { return about.slope(j, by); }, about.first_step(j)).slope;
  if (!A.allFinite()) throw std::domain_error("the motions about the state are not finite");
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  Eigen::Index fastest = 0;
  solver.eigenvalues().cwiseAbs().maxCoeff(&fastest);
  result.value = solver.eigenvalues()[fastest];
  if (result.value.imag() < 0) result.value = std::conj(result.value);
  const std::vector<double> shares = about.shares(solver.eigenvectors().col(fastest).head(about.motions()));
  const auto most = std::max_element(shares.begin(), shares.end());
  double whole = 0;
  for (const double share : shares) whole += share;
  result.speed = static_cast<std::size_t>(most - shares.begin());
  result.share = whole > 0 ? *most / whole : 0;
  const double of_modes = fastest_mode(model, equations.system(state.time, state.y), closing_rows(equations, state.y));
  result.of_load = model.layout().continuous > 0 || std::abs(result.value) > beyond_modes * of_modes;
  return result;
}

}  // namespace withy
