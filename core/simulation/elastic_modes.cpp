#include "withy/core/simulation/elastic_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <numeric>

#include "withy/core/shape/modal_mass.hpp"

namespace withy {

ElasticModes elastic_modes(const ModalShape& shape, const std::vector<Eigen::Index>& coordinates) {
  const Eigen::MatrixXd G = modal_mass(shape);
  ElasticModes modes;
  modes.mass = G(coordinates, coordinates);
  // Coordinates that move no mass have no frequencies.
  if (coordinates.empty() || Eigen::LLT<Eigen::MatrixXd>(modes.mass).info() != Eigen::Success) return modes;
  const Eigen::MatrixXd K = shape.stiffness(coordinates, coordinates);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, modes.mass);
  const Eigen::VectorXd& squares = solver.eigenvalues();
  // Squared frequencies of beam modes spread over 1e5 for ten modes; what is 1e-10 of the greatest is a rigid motion.
  Eigen::Index rigid = 0;
  while (rigid < squares.size() && squares[rigid] <= 1e-10 * squares[squares.size() - 1]) ++rigid;
  const Eigen::Index kept = squares.size() - rigid;
  modes.frequencies = squares.tail(kept).cwiseSqrt();
  modes.vectors = solver.eigenvectors().rightCols(kept);
  return modes;
}

ElasticModes elastic_modes(const ModalShape& shape) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(shape.modes()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return elastic_modes(shape, all);
}

std::vector<ModeGroup> mode_groups(const ModalShape& shape) {
  std::vector<ModeGroup> groups;
  for (Eigen::Index i = 0; i < shape.modes(); ++i) {
    const std::string& name = shape.mode_names[static_cast<std::size_t>(i)];
    const std::string family = name.substr(0, name.find('['));
    if (groups.empty() || groups.back().name != family) groups.push_back({family, {}});
    groups.back().coordinates.push_back(i);
  }
  return groups;
}

Eigen::MatrixXd stiffness_of_modes(const Model& model) {
  const auto n = static_cast<Eigen::Index>(model.layout().speeds);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const ModalShape& shape = model.bodies()[b].body->shape();
    if (shape.modes() == 0) continue;
    const auto at = static_cast<Eigen::Index>(model.layout().modes(b)->speed);
    K.block(at, at, shape.modes(), shape.modes()) = shape.stiffness;
  }
  return K;
}

}  // namespace withy
