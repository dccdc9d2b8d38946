/// \file
/// Pictures of the tables of runs.
#pragma once

#include <string>
#include <vector>

#include "withy/results/report/decimated_table.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy {

/// A run's table under the name that a legend has for it.
struct NamedTable {
  std::string name;
  const DecimatedTable* table;
};

/// The coordinates of hinges and the deflections of tips that change in a run, or whatever changes where none of these
/// does.
std::vector<Column> telling_columns(const std::vector<NamedTable>& runs);

/// A panel a column over time, a curve a run in each that has the column; angles in degrees. Columns of one name in
/// several units have a panel each.
/// \param names of columns, or what stands before a dot in them: "link1.tip" is all of that tip; empty: the first
/// eight of telling_columns(). A column that several of the names mean is drawn once, where the first of them has it.
/// \throws ResultsError where no run has such a column: it names the nearest
std::vector<Panel> table_panels(const std::vector<NamedTable>& runs, const std::vector<std::string>& names);

/// The least and the greatest that each of the columns has in a run, over the place [m] that it is given: an envelope,
/// as of the inner moments along a beam. Two curves a run, in one pen; angles in degrees.
/// \param columns one a place, places increasing
/// \throws ResultsError where no run has a column, or they have not one unit
Panel envelope_panel(const std::vector<NamedTable>& runs, const std::vector<std::string>& columns,
                     const std::vector<double>& places);

}  // namespace withy
