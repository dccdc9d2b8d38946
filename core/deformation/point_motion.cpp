#include "withy/core/deformation/point_motion.hpp"

namespace withy {

void PolynomialKinematics::evaluate(std::span<const double> q, std::span<const double> q_dot,
                                    std::span<PointMotion> motions) const {
  const Eigen::VectorXd coordinates = Eigen::Map<const Eigen::VectorXd>(q.data(), modes_);
  const Eigen::VectorXd rates = Eigen::Map<const Eigen::VectorXd>(q_dot.data(), modes_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const PointMotionOf<double> m = point_motion<double>(points_[i], order_, coordinates, rates);
    motions[i] = {m.r, m.R, m.P, m.W, m.r_bias, m.w_bias};
  }
}

}  // namespace withy
