#include "withy/core/shape/rod_table.hpp"

#include <algorithm>
#include <cmath>

namespace withy {

RodTable::RodTable(const Rod& given)
    : rod(&given),
      quadrature(given.length(),
                 std::max<Eigen::Index>(1, std::lround(std::ceil(given.wave_number() * given.length() / 4.75))), order),
      turn(1.0, 1, turn_order) {
  double before = 0;
  for (const double x : quadrature.nodes()) {
    sections.push_back(rod->section(x));
    to_node.push_back(strains_between(before, x));
    before = x;
  }
}

Eigen::MatrixXd RodTable::strains_between(double from, double to) const {
  Eigen::MatrixXd strains(3 * turn_order, rod->modes());
  for (Eigen::Index j = 0; j < turn_order; ++j) {
    const double x = from + (to - from) * turn.nodes()[static_cast<std::size_t>(j)];
    strains.middleRows<3>(3 * j) = rod->section(x).strain;
  }
  return strains;
}

}  // namespace withy
