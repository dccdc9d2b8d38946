/// \file
/// The numbers that a result table shows of a state, with their names and units.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/tips.hpp"

namespace [[gnu::visibility("default")]] withy {

/// What `results.csv` holds: time, hinge and modal coordinates and their rates, deflections and world positions of the
/// tips, energies, work and momenta.
class ResultColumns {
 public:
  /// Both must outlive the object.
  ResultColumns(const Model& model, const EquationsOfMotion& equations);
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// As many numbers as there are columns.
  [[nodiscard]] std::vector<double> row(const State& state) const;

 private:
  const Model& model_;
  const EquationsOfMotion& equations_;
  std::vector<Tip> tips_;
  std::vector<Column> columns_;
};

}  // namespace gnu::visibility("default")]]withy
