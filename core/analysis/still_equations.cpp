#include "withy/core/analysis/still_equations.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "withy/core/analysis/scaled_problem.hpp"
#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

/// What derivatives are known to at the worst, of the greatest beside them.
constexpr double known_share = 1e-11;

/// Takes away what is rounding of the greatest in its row: what a load measures of one coordinate beside others.
template <class Block>
void clear_rounding(Block&& rows) {
  for (Eigen::Index i = 0; i < rows.rows() && rows.cols() > 0; ++i) {
    const double least = known_share * rows.row(i).cwiseAbs().maxCoeff();
    for (Eigen::Index j = 0; j < rows.cols(); ++j)
      if (std::abs(rows(i, j)) <= least) rows(i, j) = 0;
  }
}

}  // namespace

Eigen::MatrixXd unheld_motions(const Tangents& t, const Held& held, const HeldNumbers& numbers) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  const auto m = static_cast<Eigen::Index>(free.size());
  const Eigen::Index k = t.by_state.cols(), d = numbers.renewed.rows(), all = m + k + d;
  const Eigen::VectorXd scale = unit_inertias(t.mass.diagonal()(free).cwiseAbs());
  // A displacement stays where its rate makes up for what the turning of its coordinates does to it.
  const Eigen::MatrixXd C = t.drift(free, free);
  Eigen::MatrixXd still = Eigen::MatrixXd::Zero(all, all);
  still.topLeftCorner(m, m) =
      scale.asDiagonal() * (t.by_position(free, free) - t.by_speed(free, free) * C) * scale.asDiagonal();
  if (k > 0) {
    still.block(0, m, m, k) = scale.asDiagonal() * t.by_state(free, Eigen::all);
    still.block(m, 0, k, m) =
        (t.rate_by_position(Eigen::all, free) - t.rate_by_speed(Eigen::all, free) * C) * scale.asDiagonal();
    still.block(m, m, k, k) = t.rate_by_state;
  }
  if (d > 0) {
    still.topRightCorner(m, d) = -(scale.asDiagonal() * numbers.efforts(free, Eigen::all));
    still.block(m, m + k, k, d) = numbers.rates;
    still.bottomLeftCorner(d, m) =
        (numbers.renewed.leftCols(m) - numbers.renewed.middleCols(m, m) * C) * scale.asDiagonal();
    still.bottomRightCorner(d, k + d) = numbers.renewed.rightCols(k + d);
    still.bottomRightCorner(d, d).diagonal().array() -= 1;
  }
  if (!still.allFinite()) throw std::domain_error("the derivatives at this state are not finite");
  clear_rounding(still.bottomLeftCorner(k + d, m));
  clear_rounding(still.topRightCorner(m, k + d).transpose());
  Eigen::VectorXd floor = Eigen::VectorXd::Zero(m);
  if (t.in_play.size() > 0) floor = t.in_play(free).cwiseProduct(scale.cwiseAbs2());
  const Eigen::MatrixXd found = GradedMatrix(still, floor).unheld();
  Eigen::MatrixXd z(all + m, found.cols());
  z.topRows(m) = scale.asDiagonal() * found.topRows(m);
  z.middleRows(m, m) = -C * z.topRows(m);
  z.bottomRows(k + d) = found.bottomRows(k + d);
  return z;
}

}  // namespace withy
