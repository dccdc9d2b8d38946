/// \file
/// Lists of values in CSV files.
#pragma once

#include <string>

#include "withy/campaign/plan.hpp"

namespace withy::campaign {

struct ListColumn {
  Levels levels;
  std::string sha256;  ///< of the file
};

/// The column of that name in the head. A file of one column is taken whatever its head says, unless `named`.
/// \throws InputError where there is no such file or column, or a cell is empty.
ListColumn read_list_column(const std::string& file, const std::string& column, bool named);

}  // namespace withy::campaign
