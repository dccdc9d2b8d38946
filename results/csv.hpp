/// \file
/// Tables as text: comma-separated values.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"

namespace withy {

/// One line of a CSV file, its end included: shortest numbers that read back the same; nothing where one is not finite.
std::string csv_line(std::span<const double> numbers);
/// The head of a CSV file: `name[unit],…`.
std::string csv_head(const std::vector<Column>& columns);

}  // namespace withy
