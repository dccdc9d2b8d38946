/// \file
/// From generalized speeds to the rates of positions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy::equations {

/// ẋ = N(x) u: for most coordinates a copy; hinges with quaternions have a map of their own.
class RateMap {
 public:
  /// Coordinates whose derivatives are their speeds, in State's order.
  struct Run {
    std::size_t position, speed, count;
    friend bool operator==(const Run&, const Run&) = default;
  };
  /// The model must outlive the map.
  explicit RateMap(const Model& model);
  /// Sets the first elements of `rates`, one a position.
  void set(std::span<const double> positions, std::span<const double> speeds, std::span<double> rates) const noexcept;
  /// Those that are copied; with `only_copies` all.
  [[nodiscard]] const std::vector<Run>& copies() const { return copies_; }
  [[nodiscard]] bool only_copies() const { return general_.empty() && constrained_.empty(); }
  /// Scales quaternions among the positions back to unit length.
  void normalize(std::span<double> positions) const noexcept;

 private:
  const Model& model_;
  std::vector<Run> copies_;
  std::vector<std::size_t> general_;      ///< hinges with derivatives of their own
  std::vector<std::size_t> constrained_;  ///< hinges with more coordinates than speeds
};

inline void RateMap::set(std::span<const double> positions, std::span<const double> speeds,
                         std::span<double> rates) const noexcept {
  for (const Run& run : copies_) {
    for (std::size_t i = 0; i < run.count; ++i) rates[run.position + i] = speeds[run.speed + i];
  }
  for (const std::size_t h : general_) {
    const Slot& slot = model_.layout().hinges[h];
    model_.hinges()[h].hinge->derivatives(positions.subspan(slot.position, slot.positions),
                                          speeds.subspan(slot.speed, slot.speeds),
                                          rates.subspan(slot.position, slot.positions));
  }
}

}  // namespace withy::equations
