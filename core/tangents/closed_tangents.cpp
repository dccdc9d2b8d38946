// TangentDynamics of motions that keep closed loops closed; of trees all motions do.
#include <Eigen/Dense>
#include <utility>

#include "withy/core/model/closing.hpp"
#include "withy/core/tangents/closed_motions.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {
namespace {

/// Magnitudes of the diagonal of Zᵀ B Z from those of B's: elements of B beside it are not greater than the root of the
/// product of two of these.
Eigen::VectorXd magnitudes_along(const Eigen::MatrixXd& Z, const Eigen::VectorXd& diagonal) {
  return (Z.cwiseAbs().transpose() * diagonal.cwiseAbs().cwiseSqrt()).cwiseAbs2();
}

}  // namespace

void TangentDynamics::keep_closed(std::shared_ptr<const EquationsOfMotion> equations, const State& state,
                                  const std::vector<bool>& held) {
  closed_.reset();
  if (!loops_of(*model_).empty())
    closed_ = std::make_shared<const ClosedMotions>(*model_, std::move(equations), state, held);
}

bool TangentDynamics::singular(std::span<const double> y) const { return closed_ && closed_->singular(y); }

std::vector<bool> TangentDynamics::follows() const {
  return closed_ ? closed_->follows() : std::vector<bool>(model_->layout().speeds, false);
}

Eigen::MatrixXd TangentDynamics::whole(std::span<const double> y, const Eigen::MatrixXd& speeds) const {
  return closed_ ? Eigen::MatrixXd(closed_->at(y).Z * speeds) : speeds;
}

Eigen::MatrixXd TangentDynamics::on_motions(std::span<const double> y, const Eigen::MatrixXd& efforts) const {
  return closed_ ? Eigen::MatrixXd(closed_->at(y).Z.transpose() * efforts) : efforts;
}

Eigen::VectorXd TangentDynamics::residual(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  return on_motions(y, open_residual(t, y, whole(y, a)));
}

Eigen::MatrixXd TangentDynamics::mass(double t, std::span<const double> y) const {
  const Eigen::MatrixXd M = open_mass(t, y);
  if (!closed_) return M;
  const Eigen::MatrixXd Z = closed_->at(y).Z;
  return Z.transpose() * M * Z;
}

Stiffness TangentDynamics::stiffness(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  if (!closed_) return open_stiffness(t, y, a);
  const ClosedMotions::At at = closed_->at(y);
  const Eigen::VectorXd all = at.Z * a;
  Stiffness result = open_stiffness(t, y, all);
  const ClosedMotions::Changes changes = closed_->changes(y, at, closed_->multipliers(at, result.residual), all);
  result.by_position = (result.by_position * at.Z - changes.efforts).eval();
  if (!changes.accelerations.isZero(0)) result.by_position += open_mass(t, y) * changes.accelerations;
  result.by_position = at.Z.transpose() * result.by_position;
  result.residual = at.Z.transpose() * result.residual;
  if (result.by_state.size() > 0) {
    result.by_state = at.Z.transpose() * result.by_state;
    result.rate_by_position *= at.Z;
  }
  result.diagonal_terms = magnitudes_along(at.Z, result.diagonal_terms);
  return result;
}

void TangentDynamics::close(std::span<const double> y, const Eigen::VectorXd& a, Tangents& tangents) const {
  const ClosedMotions::At at = closed_->at(y);
  const ClosedMotions::Changes changes = closed_->changes(y, at, closed_->multipliers(at, tangents.residual), at.Z * a);
  const auto of_motions = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd { return at.Z.transpose() * m * at.Z; };
  tangents.by_position =
      at.Z.transpose() * (tangents.by_position * at.Z - changes.efforts + tangents.mass * changes.accelerations);
  tangents.residual = at.Z.transpose() * tangents.residual;
  tangents.mass = of_motions(tangents.mass);
  tangents.by_speed = of_motions(tangents.by_speed);
  if (tangents.by_state.size() > 0) tangents.by_state = at.Z.transpose() * tangents.by_state;
  for (Eigen::MatrixXd* rates : {&tangents.rate_by_position, &tangents.rate_by_speed})
    if (rates->size() > 0) *rates *= at.Z;
  if (Eigen::MatrixXd& measured = tangents.rate_by_acceleration; measured.size() > 0) {
    tangents.rate_by_position += measured * changes.accelerations;
    measured *= at.Z;
  }
  tangents.in_play = magnitudes_along(at.Z, tangents.in_play);
  // What follows is at rest, where displacements and speeds have no drift.
  for (std::size_t s = 0; s < model_->layout().speeds; ++s)
    if (closed_->follows()[s]) {
      tangents.drift.row(static_cast<Eigen::Index>(s)).setZero();
      tangents.drift.col(static_cast<Eigen::Index>(s)).setZero();
    }
  tangents.loops = true;
}

Tangents TangentDynamics::tangents(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  Tangents result = open_tangents(t, y, whole(y, a));
  if (closed_) close(y, a, result);
  result.in_play = stiffness_in_play(t, y, a, result.in_play, result.mass.diagonal());
  return result;
}

}  // namespace withy
