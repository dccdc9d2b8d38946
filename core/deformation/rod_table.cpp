#include "withy/core/deformation/rod_table.hpp"

#include <algorithm>
#include <cmath>

namespace withy {

namespace {

/// Equal panels between two kinks, no more than 4.75 wave-number lengths each.
std::vector<double> panel_edges(const Rod& rod) {
  std::vector<double> ends = rod.kinks();
  ends.push_back(rod.length());
  std::vector<double> edges{0};
  for (const double end : ends) {
    const double from = edges.back(), length = end - from;
    const long panels = std::max(1L, std::lround(std::ceil(rod.wave_number() * length / 4.75)));
    for (long p = 1; p < panels; ++p)
      edges.push_back(from + length * static_cast<double>(p) / static_cast<double>(panels));
    edges.push_back(end);
  }
  return edges;
}

}  // namespace

RodTable::RodTable(const Rod& given) : rod(&given), quadrature(panel_edges(given), order), turn(1.0, 1, turn_order) {
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
