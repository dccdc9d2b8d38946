#include "withy/core/sweep/rod/rod_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace withy::sweep {
namespace {

/// Coordinates of a node's stations along its rod.
std::vector<double> station_coordinates(const NodeSpec& spec) {
  std::vector<double> x;
  const Pose in_rod = spec.rod_frame.inverse();
  for (const StationSpec& s : spec.stations)
    x.push_back(std::clamp((in_rod.p + in_rod.R * s.at.X).x(), 0.0, spec.rod->length()));
  return x;
}

std::vector<Pack> packed(const double* values, std::size_t count) {
  std::vector<Pack> packs(count / lanes);
  for (std::size_t i = 0; i < count; ++i) set_lane(packs[i / lanes], i % lanes, values[i]);
  return packs;
}

/// First order of a section at x, the rod's frame given in the node's.
template <class Space>
RodStation<Space> rod_station(const Pose& frame, double x, const RodSection& section) {
  RodStation<Space> station;
  station.X = Space::position(frame.p + x * frame.R.col(0));
  std::vector<typename Space::Twist> first;
  for (Eigen::Index i = 0; i < section.rotation.cols(); ++i) {
    first.push_back(Space::Twist::of(Space::angle(frame.R * section.rotation.col(i)),
                                     Space::position(frame.R * section.deflection.col(i))));
  }
  station.first = std::move(first);
  return station;
}

}  // namespace

RodIntegrals::RodIntegrals(const RodTable& table, const std::vector<double>& along) : station_x(along) {
  const PanelQuadrature& quadrature = table.quadrature;
  const std::size_t nodes = quadrature.nodes().size();
  const int order = static_cast<int>(quadrature.order()), half = order / 2;
  packs = static_cast<int>(nodes / lanes);
  packs_per_panel = order / static_cast<int>(lanes);
  const Eigen::MatrixXd& to_nodes = quadrature.running();
  std::vector<double> even, odd;
  for (int j = 0; j < half; ++j) {
    const int mirror = order - 1 - j;
    for (int i = half; i < order; ++i) {
      const double own = to_nodes(i, j), other = to_nodes(i, mirror),
                   weight = quadrature.weights()[static_cast<std::size_t>(j)];
      even.push_back(0.5 * (own + other - weight));
      odd.push_back(0.5 * (other - own));
    }
  }
  from_even = packed(even.data(), even.size());
  from_odd = packed(odd.data(), odd.size());
  weights = packed(quadrature.weights().data(), static_cast<std::size_t>(half));
  std::vector<double> lengths;
  for (std::size_t k = 0; k < nodes; k += static_cast<std::size_t>(order))
    lengths.push_back(quadrature.weights()[k] / quadrature.weights()[0]);
  scale = std::move(lengths);
  std::vector<double> root(nodes);
  for (std::size_t k = 0; k < nodes; ++k) {
    root[k] = std::sqrt(table.masses[k]);
    mass += table.masses[k];
  }
  root_mass = packed(root.data(), nodes);
  for (const double x : station_x) stations.push_back(packed(quadrature.weights_to(x).data(), nodes));
}

bool RodKinematics<Planar>::fits(const NodeSpec& spec) const {
  return integrals.station_x == station_coordinates(spec);
}
bool RodKinematics<Spatial>::fits(const NodeSpec& spec) const {
  return integrals.station_x == station_coordinates(spec);
}

RodKinematics<Planar>::RodKinematics(const NodeSpec& spec) {
  const RodTable table(*spec.rod);
  const std::vector<double> x = station_coordinates(spec);
  integrals = RodIntegrals(table, x);
  const Pose& frame = spec.rod_frame;
  heading = std::atan2(frame.R(1, 0), frame.R(0, 0));
  const std::size_t n = spec.modes;
  std::vector<Pack> places(static_cast<std::size_t>(integrals.packs) * 2);
  std::vector<Pack> linear(static_cast<std::size_t>(integrals.packs) * n * 3);
  for (std::size_t k = 0; k < table.sections.size(); ++k) {
    const RodStation<Planar> node = rod_station<Planar>(frame, table.quadrature.nodes()[k], table.sections[k]);
    for (int c = 0; c < 2; ++c) set_lane(places[(k / lanes) * 2 + static_cast<std::size_t>(c)], k % lanes, node.X[c]);
    for (std::size_t i = 0; i < n; ++i) {
      for (int c = 0; c < 3; ++c)
        set_lane(linear[((k / lanes) * n + i) * 3 + static_cast<std::size_t>(c)], k % lanes, node.first[i][c]);
    }
  }
  X = std::move(places);
  first = std::move(linear);
  for (const double at : x) stations.push_back(rod_station<Planar>(frame, at, spec.rod->section(at)));
}

namespace {

/// The turns of a rod from node to node, then from the node before each station to it.
struct Turns {
  std::vector<std::pair<double, double>> steps;  ///< from and to where along the rod; whole packs of each kind
  std::vector<int> after, pieces;                ///< as RodKinematics has them, whole packs
};

/// Wave number times length: Magnus' expansion leaves the seventh power of it. Of random trees, bent by a third of a
/// radian between two nodes, Newton's and Euler's laws close to 5e-10; at 0.16 to 2e-8, with one step a turn to 6e-7.
constexpr double longest_step = 0.09;

Turns turns_between(const RodTable& table, const std::vector<double>& stations) {
  const std::vector<double>& nodes = table.quadrature.nodes();
  const double wave_number = table.rod->wave_number();
  Turns turns;
  std::vector<std::pair<double, double>> before_last;
  const auto add = [&](double from, double to, int after) {
    std::vector<std::pair<double, double>> steps;
    for (const RodTable::Piece& piece : table.pieces_between(from, to)) {
      const double length = piece.to - piece.from,
                   count = std::clamp(std::ceil(wave_number * length / longest_step), 1.0, 8.0);
      const auto at = [&](double k) { return piece.from + length * k / count; };
      for (double k = 1; k <= count; ++k) steps.emplace_back(at(k - 1), k < count ? at(k) : piece.to);
    }
    before_last.insert(before_last.end(), steps.begin(), steps.end() - 1);
    turns.steps.push_back(steps.back());
    turns.after.push_back(after);
    turns.pieces.push_back(static_cast<int>(steps.size()) - 1);
  };
  for (std::size_t k = 0; k < nodes.size(); ++k) add(k > 0 ? nodes[k - 1] : 0.0, nodes[k], static_cast<int>(k) - 1);
  for (const double at : stations) {
    const auto before = std::lower_bound(nodes.begin(), nodes.end(), at) - nodes.begin();
    add(before > 0 ? nodes[static_cast<std::size_t>(before - 1)] : 0.0, at, static_cast<int>(before) - 1);
  }
  while (turns.after.size() % lanes != 0) {
    turns.steps.emplace_back(0, 0);
    turns.after.push_back(-1);
    turns.pieces.push_back(0);
  }
  turns.steps.insert(turns.steps.end(), before_last.begin(), before_last.end());
  while (turns.steps.size() % lanes != 0) turns.steps.emplace_back(0, 0);
  return turns;
}

/// Of each turn and mode ∫κ ds, a₁, a₂ (see magnus), as RodKinematics::step has them.
std::vector<Pack> turn_moments(const NodeSpec& spec, const RodTable& table, const Turns& turns) {
  const std::size_t n = spec.modes;
  const Matrix3& R = spec.rod_frame.R;
  std::vector<Pack> moments(turns.steps.size() / lanes * n * 9, spread(0.0));
  for (std::size_t s = 0; s < turns.steps.size(); ++s) {
    const auto [from, to] = turns.steps[s];
    const double h = to - from;
    if (!(h > 0)) continue;
    // Moments B_m = ∫ ((s − s_m)/h)ᵐ κ ds: a₁ = 12 B₁, a₂ = −15 B₀ + 180 B₂; ∫κ itself from the rotations.
    Matrix3X B0 = Matrix3X::Zero(3, static_cast<Eigen::Index>(n)), B1 = B0, B2 = B0;
    const Eigen::MatrixXd strains = table.strains_between(from, to);
    for (std::size_t j = 0; j < table.turn.nodes().size(); ++j) {
      const Matrix3X kappa = h * table.turn.weights()[j] * R * strains.middleRows<3>(3 * static_cast<Eigen::Index>(j));
      const double u = table.turn.nodes()[j] - 0.5;
      B0 += kappa;
      B1 += u * kappa;
      B2 += u * u * kappa;
    }
    const Matrix3X turn = R * (spec.rod->section(to).rotation - spec.rod->section(from).rotation);
    const Matrix3X a1 = 12 * B1, a2 = 180 * B2 - 15 * B0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        Pack* moment = moments.data() + ((s / lanes) * n + i) * 9 + c;
        const auto row = static_cast<Eigen::Index>(c), column = static_cast<Eigen::Index>(i);
        set_lane(moment[0], s % lanes, turn(row, column));
        set_lane(moment[3], s % lanes, a1(row, column));
        set_lane(moment[6], s % lanes, a2(row, column));
      }
    }
  }
  return moments;
}

}  // namespace

RodKinematics<Spatial>::RodKinematics(const NodeSpec& spec) {
  const RodTable table(*spec.rod);
  const std::vector<double> x = station_coordinates(spec);
  integrals = RodIntegrals(table, x);
  const Pose& frame = spec.rod_frame;
  const Matrix3& R = frame.R;
  direction = Spatial::position(R.col(0));
  const std::size_t n = spec.modes;
  const std::vector<double>& nodes = table.quadrature.nodes();
  std::vector<Pack> places(static_cast<std::size_t>(integrals.packs) * 3);
  std::vector<Pack> linear(static_cast<std::size_t>(integrals.packs) * n * 12);
  bool rotary = false;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const RodSection& section = table.sections[k];
    const Vector3 place = frame.p + nodes[k] * R.col(0);
    for (std::size_t c = 0; c < 3; ++c)
      set_lane(places[(k / lanes) * 3 + c], k % lanes, place[static_cast<Eigen::Index>(c)]);
    for (std::size_t i = 0; i < n; ++i) {
      const auto mode = static_cast<Eigen::Index>(i);
      const Vector3 psi = section.rotation.col(mode);
      Matrix3X fields(3, 4);
      fields << section.strain.col(mode), psi, psi.cross(Vector3::UnitX()), section.deflection.col(mode);
      fields = R * fields;
      for (std::size_t c = 0; c < 12; ++c)
        set_lane(linear[((k / lanes) * n + i) * 12 + c], k % lanes, fields.data()[c]);
    }
    rotary = rotary || table.inertias[k] > 0;
  }
  X = std::move(places);
  first = std::move(linear);
  if (rotary) inertia = packed(table.inertias.data(), nodes.size());
  for (const double at : x) stations.push_back(rod_station<Spatial>(frame, at, spec.rod->section(at)));

  first_station = nodes.size();
  Turns turns = turns_between(table, x);
  step = turn_moments(spec, table, turns);
  steps = turns.steps.size();
  after = std::move(turns.after);
  pieces = std::move(turns.pieces);
}

}  // namespace withy::sweep
