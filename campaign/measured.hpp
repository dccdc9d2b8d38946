/// \file
/// Measured data: times and results of a test, that runs are compared with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"

namespace withy::campaign {

/// A column of the data that is compared.
struct MeasuredColumn {
  std::string name;            ///< that of the result, as "tip.x"
  std::string unit;            ///< SI
  std::size_t result = 0;      ///< its index among the columns of results
  std::vector<double> values;  ///< one a time, SI; NaN where nothing was measured
  double deviation = 0;        ///< residuals are divided by it: as given, else the range of the values; SI
  bool deviation_given = false;

  /// Count of the values that there are.
  [[nodiscard]] std::size_t count() const;
  /// From the least of them to the greatest; below zero where there are none.
  [[nodiscard]] double range() const;
};

struct Measured {
  std::string file;
  std::vector<double> times;  ///< [s], increasing
  std::vector<MeasuredColumn> columns;
  std::vector<std::string> ignored;  ///< heads of columns that no result has the name of, or that were not asked for

  [[nodiscard]] std::size_t count() const;
};

/// By how much a time [s] of the data may lie before the scene's begin or after its end: decimals and units round.
double leeway(double time);

/// How data is to be read.
struct MeasuredWish {
  std::string file;
  /// Results that are compared: "tip.x", or "tip" for all of its components; empty: all that the data has.
  std::vector<std::string> outputs;
  std::vector<std::string> deviations;  ///< "tip.x=0.1 mm": standard deviations of the measurement; bare numbers are SI
  double from = 0;                      ///< time [s] of the initial state
  double end = 0;                       ///< time [s] at which the scene ends
  std::optional<std::string> text = {};  ///< of the file, which is then not read: its name stands for it in messages
};

/// Reads a CSV file with a head as `t[s],tip.x[mm],shoulder[deg]`: names of results in any unit that measures them, in
/// none where it is SI. An empty cell, or `nan`, is a value that was not measured.
/// \param problems gets what is wrong, each as "data.csv:3:7: …"
Measured read_measured(const MeasuredWish& wish, const std::vector<Column>& results,
                       std::vector<std::string>& problems);

}  // namespace withy::campaign
