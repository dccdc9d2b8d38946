/// \file
/// What a snapshot holds, and what tells of which scene and build it is.
#pragma once

#include <array>
#include <optional>

#include "withy/core/simulation/simulate.hpp"
#include "withy/host/simulation.hpp"
#include "withy/scene/scene.hpp"

namespace withy::host {

/// Of which scene and which build something is, in numbers below 2⁴⁸, which a list of doubles keeps.
struct SnapshotOrigin {
  std::array<double, 2> scene{};  ///< of all values and files that the steps to come depend on
  double build = 0;               ///< of the program and the scene's plugins

  /// \throws std::invalid_argument where `own`, that of the simulation that is to go on, is another
  void check_against(const SnapshotOrigin& own) const;
};

/// The origin of one scene, found at the first call: steps alone need none.
class OriginOnce {
 public:
  const SnapshotOrigin& operator()(const withy::Scene& scene);

 private:
  std::optional<SnapshotOrigin> found_;
};

struct Snapshot::Parts {
  Checkpoint checkpoint;
  SnapshotOrigin origin;
};

}  // namespace withy::host
