#include "withy/core/tangents/state_jacobian.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include "withy/core/plugin/central_difference.hpp"

namespace withy {
namespace {

/// N(x) of a hinge, its pseudo-inverse, and ∂(N u)/∂x.
struct Coordinates {
  Eigen::MatrixXd rates, inverse, drift;
};

Coordinates coordinates_of(const Hinge& hinge, std::span<const double> x, std::span<const double> u) {
  const auto count = static_cast<Eigen::Index>(x.size()), speeds = static_cast<Eigen::Index>(u.size());
  const auto rate = [&](std::span<const double> at, std::span<const double> of) {
    Eigen::VectorXd x_dot(count);
    hinge.derivatives(at, of, {x_dot.data(), x.size()});
    return x_dot;
  };
  Coordinates c{Eigen::MatrixXd(count, speeds), {}, Eigen::MatrixXd(count, count)};
  std::vector<double> unit(u.size(), 0.0);
  for (Eigen::Index k = 0; k < speeds; ++k) {
    unit[static_cast<std::size_t>(k)] = 1;
    c.rates.col(k) = rate(x, unit);
    unit[static_cast<std::size_t>(k)] = 0;
  }
  c.inverse = c.rates.completeOrthogonalDecomposition().pseudoInverse();
  for (Eigen::Index j = 0; j < count; ++j) {
    // Exact for quaternions, in which N is linear.
    c.drift.col(j) = central_difference(
        [&](double h) {
          std::vector<double> moved(x.begin(), x.end());
          moved[static_cast<std::size_t>(j)] += h;
          return rate(moved, u);
        },
        0.02);
  }
  return c;
}

/// What u̇ follows from, of the speeds that are not prescribed.
struct FreeRows {
  Eigen::MatrixXd mass, by_position, by_speed, by_state;
};

/// Rows and columns of the prescribed speeds become those of the identity, so that their u̇ has no derivatives.
FreeRows free_rows(const Model& model, const Tangents& tangents) {
  FreeRows rows{tangents.mass, tangents.by_position, tangents.by_speed, tangents.by_state};
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    if (!model.driven(h)) continue;
    const auto first = static_cast<Eigen::Index>(layout.hinges[h].speed),
               count = static_cast<Eigen::Index>(layout.hinges[h].speeds);
    rows.mass.middleRows(first, count).setZero();
    rows.mass.middleCols(first, count).setZero();
    rows.mass.block(first, first, count, count).setIdentity();
    rows.by_position.middleRows(first, count).setZero();
    rows.by_speed.middleRows(first, count).setZero();
    if (layout.continuous > 0) rows.by_state.middleRows(first, count).setZero();
  }
  return rows;
}

}  // namespace

Evaluation StateJacobian::jacobian(double t, std::span<const double> y, std::span<const double> y_dot,
                                   std::span<double> jacobian) const {
  const Model& model = dynamics_.model();
  const Layout& layout = model.layout();
  const auto positions = static_cast<Eigen::Index>(layout.positions), n = static_cast<Eigen::Index>(layout.speeds),
             z = static_cast<Eigen::Index>(layout.continuous);
  const Tangents tangents = dynamics_.tangents(t, y, Eigen::Map<const Eigen::VectorXd>(y_dot.data() + positions, n));

  const FreeRows free = free_rows(model, tangents);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(free.mass);
  // Of u̇, then of ż.
  Eigen::MatrixXd by_displacement(n + z, n);
  by_displacement.topRows(n) = -lu.solve(free.by_position);

  Eigen::Map<Eigen::MatrixXd> J(jacobian.data(), positions + n + z, positions + n + z);
  J.setZero();
  J.block(positions, positions, n, n) = -lu.solve(free.by_speed);
  if (z > 0) {
    by_displacement.bottomRows(z) = tangents.rate_by_position;
    J.block(positions, positions + n, n, z) = -lu.solve(free.by_state);
    J.block(positions + n, positions, z, n) = tangents.rate_by_speed;
    J.bottomRightCorner(z, z) = tangents.rate_by_state;
    // What ż sees of u̇, which depends on all else.
    const Eigen::MatrixXd& G = tangents.rate_by_acceleration;
    by_displacement.bottomRows(z) += G * by_displacement.topRows(n);
    J.block(positions + n, positions, z, n) += G * J.block(positions, positions, n, n);
    J.bottomRightCorner(z, z) += G * J.block(positions, positions + n, n, z);
  }
  const auto identity = [&](const Slot& slot) {
    for (std::size_t i = 0; i < slot.positions; ++i) {
      const auto x = static_cast<Eigen::Index>(slot.position + i), u = static_cast<Eigen::Index>(slot.speed + i);
      J(x, positions + u) = 1;
      J.col(x).tail(n + z) = by_displacement.col(u);
    }
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (slot.speeds == 0) continue;
    if (slot.positions == 1 && slot.speeds == 1) {
      identity(slot);
      continue;
    }
    const auto x = static_cast<Eigen::Index>(slot.position), u = static_cast<Eigen::Index>(slot.speed);
    const auto count = static_cast<Eigen::Index>(slot.positions), speeds = static_cast<Eigen::Index>(slot.speeds);
    const Coordinates c = coordinates_of(*model.hinges()[h].hinge, y.subspan(slot.position, slot.positions),
                                         y.subspan(layout.positions + slot.speed, slot.speeds));
    J.block(x, x, count, count) = c.drift;
    J.block(x, positions + u, count, speeds) = c.rates;
    J.block(positions, x, n + z, count) = by_displacement.middleCols(u, speeds) * c.inverse;
  }
  for (const Slot& slot : layout.bodies) identity(slot);
  if (!J.allFinite()) return {Evaluation::Outcome::singular, -1};
  return {};
}

std::vector<std::string> StateJacobian::differenced(double t, std::span<const double> y) const {
  return dynamics_.tangents(t, y, dynamics_.steady_accelerations(t)).differenced;
}

}  // namespace withy
