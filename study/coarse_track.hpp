/// \file
/// The states that a coarse run goes through, and those between them.
#pragma once

#include <optional>
#include <vector>

#include "withy/core/plugin/equations.hpp"

namespace withy::study {

/// A coarse run has few steps and no interpolation of its own that is as exact as they are.
class CoarseTrack {
 public:
  /// \param equations of its states, which must outlive it
  explicit CoarseTrack(const EquationsOfMotion& equations) : equations_(equations) {}
  /// A state later than all before it.
  void keep(const State& state) { states_.push_back(state); }
  void clear() { states_.clear(); }
  /// On the cubic through the four states that are nearest, or through all where there are fewer; nothing before the
  /// first and after the last.
  [[nodiscard]] std::optional<State> at(double t) const;

 private:
  const EquationsOfMotion& equations_;
  std::vector<State> states_;
};

}  // namespace withy::study
