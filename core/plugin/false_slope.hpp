/// \file
/// Whether what is said to be a derivative is one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace withy {

/// Vectors, a column each, that are said to be the derivatives of others.
struct SaidSlopes {
  Eigen::MatrixXd slopes;    ///< what is no number is wrong where differences find one
  Eigen::RowVectorXd sizes;  ///< of each column, that it is judged against, where differences do not find a greater one
  Eigen::RowVectorXd least;  ///< what each may be off by besides
};

/// One that is none.
struct FalseSlope {
  Eigen::Index column = 0;
  Eigen::MatrixXd found;  ///< what differences give, for all columns
};

/// Compares vectors, of any unit a unit of s, with differences of f(s) about s = 0. A column is right where one
/// difference, over h, h/8, h/64 or h/512, agrees with it to 1e-4 of its size. It is wrong where the differences over
/// two steps agree on another vector, to 1e-4 of that, and so do those to either side. Nothing is said where
/// differences do not come together: of what is faster than the shortest of them, h/8⁸, of what rounds to stairs, at a
/// kink and where f is not finite. \param f a matrix of the same shape at s, which moves over ±4 h \param place the
/// greatest number that s is added to, which is not moved by less than it resolves \returns the first column that is
/// wrong
std::optional<FalseSlope> false_slope(const SaidSlopes& said, const std::function<Eigen::MatrixXd(double)>& f, double h,
                                      double place);

}  // namespace withy
