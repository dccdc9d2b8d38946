/// \file
/// Units of measure in scenes: strings such as "25 mm" or "3 N m^2" become SI numbers.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace withy {

/// Exponents of metre, kilogram, second and radian. Angle counts as a dimension of its own: degrees are never taken for
/// a ratio, nor hertz for rad/s.
using Dimension = std::array<int, 4>;

/// A unit: one of it is `multiply / divide` SI units. Two numbers, so that "25 mm" is 25/1000, rounded once.
struct Unit {
  double multiply = 1;
  double divide = 1;
  Dimension dimension{};

  [[nodiscard]] double to_si(double x) const { return x * multiply / divide; }
  /// A number of this unit in another of the same dimension; exact where both are one.
  [[nodiscard]] double to(const Unit& other, double x) const {
    if (multiply == other.multiply && divide == other.divide) return x;
    return other.multiply == other.divide ? to_si(x) : to_si(x) * other.divide / other.multiply;
  }
};

/// A unit, or in `problem` why the text is none (with the nearest unit that is known).
struct UnitReading {
  std::optional<Unit> unit;
  std::string problem;
};

/// Reads products, quotients and integer powers of named units: "N m^2", "kg/m", "m/s^2", "kg/(m s)", "1/s".
/// Factors are separated by a space, `*` or `·`; SI prefixes p … G go before SI units.
UnitReading read_unit(std::string_view text);

/// A number in the unit that was asked for, or why the text is none.
struct QuantityReading {
  std::optional<double> value;
  std::string problem;
};

/// Reads a number and its unit, which must have the dimension of `unit` (as "N m^2"; "1" or "": a ratio), as a number
/// in that: the SI number where `unit` is of SI, and 30 for "0.5236 rad" where a signal is in "deg".
QuantityReading read_quantity(std::string_view text, std::string_view unit);

/// A number with a unit of any kind, in SI units.
struct AnyQuantity {
  std::optional<double> value;
  Dimension dimension{};
  std::string problem;
};
AnyQuantity read_any_quantity(std::string_view text);

/// The unit of a parameter whose own is `unit`: of "rad|m" the first part where a hinge turns, the second where it
/// slides; any other is for both.
std::string unit_at_hinge(std::string_view unit, bool slides);
/// Of a parameter whose unit depends on what it is compared with: a number with a unit of any kind.
constexpr std::string_view any_unit = "any";

/// True where the text begins as a number does, so that it is meant as a quantity and not as a name.
bool looks_like_number(std::string_view text);

/// The plain decimal number that the whole text is: an optional sign, digits without leading zeros, fraction, exponent.
/// Nothing for all else, such as `010`, `1:30`, `0x1f`, `1_000`, or a number out of the range of doubles.
std::optional<double> plain_number(std::string_view text);

/// A number as so many significant digits have it, which people read and type.
double to_digits(double value, int digits);

}  // namespace withy
