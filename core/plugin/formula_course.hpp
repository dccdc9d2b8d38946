/// \file
/// The course of a formula of the time and of other numbers (CourseOfTime).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "withy/core/plugin/formula.hpp"

namespace withy {

/// Count of courses of a formula: none without the name `t`.
inline std::size_t courses_of(const Formula& formula) {
  return std::find(formula.names().begin(), formula.names().end(), "t") != formula.names().end() ? 2 : 0;
}

/// Sets them, for other numbers that are neither zero nor one nor like one another, of either sign: what is multiplied
/// with them, with their difference or with a function of theirs is seen as well.
inline void course_of(const Formula& formula, double t, std::span<double> values) noexcept {
  const std::vector<std::string>& names = formula.names();
  for (std::size_t c = 0; c < 2; ++c) {
    std::array<double, Formula::most_names> named{};
    for (std::size_t i = 0; i < names.size(); ++i)
      named[i] = names[i] == "t" ? t : (c == 0 ? 1 : -1) * (1.618 + 0.271 * static_cast<double>(i));
    values[c] = formula(named);
  }
}

}  // namespace withy
