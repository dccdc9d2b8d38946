#include "withy/core/tangents/displacements.hpp"

#include <Eigen/QR>
#include <vector>

#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/tangents/closed_motions.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

void displace(const Model& model, std::span<double> y, std::span<const double> delta) {
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const Hinge& hinge = *model.hinges()[h].hinge;
    const auto x = y.subspan(slot.position, slot.positions);
    std::vector<double> change(slot.positions);
    hinge.derivatives(x, delta.subspan(slot.speed, slot.speeds), change);
    for (std::size_t i = 0; i < slot.positions; ++i) x[i] += change[i];
    hinge.normalize(x);
  }
  for (const Slot& slot : layout.bodies) {
    for (std::size_t i = 0; i < slot.positions; ++i) y[slot.position + i] += delta[slot.speed + i];
  }
}

void TangentDynamics::displace(std::span<double> y, const Eigen::VectorXd& delta) const {
  if (closed_)
    closed_->displace(y, delta);
  else
    withy::displace(*model_, y, {delta.data(), model_->layout().speeds});
}

Eigen::MatrixXd TangentDynamics::drift(std::span<const double> y) const {
  const Layout& layout = model_->layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (slot.positions == slot.speeds || slot.speeds == 0) continue;
    // With ẋ = N(x) u and δx = N δ along the motion, N δ̇ = N δu + (∂N[N δ] u − ∂N[N u] δ). N is linear in quaternions,
    // for which a difference is exact.
    const Hinge& hinge = *model_->hinges()[h].hinge;
    const auto x = y.subspan(slot.position, slot.positions);
    const auto u = y.subspan(layout.positions + slot.speed, slot.speeds);
    const auto count = static_cast<Eigen::Index>(slot.positions), m = static_cast<Eigen::Index>(slot.speeds);
    const auto rate = [&](std::span<const double> at, std::span<const double> speeds) {
      Eigen::VectorXd x_dot(count);
      hinge.derivatives(at, speeds, {x_dot.data(), slot.positions});
      return x_dot;
    };
    const auto change = [&](const Eigen::VectorXd& direction, std::span<const double> speeds) {
      return central_difference(
          [&](double s) {
            Eigen::VectorXd moved = s * direction;
            for (Eigen::Index i = 0; i < count; ++i) moved[i] += x[static_cast<std::size_t>(i)];
            return rate({moved.data(), slot.positions}, speeds);
          },
          0.02);
    };
    Eigen::MatrixXd N(count, m), bracket(count, m);
    std::vector<double> unit(slot.speeds);
    const Eigen::VectorXd along = rate(x, u);
    for (Eigen::Index k = 0; k < m; ++k) {
      std::fill(unit.begin(), unit.end(), 0.0);
      unit[static_cast<std::size_t>(k)] = 1;
      N.col(k) = rate(x, unit);
      bracket.col(k) = change(N.col(k), u) - change(along, unit);
    }
    const Eigen::MatrixXd change_of_speeds = N.colPivHouseholderQr().solve(bracket);
    C.block(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speed), m, m) = change_of_speeds;
  }
  return C;
}

}  // namespace withy
