/// \file
/// Checkpoints of runs on disk: in the results folder, two generations, each with a checksum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "withy/apps/withy/engine.hpp"

namespace withy::app {

/// A run that was put down, with what belongs to it in its folder.
struct StoredRun {
  Checkpoint checkpoint;
  std::uintmax_t table_bytes = 0;  ///< length of results.csv then
};

/// The checkpoints of one run, in a folder: `checkpoint.cbor`, and the one before as `checkpoint.previous.cbor`.
class CheckpointFiles {
 public:
  /// A checkpoint belongs to the scene as checked, with formulation, integrator and overrides, and to this version.
  CheckpointFiles(std::filesystem::path folder, const Scene& scene);
  /// Writes the next generation: whole or not at all, and lasting. \throws std::system_error
  void write(const StoredRun& run) const;
  /// The newest undamaged checkpoint; where that is not the newest, standard error says what is wrong with the other.
  /// \throws InputError where there is none, or it is another run's.
  [[nodiscard]] StoredRun read() const;
  void remove() const;

 private:
  std::filesystem::path newest_, previous_;
  std::string run_;  ///< fingerprint
};

}  // namespace withy::app
