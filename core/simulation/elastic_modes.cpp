#include "withy/core/simulation/elastic_modes.hpp"

#include <Eigen/Cholesky>
#include <numeric>

#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"

namespace withy {

ElasticModes elastic_modes(const ModalShape& shape, const std::vector<Eigen::Index>& coordinates) {
  const Eigen::MatrixXd G = modal_mass(shape);
  ElasticModes modes;
  modes.mass = G(coordinates, coordinates);
  // Coordinates that move no mass have no frequencies.
  if (coordinates.empty() || Eigen::LLT<Eigen::MatrixXd>(modes.mass).info() != Eigen::Success) return modes;
  const Eigen::MatrixXd K = shape.stiffness(coordinates, coordinates);
  const Vibrations found = vibrations(K, modes.mass);
  const Eigen::Index kept = found.squares.size() - found.rigid();
  modes.frequencies = found.squares.tail(kept).cwiseSqrt();
  modes.vectors = found.vectors.rightCols(kept);
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
