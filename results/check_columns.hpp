/// \file
/// Whether names are those of columns of a run.
#pragma once

#include <string>
#include <vector>

namespace withy::study {
struct Prepared;
}

namespace withy {

/// Checks names of columns of results.csv, or of several by what stands before a dot. \throws study::OptionError with
/// the nearest name of each that is no such column.
void check_columns(const study::Prepared& prepared, const std::vector<std::string>& names);

}  // namespace withy
