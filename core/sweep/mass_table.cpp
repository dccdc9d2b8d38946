#include "withy/core/sweep/mass_table.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include "withy/core/sweep/with_modes.hpp"

namespace withy::sweep {
namespace {

constexpr double negligible = 1e-9;  ///< of a column's norm

/// Coefficients of columns, none longer than 1, in an orthonormal basis of their span.
Eigen::MatrixXd pivoted_coefficients(const Eigen::MatrixXd& columns) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Eigen::Index rank = 0;
  while (rank < qr.matrixR().diagonal().size() && std::abs(qr.matrixR()(rank, rank)) > negligible) ++rank;
  const Eigen::MatrixXd upper = qr.matrixR().topRows(rank).template triangularView<Eigen::Upper>();
  return upper * qr.colsPermutation().transpose();
}

/// The same where the span has few dimensions for the numbers there are, as of products of many modes: only as many
/// columns are made part of the basis, columns of zeros are left out, and what is left of all others is formed when its
/// norms, known from the coefficients, have lost half of their digits.
Eigen::MatrixXd coefficients_of_many(const Eigen::MatrixXd& columns) {
  std::vector<Eigen::Index> at;
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    if (!columns.col(c).isZero(0)) at.push_back(c);
  Eigen::MatrixXd left = columns(Eigen::all, at);
  const Eigen::Index most = std::min(left.rows(), left.cols());
  Eigen::MatrixXd basis(left.rows(), most), found(most, left.cols());
  Eigen::Index rank = 0, formed = 0;
  const auto form = [&] {
    left.noalias() -= basis.middleCols(formed, rank - formed) * found.middleRows(formed, rank - formed);
    formed = rank;
  };
  while (rank < most) {
    Eigen::RowVectorXd squares = left.colwise().squaredNorm();
    Eigen::Index longest = 0;
    const double begun = squares.maxCoeff(&longest);
    if (!(begun > negligible * negligible)) break;
    // Squares lose as many digits as they have become smaller.
    for (double square = begun; rank < most && square > std::max(1e-8 * begun, negligible * negligible);
         square = squares.maxCoeff(&longest)) {
      auto direction = basis.col(rank);
      direction = left.col(longest) -
                  basis.middleCols(formed, rank - formed) * found.col(longest).segment(formed, rank - formed);
      for (int pass = 0; pass < 2; ++pass)
        direction -= (basis.leftCols(rank) * (basis.leftCols(rank).transpose() * direction)).eval();
      direction.normalize();
      found.row(rank).noalias() = direction.transpose() * left;
      squares -= found.row(rank).cwiseAbs2();
      squares[longest] = 0;
      ++rank;
    }
    form();
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rank, columns.cols());
  all(Eigen::all, at) = found.topRows(rank);
  return all;
}

/// Coefficients of the columns of `fields` in an orthonormal basis of their span whose first function is column 0: a
/// matrix R with Rᵀ R = fieldsᵀ fields. What is dropped has at most 1e-9 of a column's norm, so that dot products lose
/// at most 1e-18 of it.
Eigen::MatrixXd orthonormal_coefficients(const Eigen::MatrixXd& fields) {
  const Eigen::VectorXd one = fields.col(0).normalized();
  Eigen::RowVectorXd first = one.transpose() * fields;
  Eigen::MatrixXd rest = fields.rightCols(fields.cols() - 1);
  rest -= one * first.tail(rest.cols());
  const Eigen::RowVectorXd again = one.transpose() * rest;  // second pass: what rounding left along the constant
  rest -= one * again;
  first.tail(rest.cols()) += again;
  // Columns have different units; scaled, a column's own norm decides what is negligible.
  Eigen::RowVectorXd scale = fields.rightCols(rest.cols()).colwise().norm();
  for (double& s : scale) s = s > 0 ? s : 1.0;
  const Eigen::MatrixXd scaled = rest * scale.cwiseInverse().asDiagonal();
  constexpr Eigen::Index many = 1 << 19;
  const Eigen::MatrixXd of_rest = scaled.size() > many ? coefficients_of_many(scaled) : pivoted_coefficients(scaled);
  Eigen::MatrixXd R(1 + of_rest.rows(), fields.cols());
  R.row(0) = first;
  R.col(0).tail(of_rest.rows()).setZero();
  R.bottomRightCorner(of_rest.rows(), rest.cols()) = of_rest * scale.asDiagonal();
  return R;
}

/// Whether X and Γ have a first component only and Φ a second one only; columns are those of MassTable::data.
template <class Space>
bool lies_straight(const Eigen::Ref<const Eigen::MatrixXd>& fields, Eigen::Index n) {
  if (Space::angular != 1) return false;
  for (Eigen::Index vector = 0; 2 * vector < fields.cols(); ++vector) {
    const bool across = vector > 0 && vector <= n;
    if (!fields.col(2 * vector + (across ? 0 : 1)).isZero(0)) return false;
  }
  return true;
}

/// Fields of a shape, whose first column is the constant and the others vectors, X first, seen from a frame.
void place(const Pose& frame, Eigen::MatrixXd& fields) {
  for (Eigen::Index at = 1; at < fields.cols(); at += 3)
    fields.middleCols<3>(at) = (fields.middleCols<3>(at) * frame.R.transpose()).eval();
  fields.middleCols<3>(1) += fields.col(0) * frame.p.transpose();
}

/// Makes modes in [first, last) part of a range.
void extend(ModeRange& range, int first, int last) {
  range =
      range.last == 0 ? ModeRange{first, last} : ModeRange{std::min(range.first, first), std::max(range.last, last)};
}

/// Coefficients of the last bodies: the sweep and the observations of one model want them of the same fields, and so do
/// cases of a sweep that differ in other numbers. For all threads.
class LastCoefficients {
 public:
  Eigen::MatrixXd of(Eigen::MatrixXd fields) {
    constexpr Eigen::Index most_numbers = 1 << 13;
    if (fields.size() > most_numbers) return orthonormal_coefficients(fields);
    {
      const std::lock_guard lock(mutex_);
      const auto found = std::find_if(last_.begin(), last_.end(), [&](const auto& e) { return same(e.first, fields); });
      if (found != last_.end()) {
        std::rotate(last_.begin(), found, found + 1);
        return last_.front().second;
      }
    }
    Eigen::MatrixXd coefficients = orthonormal_coefficients(fields);
    const std::lock_guard lock(mutex_);
    constexpr std::size_t kept = 8;
    if (last_.size() == kept) last_.pop_back();
    return last_.emplace(last_.begin(), std::move(fields), std::move(coefficients))->second;
  }

 private:
  static bool same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() &&
           std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
  }
  std::mutex mutex_;
  std::vector<std::pair<Eigen::MatrixXd, Eigen::MatrixXd>> last_;  ///< fields and coefficients, the youngest first
};

}  // namespace

template <class Space>
TableFrame<Space>::TableFrame(const NodeSpec& node) {
  apart = Space::angular == 3 && static_cast<int>(node.modes) > modes_known && node.mass.turned();
  if (apart) X = Space::make(node.mass.placement());
}

template <class Space>
MassTable<Space>::MassTable(const NodeSpec& node) : frame(node) {
  constexpr Eigen::Index L = Space::linear;
  const auto n = static_cast<Eigen::Index>(node.modes);
  modes = static_cast<int>(n);
  const PlacedMass mass = frame.mass(node);
  if (mass.size() == 0) return;
  const auto rows = static_cast<Eigen::Index>(mass.size());
  const Eigen::Index columns = 1 + L * (1 + n + n * (n + 1) / 2);
  Eigen::MatrixXd fields(rows, columns);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const PlacedPoint at = mass.point(static_cast<std::size_t>(k));
    const double root = std::sqrt(mass.mass(static_cast<std::size_t>(k)));
    Eigen::Index column = 0;
    fields(k, column++) = root;
    const auto put = [&](const Vector3& a) {
      for (Eigen::Index c = 0; c < L; ++c) fields(k, column++) = root * a[c];
    };
    put(at.X());
    for (Eigen::Index i = 0; i < n; ++i) put(at.phi(i));
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i; j < n; ++j) {
        const Vector3 g = at.gamma(i, j);
        second_order = second_order || !g.isZero(0);
        put(g);
      }
    }
  }
  static LastCoefficients last;
  Eigen::MatrixXd R = last.of(std::move(fields));
  root_mass = R(0, 0);
  rank = static_cast<std::size_t>(R.rows());
  packs = (rank + lanes - 1) / lanes;
  stride = static_cast<std::size_t>(columns - 1);
  straight = second_order && lies_straight<Space>(R.rightCols(columns - 1), n);
  if (modes > modes_known && !straight) lay_blocks(R.rightCols(columns - 1));
  if (frame.apart) place(node.mass.placement(), R);
  std::vector<typename Space::Group> numbers(packs * stride, spread(0.0));
  for (Eigen::Index k = 0; k < R.rows(); ++k) {
    const auto row = static_cast<std::size_t>(k);
    for (std::size_t c = 0; c < stride; ++c) {
      set_lane(numbers[(row / lanes) * stride + c], row % lanes, R(k, static_cast<Eigen::Index>(c) + 1));
    }
  }
  data = std::move(numbers);
  runs = runs_of<L>(R.rightCols(L * (n * (n + 1) / 2)), modes);
  if (modes > modes_known && straight) lay_straight();
}

template <class Space>
void MassTable<Space>::lay_blocks(const Eigen::MatrixXd& fields) {
  constexpr int L = Space::linear;
  const auto column = [](int vector, int component) { return L * vector + component; };
  block_runs = runs_of<L>(fields.rightCols(fields.cols() - column(1 + modes, 0)), modes);
  for (int c = 0; c < L; ++c) {
    for (int i = 0; i < modes; ++i)
      if (!fields.col(column(1 + i, c)).isZero(0)) extend(with_phi[c], i, i + 1);
    with_partial[c] = with_phi[c];
  }
  for (const FieldRun& run : block_runs) {
    extend(with_partial[run.component], run.row, run.row + 1);
    extend(with_partial[run.component], run.first, run.last);
  }
  std::vector<typename Space::Group> numbers;
  for (std::size_t k = 0; k < packs; k += block) {
    const std::size_t end = std::min(packs, k + block);
    const auto put = [&](int at) {
      for (std::size_t pack = k; pack < end; ++pack) {
        numbers.push_back(spread(0.0));
        for (std::size_t lane = 0; lane < std::min(lanes, rank - lanes * pack); ++lane)
          set_lane(numbers.back(), lane, fields(static_cast<Eigen::Index>(lanes * pack + lane), at));
      }
    };
    for (int c = 0; c < L; ++c) put(column(0, c));
    for (int c = 0; c < L; ++c)
      for (int i = with_phi[c].first; i < with_phi[c].last; ++i) put(column(1 + i, c));
    for (const FieldRun& run : block_runs)
      for (int j = run.first; j < run.last; ++j) put(column(1 + modes + pair_at(run.row, j, modes), run.component));
  }
  blocks = std::move(numbers);
}

template <class Space>
void MassTable<Space>::lay_straight() {
  const auto n = static_cast<std::size_t>(modes);
  const std::size_t pairs = n * (n + 1) / 2;
  // Columns of `data`: X, Φ_i, Γ_ij, two components each.
  const auto column = [&](std::size_t pack, std::size_t vector, std::size_t component) {
    return data[pack * stride + 2 * vector + component];
  };
  std::vector<typename Space::Group> groups, rows;
  for (std::size_t k = 0; k < packs; k += block) {
    const std::size_t end = std::min(packs, k + block);
    for (std::size_t i = 0; i < 1 + pairs; ++i)
      for (std::size_t pack = k; pack < end; ++pack) groups.push_back(column(pack, i == 0 ? 0 : n + i, 0));
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t pack = 0; pack < packs; ++pack) rows.push_back(column(pack, 1 + i, 1));
  std::vector<double> products_of_rows(n * n, 0.0);
  add_gram<double>(rows.data(), rows.data(), static_cast<int>(packs), modes, products_of_rows.data());
  along = std::move(groups), across = std::move(rows), across_products = std::move(products_of_rows);
}

template struct TableFrame<Spatial>;
template struct TableFrame<Planar>;
template struct MassTable<Spatial>;
template struct MassTable<Planar>;

}  // namespace withy::sweep
