/// \file
/// The course of a formula of the time and of other numbers (CourseOfTime).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "withy/core/plugin/formula.hpp"

namespace withy {

/// What of a formula follows the time: its greatest parts that know of nothing else, whatever the other numbers do with
/// them; and, where there are others, the whole for two sets of them that are neither zero nor one nor like one
/// another, of either sign: what is a function of the time and of them at once.
class FormulaCourse {
 public:
  explicit FormulaCourse(Formula formula) : formula_(std::move(formula)), parts_(formula_.parts_of("t")) {
    mixed_ = !parts_.empty() && formula_.names().size() > 1 ? 2 : 0;
  }
  /// Of courses; none without the name `t`.
  [[nodiscard]] std::size_t count() const { return mixed_ + parts_.size(); }
  /// Sets them at t [s].
  void set(double t, std::span<double> values) const noexcept {
    const std::vector<std::string>& names = formula_.names();
    for (std::size_t c = 0; c < mixed_; ++c) {
      std::array<double, Formula::most_names> named{};
      for (std::size_t i = 0; i < names.size(); ++i)
        named[i] = names[i] == "t" ? t : (c == 0 ? 1 : -1) * (1.618 + 0.271 * static_cast<double>(i));
      values[c] = formula_(named);
    }
    for (std::size_t p = 0; p < parts_.size(); ++p) values[mixed_ + p] = parts_[p](std::span(&t, 1));
  }

 private:
  Formula formula_;
  std::vector<Formula> parts_;
  std::size_t mixed_ = 0;  ///< courses of the whole
};

}  // namespace withy
