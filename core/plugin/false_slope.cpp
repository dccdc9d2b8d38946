#include "withy/core/plugin/false_slope.hpp"

#include <algorithm>
#include <vector>

#include "withy/core/plugin/refined_difference.hpp"

namespace withy {
namespace {

using SlopeFunction = std::function<Eigen::MatrixXd(double)>;

/// Of the size of a slope: far above the error of good differences, far below a factor that is forgotten.
constexpr double slope_agreement = 1e-4;

/// What a column may be off by from what differences find.
double allowed_off(const SaidSlopes& said, Eigen::Index column, const Eigen::MatrixXd& found) {
  return slope_agreement * std::max(said.sizes[column], found.col(column).norm()) + said.least[column];
}

/// Whether a step in no simple ratio to those that told a slope finds it too: a wave with a whole number of periods
/// nearly, in a step and in an eighth of it, seems slow to both.
bool is_found_between(const SlopeFunction& f, Eigen::Index column, double step, const Eigen::VectorXd& slope,
                      double allowed) {
  return (central_difference(f, golden_section * step).col(column) - slope).norm() <= allowed;
}

/// Whether what a slope does to one side of the place it does not do to the other, over shorter steps as over longer:
/// of what is smooth the two differ by an eighth over an eighth of a step.
bool has_kink(const SlopeFunction& f, Eigen::Index column, double step, double allowed) {
  const Eigen::VectorXd here = f(0).col(column);
  const auto apart = [&](double h) -> double { return (f(h).col(column) + f(-h).col(column) - 2 * here).norm() / h; };
  const double shorter = apart(step);
  return !(shorter <= allowed || shorter <= apart(8 * step) / 2);
}

/// Whether steps as short as those that told a slope may see no more than a tread of a function.
bool may_be_a_tread(const SlopeFunction& f, Eigen::Index column, double wide, double fine, const Eigen::VectorXd& slope,
                    double allowed) {
  const auto own = [&](double x) -> Eigen::MatrixXd { return f(x).col(column); };
  const Eigen::MatrixXd wide_slope = central_difference(own, wide);
  if ((wide_slope - slope).norm() <= allowed) return false;
  const Eigen::ArrayXX<bool> treads = has_treads(own, wide, fine, wide_slope, Eigen::MatrixXd(slope));
  return (treads && wide_slope.array().abs() > slope.array().abs()).any();
}

/// Columns that some difference agrees with.
std::vector<bool> agreed_slopes(const SaidSlopes& said, const SlopeFunction& f, double h) {
  constexpr int steps = 4;
  std::vector<bool> agreed(static_cast<std::size_t>(said.slopes.cols()), false);
  for (int k = 0; k < steps; ++k, h /= 8) {
    const Eigen::MatrixXd found = central_difference(f, h);
    for (Eigen::Index j = 0; j < found.cols(); ++j)
      if ((said.slopes.col(j) - found.col(j)).norm() <= allowed_off(said, j, found))
        agreed[static_cast<std::size_t>(j)] = true;
    if (std::find(agreed.begin(), agreed.end(), false) == agreed.end()) break;
  }
  return agreed;
}

/// Of a column that no difference agrees with.
bool is_false(const SaidSlopes& said, const SlopeFunction& f, const RefinedDifference<Eigen::MatrixXd>& found, double h,
              Eigen::Index column) {
  const Eigen::VectorXd slope = found.slope.col(column);
  const double rounding = found.rounding.col(column).norm(), step = found.step.col(column).minCoeff();
  const double together = slope_agreement * slope.norm() + rounding;
  if (!slope.allFinite() || !(found.change.col(column).norm() <= together)) return false;
  if ((said.slopes.col(column) - slope).norm() <= allowed_off(said, column, found.slope) + rounding) return false;
  return !has_kink(f, column, step, together) && is_found_between(f, column, step, slope, together) &&
         !may_be_a_tread(f, column, h, step, slope, together);
}

}  // namespace

std::optional<FalseSlope> false_slope(const SaidSlopes& said, const SlopeFunction& f, double h, double place) {
  constexpr int levels = 8;
  const std::vector<bool> agreed = agreed_slopes(said, f, h);
  if (std::find(agreed.begin(), agreed.end(), false) == agreed.end()) return {};
  const RefinedDifference<Eigen::MatrixXd> found = refine_difference(f, h, levels, place);
  for (std::size_t j = 0; j < agreed.size(); ++j)
    if (const auto column = static_cast<Eigen::Index>(j); !agreed[j] && is_false(said, f, found, h, column))
      return FalseSlope{column, found.slope};
  return {};
}

}  // namespace withy
