/// \file
/// Whether a steady state is stable: what small motions about it do.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "withy/study/modes.hpp"

namespace withy::study {

struct Stability {
  std::size_t growing = 0;  ///< count of modes that grow
  double growth = 0;        ///< [1/s] of the fastest of these
  std::string most;         ///< the coordinate that dominates it, as "elbow.0"
  bool vibrates = false;    ///< it does: flutter; else it goes away without
  std::size_t unheld = 0;   ///< count of rigid motions, which nothing holds
  /// Why it is not known, a clause; empty where it is.
  std::string unknown;
  [[nodiscard]] bool stable() const { return unknown.empty() && growing == 0; }
};

/// By the modes about the configuration's state. \returns nothing where nothing is free to move
std::optional<Stability> stability_of(const Configuration& steady);

/// In a sentence or two; empty where there is nothing to say.
std::string stability_text(const std::optional<Stability>& stability);

}  // namespace withy::study
