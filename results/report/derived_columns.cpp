#include "withy/results/report/derived_columns.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "withy/core/simulation/tips.hpp"
#include "withy/results/result_columns.hpp"

namespace withy {
namespace {

constexpr double degrees_a_radian = 180 / std::numbers::pi;

/// Intrinsic rotations about x, y, z [deg]: R = Rx(a) Ry(b) Rz(c). The quaternion need not have the length 1.
std::array<double, 3> turns_about_xyz(double w, double x, double y, double z) {
  const double length = std::sqrt(w * w + x * x + y * y + z * z), n = length > 0 ? length : 1;
  w /= n, x /= n, y /= n, z /= n;
  return {degrees_a_radian * std::atan2(2 * (w * x - y * z), 1 - 2 * (x * x + y * y)),
          degrees_a_radian * std::asin(std::clamp(2 * (x * z + w * y), -1.0, 1.0)),
          degrees_a_radian * std::atan2(2 * (w * z - x * y), 1 - 2 * (y * y + z * z))};
}

/// Takes from an angle [deg] the whole turns that it may be off by from the row before. Where it is none, the row
/// before stays the last that is known.
double followed_angle(double angle, std::optional<double>& before) {
  if (!std::isfinite(angle)) return angle;
  if (before) angle -= 360 * std::round((angle - *before) / 360);
  before = angle;
  return angle;
}

}  // namespace

DerivedColumns::DerivedColumns(const std::vector<Column>& columns, const Model& model,
                               std::unique_ptr<Observation> seen)
    : layout_(model.layout()), seen_(std::move(seen)) {
  for (std::size_t c = 0; c < columns.size(); ++c) known_.try_emplace(columns[c].name, c);
  add_attitudes(columns);
  energies_ = places<3>({"kinetic_energy", "potential_energy", "work"});
  if (energies_) columns_.push_back({"drift", "J"});
  shown_ = columns_.size();
  add_validity(model);
  known_ = {};  // of a large model many
}

template <std::size_t count>
std::optional<std::array<std::size_t, count>> DerivedColumns::places(
    const std::array<std::string, count>& names) const {
  std::array<std::size_t, count> all{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = known_.find(names[i]);
    if (found == known_.end()) return std::nullopt;
    all[i] = found->second;
  }
  return all;
}

void DerivedColumns::add_attitudes(const std::vector<Column>& columns) {
  constexpr std::string_view real = ".qw";
  for (const Column& column : columns) {
    if (!column.name.ends_with(real)) continue;
    const std::string base = column.name.substr(0, column.name.size() - real.size());
    const auto at = places<4>({base + ".qw", base + ".qx", base + ".qy", base + ".qz"});
    if (!at) continue;
    attitudes_.push_back({*at, {}});
    for (const char* axis : {".x", ".y", ".z"}) columns_.push_back({base + axis, "deg"});
  }
}

void DerivedColumns::add_validity(const Model& model) {
  for (std::size_t b = 0; seen_ != nullptr && b < model.bodies().size(); ++b) {
    const BodyNode& node = model.bodies()[b];
    if (node.body->shape().modes() == 0) continue;
    turning_.push_back(b);
    rates_.push_back({node.name, columns_.size()});
    columns_.push_back({"rate of '" + node.name + "'", "rad/s"});
  }
  for (const Tip& tip : tips(model)) {
    const std::string name = tip.body + ".tip.deflection_";
    const auto at = places<3>({name + "x", name + "y", name + "z"});
    if (!at || !(tip.length > 0)) continue;
    bent_.push_back({*at, tip.length});
    deflections_.push_back({tip.body, columns_.size()});
    columns_.push_back({"tip deflection of '" + tip.body + "' over its length", "1"});
  }
}

void DerivedColumns::append(std::span<const double> row, std::vector<double>& numbers) {
  for (Attitude& a : attitudes_) {
    const auto [about_x, about_y, about_z] =
        turns_about_xyz(row[a.places[0]], row[a.places[1]], row[a.places[2]], row[a.places[3]]);
    const double x = followed_angle(about_x, a.before[0]), z = followed_angle(about_z, a.before[1]);
    numbers.insert(numbers.end(), {x, about_y, z});
  }
  if (energies_) {
    const auto [kinetic, potential, work] = *energies_;
    const double energy = row[kinetic] + row[potential] - row[work];
    if (!first_energy_) first_energy_ = energy;
    numbers.push_back(energy - *first_energy_);
  }
  if (!turning_.empty()) seen_->observe(state_of_row(layout_, row).y);
  for (const std::size_t b : turning_) numbers.push_back(seen_->turning(static_cast<int>(b)));
  for (const Bent& b : bent_)
    numbers.push_back(Vector3(row[b.places[0]], row[b.places[1]], row[b.places[2]]).norm() / b.length);
}

}  // namespace withy
