#include "withy/core/tree/placed_mass.hpp"

#include <algorithm>
#include <cstdint>

#include "withy/core/tree/tree.hpp"

namespace withy {
namespace {

void drop_second_order(PointExpansion& e) {
  for (std::size_t c = 0; c < 3; ++c) {
    e.gamma[c].setZero();
    e.theta[c].setZero();
  }
}

}  // namespace

PointExpansion PlacedMass::placed(const PointExpansion& e) const {
  PointExpansion result = e;
  for (const FrameMove& move : moves_) result = moved(result, move.AB);
  if (linear_) drop_second_order(result);
  return result;
}

bool PlacedMass::turned() const {
  return std::any_of(moves_.begin(), moves_.end(), [](const FrameMove& move) { return move.turns; });
}

Pose PlacedMass::placement() const {
  Pose all;
  for (const FrameMove& move : moves_) all = move.AB * all;
  return all;
}

PlacedMass PlacedMass::unmoved() const {
  PlacedMass own = *this;
  own.moves_.clear();
  return own;
}

void PlacedMass::move(const Pose& AB) {
  const bool turns = AB.R != Matrix3::Identity();
  if (turns || !AB.p.isZero(0)) moves_.push_back({AB, turns});
}

std::vector<Section> PlacedMass::sections() const {
  std::vector<Section> result;
  if (shape_ == nullptr) return result;
  result.reserve(shape_->sections.size());
  for (const Section& s : shape_->sections) {
    Matrix3 inertia = s.inertia;
    for (const auto& [AB, turns] : moves_) inertia = Matrix3(AB.R * inertia * AB.R.transpose());
    result.push_back({inertia, placed(s.at)});
  }
  return result;
}

std::string PlacedMass::identity() const {
  std::string bytes;
  if (shape_ == nullptr) return bytes;
  const auto append = [&](const void* from, std::size_t size) { bytes.append(static_cast<const char*>(from), size); };
  const auto shape = reinterpret_cast<std::uintptr_t>(shape_.get());
  append(&shape, sizeof shape);
  append(&linear_, sizeof linear_);
  for (const auto& [AB, turns] : moves_) {
    append(AB.R.data(), 9 * sizeof(double));
    append(AB.p.data(), 3 * sizeof(double));
  }
  return bytes;
}

}  // namespace withy
