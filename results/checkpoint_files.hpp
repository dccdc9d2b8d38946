/// \file
/// Checkpoints of runs on disk: in the results folder, two generations, each with a checksum.
#pragma once

#include <filesystem>
#include <string>

#include "withy/core/simulation/simulate.hpp"
#include "withy/results/recorder.hpp"

namespace withy {

/// A checkpoint of a run, with what belongs to it in its folder.
struct StoredRun {
  Checkpoint checkpoint;
  RecordMark table;         ///< how far results.csv was
  std::string remark = {};  ///< once read: why it is not the newest checkpoint, or empty
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
  /// Whether there is any.
  [[nodiscard]] bool exist() const;
  void remove() const;

 private:
  std::filesystem::path newest_, previous_;
  std::string run_;  ///< fingerprint
};

}  // namespace withy
