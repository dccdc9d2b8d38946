/// \file
/// Runs the cases of a plan that its store lacks.
#pragma once

#include "withy/campaign/store.hpp"

namespace withy::campaign {

struct SweepSettings {
  std::size_t jobs = 0;      ///< threads; 0: one a core
  std::uint64_t shard = 1;   ///< which part of the cases, from 1
  std::uint64_t shards = 1;  ///< of how many: case i belongs to shard i mod shards + 1
  study::Control control;
};

/// Sets the shard of a text: "2/8"; empty: all. \throws OptionError of `shard`
void read_shard(const std::string& text, SweepSettings& settings);

struct SweepOutcome {
  std::uint64_t cases = 0;    ///< of the shard
  std::uint64_t before = 0;   ///< of these, in the store already
  std::uint64_t ran = 0;      ///< now
  std::uint64_t failed = 0;   ///< of those that ran now
  std::uint64_t lost = 0;     ///< bytes of the store that belong to no record
  double seconds = 0;         ///< wall time
  std::uint64_t alone = 0;    ///< of those that ran now, evaluated one at a time; the others in lanes
  std::string alone_because;  ///< why the first of them that was met is
  /// The first that failed, if any did, in the order of the plan.
  std::optional<CaseResult> failure;
  [[nodiscard]] bool whole() const { return before + ran == cases; }
};

/// Each thread has a segment of its own; none waits for another. Results depend on plan and case alone, so that jobs,
/// shards, order and interruptions change nothing in a table.
/// \throws FolderBusy where another process runs the same shard; PluginError; std::system_error
SweepOutcome run_sweep(const Plan& plan, Registry& registry, const Store& store, const SweepSettings& settings);

}  // namespace withy::campaign
