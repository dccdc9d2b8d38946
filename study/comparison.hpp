/// \file
/// Several runs of one scene, seen together: how far they are apart.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withy/study/measures.hpp"
#include "withy/study/run.hpp"

namespace withy::study {

/// One run of a comparison, with every output it gave.
struct ComparedRun {
  Prepared prepared;
  RunSummary summary;
  std::vector<State> outputs;
  [[nodiscard]] const std::string& formulation() const { return prepared.scene.formulation_name; }
};

/// The runs of a scene in several formulations.
struct Comparison {
  std::vector<ComparedRun> runs;
  std::size_t listed = 0;     ///< runs beyond these were made for reference only
  std::size_t reference = 0;  ///< index; past the end where the user interrupted before it was run
  [[nodiscard]] bool interrupted() const { return runs.back().summary.status == RunStatus::interrupted; }
  [[nodiscard]] bool has_reference() const { return reference < runs.size(); }
  /// Whether a run and the reference have an output in common beyond the start, where all are alike.
  [[nodiscard]] bool has_distances(const ComparedRun& run) const;
  /// Greatest distances of a run from the reference, over the outputs both have. Those of a run without any say
  /// nothing.
  [[nodiscard]] NamedDistances distances(const ComparedRun& run) const;
  std::vector<std::string> outputs;  ///< names that distances are asked of; empty: everything but sensors
  /// An output asked for by name: how far a run is from the reference, and how far that moves while both run.
  struct OutputError {
    std::string label, unit;
    double distance = 0, range = 0;
  };
  /// Of each output named; none where none is.
  [[nodiscard]] std::vector<OutputError> output_errors(const ComparedRun& run) const;
};

/// Simulates a scene, every output handed on.
using Simulator = std::function<RunSummary(const Prepared&, const std::function<void(const State&)>& output)>;

/// Runs the formulations, and the reference where it is not among them.
/// \param outputs names of Comparison::outputs
/// \throws SceneError, InputError, PluginError
Comparison compare(const SceneValues& values, Registry& registry, const std::vector<std::string>& formulations,
                   const std::string& reference, const Simulator& simulator,
                   const std::vector<std::string>& outputs = {});

}  // namespace withy::study
