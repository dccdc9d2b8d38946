/// \file
/// Lists of values in CSV files.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/campaign/trials.hpp"

namespace withy::campaign {

struct ListColumn {
  Levels levels;
  std::string sha256;  ///< of the file
};

/// The column of that name in the head. A file of one column is taken whatever its head says, unless `named`; a head
/// that is a number or a quantity is its first value. \throws InputError where there is no such file or column, or a
/// cell is empty.
ListColumn read_list_column(const std::string& file, const std::string& column, bool named);

/// The rows of lists that bring other names than the rows before them, each with the values of all columns of its file,
/// but for the first row: names may be those of files and of plugins, on which the cases' bits depend. Quantities are
/// no names.
/// \param grids of the files: indices in Plan::grids
std::vector<TrialRow> rows_of_names(const std::vector<Axis>& axes, const std::map<std::string, std::size_t>& grids);

}  // namespace withy::campaign
