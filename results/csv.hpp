/// \file
/// Tables as text: comma-separated values.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/model/columns.hpp"

namespace withy {

/// One line of a CSV file, its end included: shortest numbers that read back the same; nothing where one is not finite.
std::string csv_line(std::span<const double> numbers);
/// The name of a column in tables, where brackets hold units alone and commas stand between cells:
/// `boom.bending_y.2.rate` for `boom.bending_y[2].rate`, `panel.(0.6;-0.2).x` for `panel.(0.6, -0.2).x`.
std::string column_name(const std::string& column);
/// A cell with any text: in quotes where it would be read as something else.
std::string csv_text(const std::string& text);
/// The head of a CSV file: `name.component[unit],…`, the unit `1` where there is none.
std::string csv_head(const std::vector<Column>& columns);
/// The columns of a head, without the end of its line. \throws std::invalid_argument where a name has no unit
std::vector<Column> read_csv_head(std::string_view line);
/// The numbers of a line, without its end; NaN where nothing stands. \throws std::invalid_argument where anything else
/// does
void read_csv_line(std::string_view line, std::vector<double>& numbers);

}  // namespace withy
