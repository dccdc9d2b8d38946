/// \file
/// Several runs of one scene, seen together: how far they are apart, and a picture of them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"

namespace withy::study {

/// One run of a comparison, with every output it gave.
struct ComparedRun {
  std::unique_ptr<Engine> engine;
  RunSummary summary;
  std::vector<State> outputs;
  [[nodiscard]] const std::string& formulation() const { return engine->scene().formulation_name; }
};

/// Greatest distances between two runs over the outputs both have.
struct Distances {
  /// Of each hinge that moves: difference of coordinates [rad, m]; of orientations the angle [rad] between them, of a
  /// free hinge the greater of that and the distance [m].
  std::map<std::string, double> hinges;
  std::map<std::string, double> tips;  ///< of each frame named "tip": distance in the world [m]
  double until = 0;                    ///< time [s] of the last output both have
  [[nodiscard]] double greatest_hinge() const;
  [[nodiscard]] double greatest_tip() const;
};
Distances distances(const ComparedRun& run, const ComparedRun& reference);

/// A state of a model.
struct Moment {
  const Model& model;
  const EquationsOfMotion& equations;
  const State& state;
};
/// Adds the distances at one time of models with the same hinges and tips, whatever their modes.
void add_distances(Distances& d, const Moment& a, const Moment& b);

/// Tip deflections and the coordinates of one-coordinate hinges over time, as SVG. The axes fit the runs that were
/// completed; one that diverged leaves the frame.
std::string picture(const std::string& title, const std::vector<const ComparedRun*>& runs);

}  // namespace withy::study
