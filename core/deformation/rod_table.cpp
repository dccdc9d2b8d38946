#include "withy/core/deformation/rod_table.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace withy {

namespace {

/// Wave-number lengths that a panel spans at most where no mass changes abruptly in it, and where it may; and one of
/// few nodes.
constexpr double panel_span = 4.75, over_kinks = panel_span / 2, short_span = 1.2;

std::vector<double> together(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

/// Equal panels between two of these points, none longer than it may be.
std::vector<double> panel_edges(const Rod& rod, std::vector<double> ends, double span) {
  ends.push_back(rod.length());
  std::vector<double> edges{0};
  for (const double end : ends) {
    const double from = edges.back(), length = end - from;
    const long panels = std::max(1L, std::lround(std::ceil(rod.wave_number() * length / span)));
    for (long p = 1; p < panels; ++p)
      edges.push_back(from + length * static_cast<double>(p) / static_cast<double>(panels));
    edges.push_back(end);
  }
  return edges;
}

/// Panels that end at all kinks.
PanelQuadrature between_kinks(const Rod& rod) {
  const std::vector<double> kinks = rod.kinks(),
                            edges = panel_edges(rod, together(kinks, rod.mass_kinks()), panel_span);
  double longest = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) longest = std::max(longest, edges[i] - edges[i - 1]);
  const bool few = !kinks.empty() && rod.wave_number() * longest <= short_span;
  return {edges, few ? RodTable::short_order : RodTable::order};
}

/// The polynomials of least degree that are one at a node and zero at the others, at x.
std::vector<double> lagrange(const double* nodes, double x) {
  std::vector<double> values(RodTable::order, 1.0);
  for (std::size_t j = 0; j < values.size(); ++j)
    for (std::size_t m = 0; m < values.size(); ++m)
      if (m != j) values[j] *= (x - nodes[m]) / (nodes[j] - nodes[m]);
  return values;
}

/// RodTable::root, which rounding of functions that vanish there does not turn.
std::optional<PointExpansion> turning_root(const Rod& rod, const std::vector<RodSection>& sections) {
  constexpr double rounding = 1e-9;
  Matrix3X rotation = rod.section(0).rotation;
  double greatest = 0;
  for (const RodSection& s : sections) greatest = std::max(greatest, s.rotation.cwiseAbs().maxCoeff());
  if (!(rotation.cwiseAbs().maxCoeff() > rounding * greatest)) return {};
  PointExpansion root = PointExpansion::rigid(Vector3::Zero(), rotation.cols());
  root.psi = std::move(rotation);
  return root;
}

/// Masses and inertias of a rod beyond a point of it, at the nodes of panels that go over kinks of these.
struct SpreadMass {
  std::vector<double> masses;
  std::vector<Matrix3> inertias;

  /// \param edges of the panels of `quadrature`
  SpreadMass(const Rod& rod, const PanelQuadrature& quadrature, const std::vector<double>& edges, double from)
      : masses(quadrature.nodes().size()), inertias(masses.size(), Matrix3::Zero()) {
    std::vector<double> pieces = together(edges, rod.mass_kinks());
    std::erase_if(pieces, [from](double x) { return x <= from; });
    if (pieces.empty()) return;
    pieces.insert(pieces.begin(), from);
    // Rows of a table are straight between kinks: products with polynomials of degree 15 are integrated exactly.
    const PanelQuadrature fine(pieces, RodTable::order);
    std::size_t panel = 0;
    for (std::size_t k = 0; k < fine.nodes().size(); ++k) {
      const double x = fine.nodes()[k], weight = fine.weights()[k];
      while (x > edges[panel + 1]) ++panel;
      const std::size_t first = panel * RodTable::order;
      const std::vector<double> part = lagrange(quadrature.nodes().data() + first, x);
      const RodSection section = rod.section(x);
      for (std::size_t j = 0; j < part.size(); ++j) {
        masses[first + j] += weight * part[j] * section.mass_per_length;
        inertias[first + j] += weight * part[j] * section.inertia_per_length;
      }
    }
  }
  [[nodiscard]] bool possible() const {
    return std::all_of(masses.begin(), masses.end(), [](double m) { return m > 0; }) &&
           std::all_of(inertias.begin(), inertias.end(), [](const Matrix3& J) {
             if (J.isDiagonal(0)) return (J.diagonal().array() >= 0).all();
             const Eigen::SelfAdjointEigenSolver<Matrix3> principal(J, Eigen::EigenvaluesOnly);
             return principal.eigenvalues()[0] >= -1e-14 * J.trace();  // zero but for rounding
           });
  }
};

}  // namespace

RodTable::RodTable(const Rod& given)
    : rod(&given), quadrature(between_kinks(given)), turn(1.0, 1, turn_order), kinks_(given.kinks()) {
  if (!given.mass_kinks().empty()) {
    const std::vector<double> edges = panel_edges(given, given.kinks(), over_kinks);
    if (edges.size() * static_cast<std::size_t>(order) <= quadrature.nodes().size()) {
      const PanelQuadrature over(edges, order);
      SpreadMass spread(given, over, edges, 0);
      if (spread.possible()) {
        quadrature = over, over_ = edges;
        masses = std::move(spread.masses), inertias = std::move(spread.inertias);
      }
    }
  }
  add_sections();
  root = turning_root(given, sections);
}

void RodTable::add_sections() {
  double before = 0;
  for (std::size_t k = 0; k < quadrature.nodes().size(); ++k) {
    const double x = quadrature.nodes()[k], weight = quadrature.weights()[k];
    sections.push_back(rod->section(x));
    to_node.push_back(pieces_between(before, x));
    before = x;
    if (!over_.empty()) continue;
    masses.push_back(weight * sections.back().mass_per_length);
    inertias.emplace_back(weight * sections.back().inertia_per_length);
  }
}

RodTable::Part RodTable::beyond(double x) const {
  Part part;
  const std::size_t nodes = masses.size();
  if (over_.empty()) {
    const Eigen::RowVectorXd before = quadrature.weights_to(x);
    for (std::size_t k = 0; k < nodes; ++k) {
      part.shares.push_back(1 - before[static_cast<Eigen::Index>(k)] / quadrature.weights()[k]);
      part.inertias.emplace_back(part.shares.back() * inertias[k]);
    }
    return part;
  }
  SpreadMass rest(*rod, quadrature, over_, x);
  for (std::size_t k = 0; k < nodes; ++k) part.shares.push_back(rest.masses[k] / masses[k]);
  part.inertias = std::move(rest.inertias);
  return part;
}

std::vector<RodTable::Piece> RodTable::pieces_between(double from, double to) const {
  std::vector<Piece> pieces;
  for (const double kink : kinks_) {
    if (kink <= from || kink >= to) continue;
    pieces.push_back({from, kink, strains_between(from, kink)});
    from = kink;
  }
  pieces.push_back({from, to, strains_between(from, to)});
  return pieces;
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
