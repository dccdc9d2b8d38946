/// \file
/// What messages say.
#pragma once

#include <cmath>
#include <regex>
#include <string>

namespace withy::test {

/// The number that follows some words of a message; NaN where they are not there.
inline double number_after(const std::string& message, const std::string& words) {
  std::smatch found;
  return std::regex_search(message, found, std::regex(words + "([0-9.e+-]+[0-9])")) ? std::stod(found[1]) : NAN;
}

}  // namespace withy::test
