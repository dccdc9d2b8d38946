#include "withy/core/sweep/rod/rod_kinematics.hpp"

#include <Eigen/Eigenvalues>
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

/// γ_i at the nodes, as RodKinematics has them; none where no section has any.
template <class Space>
std::vector<Pack> elongations(const RodTable& table, const Pose& frame) {
  constexpr std::size_t L = Space::linear;
  const Eigen::Index n = table.sections.front().elongation.cols();
  std::vector<Pack> packs(table.sections.size() / lanes * static_cast<std::size_t>(n) * L);
  for (std::size_t k = 0; k < table.sections.size(); ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3 gamma = frame.R * table.sections[k].elongation.col(i);
      Pack* at = packs.data() + ((k / lanes) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)) * L;
      for (std::size_t c = 0; c < L; ++c) set_lane(at[c], k % lanes, gamma[static_cast<Eigen::Index>(c)]);
    }
  }
  return packs;
}

/// RodKinematics<Planar>::rotary.
std::vector<double> rotary_about_normal(const RodTable& table, const Pose& frame) {
  const Eigen::Index n = table.rod->modes();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (std::size_t k = 0; k < table.sections.size(); ++k) {
    Eigen::VectorXd turn(n + 1);
    turn[0] = 1;
    for (Eigen::Index i = 0; i < n; ++i) turn[i + 1] = Planar::angle(frame.R * table.sections[k].rotation.col(i));
    sums += (frame.R * table.inertias[k] * frame.R.transpose())(2, 2) * turn * turn.transpose();
  }
  if (!(sums(0, 0) > 0)) return {};
  std::vector<double> all(sums.data(), sums.data() + n + 1);
  for (Eigen::Index i = 1; i <= n; ++i)
    for (Eigen::Index j = 1; j <= n; ++j) all.push_back(sums(j, i));
  return all;
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
  elongation = elongations<Planar>(table, frame);
  rotary = rotary_about_normal(table, frame);
  for (const double at : x) stations.push_back(rod_station<Planar>(frame, at, spec.rod->section(at)));
}

namespace {

/// Principal axes of the nodes' inertia in the node's axes, one pack of nodes after the other.
struct PrincipalAxes {
  std::vector<RotaryTable<Spatial>::Axis> axes;
  std::size_t each = 0;
  bool about_x = true;  ///< of the rod

  PrincipalAxes(const std::vector<Matrix3>& inertias, const Matrix3& R) {
    std::vector<std::vector<std::pair<double, Vector3>>> found;
    for (const Matrix3& J : inertias) {
      found.emplace_back();
      // Axes that a body gives as its own stay so to the last bit.
      const bool own = J.isDiagonal(0);
      const Eigen::SelfAdjointEigenSolver<Matrix3> principal(J);
      for (Eigen::Index c = 0; c < 3; ++c) {
        const double about = own ? J(c, c) : principal.eigenvalues()[c];
        if (!(about > rounding * J.trace())) continue;
        found.back().emplace_back(about,
                                  R * (own ? Vector3(Vector3::Unit(c)) : Vector3(principal.eigenvectors().col(c))));
        about_x = about_x && own && c == 0;
      }
      each = std::max(each, found.back().size());
    }
    const Pack zero = spread(0.0);
    axes.assign(inertias.size() / lanes * each, {zero, {zero, zero, zero}});
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (std::size_t j = 0; j < found[k].size(); ++j) {
        RotaryTable<Spatial>::Axis& axis = axes[k / lanes * each + j];
        set_lane(axis.J, k % lanes, found[k][j].first);
        for (std::size_t c = 0; c < 3; ++c)
          set_lane(axis.e[c], k % lanes, found[k][j].second[static_cast<Eigen::Index>(c)]);
      }
    }
  }

 private:
  /// Below this share of the trace a principal inertia is what rounding left of zero.
  static constexpr double rounding = 1e-15;
};

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
  if (table.root) {
    std::vector<Triple> turns;
    for (Eigen::Index i = 0; i < table.root->psi.cols(); ++i)
      turns.push_back(Spatial::angle(R * table.root->psi.col(i)));
    root = std::move(turns);
  }
  const std::vector<double>& nodes = table.quadrature.nodes();
  std::vector<Pack> places(static_cast<std::size_t>(integrals.packs) * 3);
  std::vector<Pack> linear(static_cast<std::size_t>(integrals.packs) * n * 12);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const RodSection& section = table.sections[k];
    const Vector3 place = frame.p + nodes[k] * R.col(0);
    for (std::size_t c = 0; c < 3; ++c)
      set_lane(places[(k / lanes) * 3 + c], k % lanes, place[static_cast<Eigen::Index>(c)]);
    for (std::size_t i = 0; i < n; ++i) {
      const auto mode = static_cast<Eigen::Index>(i);
      const Vector3 psi = section.rotation.col(mode);
      Vector3 slope = psi.cross(Vector3::UnitX());
      if (section.elongation.cols() > 0) slope += section.elongation.col(mode);
      Matrix3X fields(3, 4);
      fields << section.strain.col(mode), psi, slope, section.deflection.col(mode);
      fields = R * fields;
      for (std::size_t c = 0; c < 12; ++c)
        set_lane(linear[((k / lanes) * n + i) * 12 + c], k % lanes, fields.data()[c]);
    }
  }
  X = std::move(places);
  first = std::move(linear);
  elongation = elongations<Spatial>(table, frame);
  PrincipalAxes inertia(table.inertias, R);
  axes_each = inertia.each;
  about_axis = inertia.about_x && elongation.empty();
  axes = std::move(inertia.axes);
  for (const double at : x) stations.push_back(rod_station<Spatial>(frame, at, spec.rod->section(at)));

  first_station = nodes.size();
  Turns turns = turns_between(table, x);
  step = turn_moments(spec, table, turns);
  steps = turns.steps.size();
  after = std::move(turns.after);
  pieces = std::move(turns.pieces);
}

}  // namespace withy::sweep
