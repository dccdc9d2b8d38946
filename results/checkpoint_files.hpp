/// \file
/// Checkpoints of runs on disk: in the results folder, two generations, each with a checksum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "withy/core/simulation/simulate.hpp"

namespace [[gnu::visibility("default")]] withy {

/// A checkpoint of a run, with what belongs to it in its folder.
struct StoredRun {
  Checkpoint checkpoint;
  std::uintmax_t table_bytes = 0;  ///< length of results.csv then
  std::string remark = {};         ///< once read: why it is not the newest checkpoint, or empty
};

/// The checkpoints of one run, in a folder: `checkpoint.cbor`, and the one before as `checkpoint.previous.cbor`.
class CheckpointFiles {
 public:
  /// \param fingerprint of the run: checkpoints of another one are refused
  CheckpointFiles(std::filesystem::path folder, std::string fingerprint);
  /// Writes the next generation: whole or not at all, and lasting. \throws std::system_error
  void write(const StoredRun& run) const;
  /// The newest undamaged checkpoint. \throws ResultsError where there is none, or it is another run's.
  [[nodiscard]] StoredRun read() const;
  void remove() const;

 private:
  std::filesystem::path newest_, previous_;
  std::string run_;  ///< fingerprint
};

}  // namespace gnu::visibility("default")]]withy
