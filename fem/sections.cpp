#include "sections.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace withy::fem {

Section section_of(const std::vector<long>& nodes, const Matrices& matrices) {
  Section section;
  section.centre.setZero();
  for (const long node : nodes) {
    const auto it = std::lower_bound(matrices.nodes.begin(), matrices.nodes.end(), node);
    if (it == matrices.nodes.end() || *it != node)
      throw InputError(fmt::format("node {} belongs to no element with mass and stiffness", node));
    section.rows.push_back(it - matrices.nodes.begin());
    section.centre += matrices.X.col(section.rows.back());
  }
  section.centre /= static_cast<double>(nodes.size());
  section.arms.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t s = 0; s < nodes.size(); ++s)
    section.arms.col(static_cast<Eigen::Index>(s)) = matrices.X.col(section.rows[s]) - section.centre;
  return section;
}

}  // namespace withy::fem
