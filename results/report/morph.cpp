#include "withy/results/report/morph.hpp"

#include <Eigen/Eigenvalues>

namespace withy {

Morph morph_of(const Animation& run, std::size_t body, double tolerance) {
  const std::vector<Vector3> rest = run.surface(body).vertices;
  const auto moments = static_cast<Eigen::Index>(run.times().size());
  Eigen::MatrixXd left(3 * static_cast<Eigen::Index>(rest.size()), moments);
  for (Eigen::Index m = 0; m < moments; ++m) {
    const std::vector<Vector3> now = run.vertices(body, static_cast<std::size_t>(m));
    for (std::size_t v = 0; v < rest.size(); ++v)
      left.block<3, 1>(3 * static_cast<Eigen::Index>(v), m) = now[v] - rest[v];
  }
  Morph morph;
  const double greatest = left.size() == 0 ? 0 : left.cwiseAbs().maxCoeff();
  if (!(greatest > 0)) return morph;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> principal(Eigen::MatrixXd(left.transpose() * left));
  morph.shapes.resize(left.rows(), moments);
  morph.weights.resize(moments, moments);
  Eigen::Index count = 0;
  while (count < moments && left.cwiseAbs().maxCoeff() > tolerance * greatest) {
    const Eigen::VectorXd weights = principal.eigenvectors().col(moments - 1 - count);
    const Eigen::VectorXd shape = left * weights;
    left -= shape * weights.transpose();
    Eigen::Index at = 0;
    weights.cwiseAbs().maxCoeff(&at);
    morph.shapes.col(count) = shape * weights[at];
    morph.weights.row(count) = weights.transpose() / weights[at];
    ++count;
  }
  morph.shapes.conservativeResize(Eigen::NoChange, count);
  morph.weights.conservativeResize(count, Eigen::NoChange);
  return morph;
}

}  // namespace withy
