/// \file
/// Whether driven hinges keep to the laws of their motions.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// Distances of driven coordinates from their laws. Integrators follow the accelerations of a law at the instants that
/// they ask for: what it does between two of them, in a pulse or at a kink that it does not tell of, they do not see.
class MotionGap {
 public:
  explicit MotionGap(const Model& model);
  /// An accepted step or an output. Does not allocate.
  void look(const State& state) noexcept;
  void remember(Memory& memory);
  /// A sentence on a law that had no finite coordinate, or else on the hinge that is farthest from its law, against the
  /// range that the law has gone over where it was looked at; empty where each has kept to it within a hundredth.
  [[nodiscard]] std::string text() const;
  /// Tells the summary of a law that had no finite coordinate.
  void tell(RunSummary& summary) const;

 private:
  struct Driven {
    const MotionNode* motion;
    std::size_t position;  ///< index in State::y
    double least, most;    ///< of the law [rad, m]
    double gap, time;      ///< the greatest, and when [s]; infinite where the law was no number
  };
  /// The first whose law had no finite coordinate; null: none.
  [[nodiscard]] const Driven* lost() const;
  [[nodiscard]] const HingeNode& hinge_of(const Driven& driven) const {
    return model_.hinges()[static_cast<std::size_t>(driven.motion->hinge)];
  }

  const Model& model_;
  std::vector<Driven> driven_;
};

}  // namespace withy
