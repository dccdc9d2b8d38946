/// \file
/// The numbers that a result table shows of a state, with their names and units.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/prepared.hpp"

namespace withy {

/// Whether the results of two models have the same columns, in the same places. Where hinges have no kernel it says no.
bool same_columns(const Model& a, const std::vector<SensorNode>& sensors_of_a, const Model& b,
                  const std::vector<SensorNode>& sensors_of_b);

/// What `results.csv` holds: time, hinge and modal coordinates and their rates, deflections and world positions of the
/// tips, energies, work and momenta; then what the scene's sensors give.
class ResultColumns {
 public:
  /// Model and equations must outlive the object. The sensors are bound to this model.
  ResultColumns(const Model& model, const EquationsOfMotion& equations, const std::vector<SensorNode>& sensors = {});
  [[nodiscard]] const std::vector<Column>& columns() const { return named().columns; }
  /// The axes that each is told in, as `world`; empty where that has no meaning.
  [[nodiscard]] const std::vector<std::string>& frames() const { return named().frames; }
  /// As many numbers as there are columns, until the next row. Those of sensors are NaN, as which tables have an empty
  /// cell, where the state has no finite accelerations. Allocates nothing.
  const std::vector<double>& row(const State& state);
  /// The same where `seen()` is at that state already.
  const std::vector<double>& row_of_seen(const State& state);
  /// For RunOptions::seen: a row then costs no pass of its own.
  [[nodiscard]] Observation& seen() { return *seen_; }
  /// Rows so far in which a sensor has given no finite number though the state has accelerations; one a column of the
  /// sensors, the last ones of `columns()`.
  [[nodiscard]] const std::vector<std::size_t>& nonfinite() const { return nonfinite_; }

 private:
  /// What the columns are called; found when it is asked for, since many ask for rows alone.
  struct Names {
    std::vector<Column> columns;
    std::vector<std::string> frames;
  };
  const Names& named() const;
  void append(const State& state, std::size_t first, std::size_t count);
  void append(const std::array<double, 3>& vector);
  void append_motion_efforts(const State& state);
  void append_sensors(const State& state);

  const Model& model_;
  const EquationsOfMotion& equations_;
  std::vector<Tip> tips_;
  mutable Names names_;
  std::unique_ptr<Observation> seen_;
  SensorReader sensors_;
  Work work_;  ///< for the efforts of motions
  std::vector<double> efforts_, row_;
  std::vector<std::size_t> nonfinite_;
};

/// Of a scene: one for its equations, or for each rung where its formulation is `auto`. `prepared` must outlive them.
std::vector<ResultColumns> columns_of_rungs(const study::Prepared& prepared);

/// The state that a row tells of: time, coordinates and rates; discrete states and work are zero.
State state_of_row(const Layout& layout, std::span<const double> row);

}  // namespace withy
