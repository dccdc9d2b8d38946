/// \file
/// Formulas of named numbers.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace withy {

/// A formula such as "norm(tip.vx, tip.vy) / 2", read once and evaluated often. It has + − * / ^ with the usual
/// precedence, parentheses, numbers, `pi`, names, and functions: sqrt, abs, sin, cos, tan, atan, exp, log of one
/// number, atan2 of two, min, max and norm (√Σx²) of any.
class Formula {
 public:
  /// \throws std::invalid_argument with what is wrong, and at which character.
  explicit Formula(std::string_view text);
  /// Each name once.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// \param values of the names, in their order
  [[nodiscard]] double operator()(std::span<const double> values) const noexcept;
  /// The value of a formula of at most one name at x, with its first and second derivative by it, exact; of abs,
  /// min and max those of one side at a kink, of sqrt and norm none (not a number) at zero.
  [[nodiscard]] std::array<double, 3> with_derivatives(double x) const noexcept;
  /// The greatest parts of the formula that have this name and no other: of "max(0, x) * exp(-t ^ 2) + t" by "t" those
  /// are "exp(-t ^ 2)" and "t". Of a formula that has no other name it is the formula.
  [[nodiscard]] std::vector<Formula> parts_of(std::string_view name) const;

  static constexpr std::size_t most_pending = 64;  ///< numbers that wait for an operation
  static constexpr std::size_t most_names = 64;

 private:
  Formula() = default;

  friend class FormulaReader;
  enum class Operation { number, name, negate, add, subtract, multiply, divide, power, function };
  struct Step {
    Operation operation = Operation::number;
    double number = 0;
    std::size_t index = 0;  ///< of a name or a function
    std::size_t count = 0;  ///< arguments of a function
  };
  std::vector<Step> steps_;  ///< in postfix order
  std::vector<std::string> names_;
};

}  // namespace withy
