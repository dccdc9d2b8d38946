#include "withy/scene/units.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "withy/scene/names.hpp"

namespace withy {
namespace {

struct NamedUnit {
  std::string_view name;
  Unit unit;
  bool prefixes;  ///< takes SI prefixes
};

constexpr double pi = std::numbers::pi;
constexpr double inch = 0.0254;                  // m, exact (international yard and pound agreement, 1959)
constexpr double pound = 0.45359237;             // kg, exact (same)
constexpr double pound_force = 4.4482216152605;  // N, exact: pound × 9.80665 m/s²

constexpr NamedUnit units[] = {
    {"1", {1, 1, {0, 0, 0, 0}}, false},
    {"%", {1, 100, {0, 0, 0, 0}}, false},
    {"percent", {1, 100, {0, 0, 0, 0}}, false},
    {"m", {1, 1, {1, 0, 0, 0}}, true},
    {"in", {inch, 1, {1, 0, 0, 0}}, false},
    {"ft", {12 * inch, 1, {1, 0, 0, 0}}, false},
    {"g", {1, 1000, {0, 1, 0, 0}}, true},
    {"t", {1000, 1, {0, 1, 0, 0}}, false},
    {"lb", {pound, 1, {0, 1, 0, 0}}, false},
    {"s", {1, 1, {0, 0, 1, 0}}, true},
    {"min", {60, 1, {0, 0, 1, 0}}, false},
    {"h", {3600, 1, {0, 0, 1, 0}}, false},
    {"rad", {1, 1, {0, 0, 0, 1}}, true},
    {"deg", {pi, 180, {0, 0, 0, 1}}, false},
    {"°", {pi, 180, {0, 0, 0, 1}}, false},
    {"rev", {2 * pi, 1, {0, 0, 0, 1}}, false},
    {"rpm", {pi, 30, {0, 0, -1, 1}}, false},
    {"Hz", {1, 1, {0, 0, -1, 0}}, true},
    {"N", {1, 1, {1, 1, -2, 0}}, true},
    {"lbf", {pound_force, 1, {1, 1, -2, 0}}, false},
    {"Nm", {1, 1, {2, 1, -2, 0}}, true},
    {"J", {1, 1, {2, 1, -2, 0}}, true},
    {"W", {1, 1, {2, 1, -3, 0}}, true},
    {"Pa", {1, 1, {-1, 1, -2, 0}}, true},
    {"psi", {pound_force, inch* inch, {-1, 1, -2, 0}}, false},
};

struct Prefix {
  std::string_view name;
  double multiply;
  double divide;
};

constexpr Prefix prefixes[] = {{"p", 1, 1e12}, {"n", 1, 1e9}, {"u", 1, 1e6}, {"µ", 1, 1e6},
                               {"μ", 1, 1e6},  {"m", 1, 1e3}, {"c", 1, 1e2}, {"d", 1, 10},
                               {"k", 1e3, 1},  {"M", 1e6, 1}, {"G", 1e9, 1}};

std::optional<Unit> find_unit(std::string_view name) {
  for (const NamedUnit& u : units) {
    if (u.name == name) return u.unit;
  }
  for (const Prefix& p : prefixes) {
    if (!name.starts_with(p.name)) continue;
    for (const NamedUnit& u : units) {
      if (!u.prefixes || u.name != name.substr(p.name.size())) continue;
      Unit unit = u.unit;
      // Grams are thousandths of the SI unit: cancel, so that "kg" is exactly 1.
      unit.multiply *= p.multiply;
      unit.divide *= p.divide;
      if (unit.multiply == unit.divide) unit.multiply = unit.divide = 1;
      return unit;
    }
  }
  return {};
}

std::string nearest_unit(std::string_view name) {
  std::vector<std::string> names;
  for (const NamedUnit& u : units) {
    if (u.name == "1") continue;
    names.emplace_back(u.name);
    if (!u.prefixes) continue;
    for (const std::string_view p : {"m", "c", "k", "M", "G"}) names.push_back(std::string(p) + std::string(u.name));
  }
  return nearest(name, names);
}

/// A recursive-descent reader of
///   product  = factor { [ '*' | '·' ] factor } { '/' factor }
///   factor   = ( name | '1' | '(' product ')' ) [ '^' integer | superscript ]
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : rest_(text) {}

  UnitReading read() {
    const Unit unit = product(0);
    if (problem_.empty() && !rest_.empty()) fail(fmt::format("'{}' is out of place", rest_));
    if (!problem_.empty()) return {{}, problem_};
    return {unit, {}};
  }

 private:
  void fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
    rest_ = {};
  }

  bool take(std::string_view token) {
    while (rest_.starts_with(' ')) rest_.remove_prefix(1);
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  Unit product(int depth) {
    Unit unit = factor(depth);
    bool divided = false;
    for (;;) {
      take("");  // skips blanks
      if (rest_.empty() || rest_.starts_with(')')) return unit;
      if (take("/")) {
        apply(unit, factor(depth), -1);
        divided = true;
        continue;
      }
      if (!take("*")) take("·");
      if (divided) {
        fail("a product after '/' can be read in two ways; write 'kg/m/s' or 'kg/(m s)'");
        return unit;
      }
      apply(unit, factor(depth), 1);
    }
  }

  Unit factor(int depth) {
    Unit base;
    if (take("(")) {
      if (depth > 4) {
        fail("too many parentheses");
        return {};
      }
      base = product(depth + 1);
      if (!take(")")) fail("')' is missing");
    } else {
      base = named_unit();
    }
    const int power = exponent();
    Unit unit;
    apply(unit, base, power);
    return unit;
  }

  Unit named_unit() {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_'; };
    std::size_t n = 0;
    while (n < rest_.size()) {
      if (letter(rest_[n])) {
        ++n;
      } else if (rest_.substr(n).starts_with("µ") || rest_.substr(n).starts_with("μ") ||
                 rest_.substr(n).starts_with("°")) {
        n += 2;  // two bytes in UTF-8
      } else {
        break;
      }
    }
    if (n == 0 && rest_.starts_with('1')) n = 1;
    if (n == 0) {
      fail(rest_.empty()            ? "a unit is missing"
           : rest_.starts_with(',') ? "decimals stand behind a point, not a comma"
                                    : fmt::format("'{}' is no unit", rest_));
      return {};
    }
    const std::string_view name = rest_.substr(0, n);
    rest_.remove_prefix(n);
    const std::optional<Unit> unit = find_unit(name);
    if (unit) return *unit;
    const std::string guess = nearest_unit(name);
    fail(fmt::format("unknown unit '{}'{}", name, guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess)));
    return {};
  }

  int exponent() {
    if (rest_.starts_with("²")) return rest_.remove_prefix(2), 2;
    if (rest_.starts_with("³")) return rest_.remove_prefix(2), 3;
    if (!rest_.starts_with('^')) return 1;
    rest_.remove_prefix(1);
    int power = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), power);
    if (error != std::errc() || power == 0 || std::abs(power) > 9) {
      fail("powers are whole numbers from -9 to 9");
      return 1;
    }
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return power;
  }

  static void apply(Unit& unit, const Unit& factor, int power) {
    const double up = std::pow(power > 0 ? factor.multiply : factor.divide, std::abs(power));
    const double down = std::pow(power > 0 ? factor.divide : factor.multiply, std::abs(power));
    unit.multiply *= up;
    unit.divide *= down;
    for (std::size_t i = 0; i < unit.dimension.size(); ++i) unit.dimension[i] += power * factor.dimension[i];
  }

  std::string_view rest_;
  std::string problem_;
};

/// Length of the decimal number at the beginning of a text, 0 where there is none, with its value.
std::size_t leading_number(std::string_view text, double& value) {
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const std::string_view digits = text.substr(sign);
  const auto digit = [&](std::size_t i) { return i < digits.size() && digits[i] >= '0' && digits[i] <= '9'; };
  if (!digit(0) && !(digits.starts_with('.') && digit(1))) return 0;
  if (digits[0] == '0' && digit(1)) return 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc()) return 0;
  if (text[0] == '-') value = -value;
  return static_cast<std::size_t>(end - text.data());
}

}  // namespace

std::string unit_at_hinge(std::string_view unit, bool slides) {
  const std::size_t bar = unit.find('|');
  if (bar == std::string_view::npos) return std::string(unit);
  return std::string(slides ? unit.substr(bar + 1) : unit.substr(0, bar));
}

UnitReading read_unit(std::string_view text) { return UnitParser(text).read(); }

bool looks_like_number(std::string_view text) {
  const std::size_t start = text.find_first_not_of("+-.");
  return start != std::string_view::npos && start <= 2 && text[start] >= '0' && text[start] <= '9';
}

std::optional<double> plain_number(std::string_view text) {
  double value = 0;
  if (text.empty() || leading_number(text, value) != text.size()) return {};
  return value;
}

double to_digits(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

namespace {

/// Spaces that do not break, as text that is copied from pages has them between a number and its unit.
std::string with_plain_spaces(std::string_view text) {
  std::string plain(text);
  for (const std::string_view space : {"\u00a0", "\u202f", "\u2009"})
    for (std::size_t at = plain.find(space); at != std::string::npos; at = plain.find(space, at + 1))
      plain.replace(at, space.size(), " ");
  return plain;
}

/// A number with its unit, or why the text is none.
struct Written {
  double number = 0;
  std::optional<Unit> unit;
  std::string unit_text, problem;
};

Written read_written(std::string_view given) {
  const std::string plain = with_plain_spaces(given);
  const std::string_view text = plain;
  Written read;
  const std::size_t length = leading_number(text, read.number);
  if (length == 0) {
    if (looks_like_number(text))
      read.problem = "numbers are decimal, without leading zeros, ':' or '_', and within the range of doubles";
    return read;
  }
  std::string_view rest = text.substr(length);
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  if (rest.empty()) {
    read.problem = "a number in quotes is text; write it without quotes or with its unit";
    return read;
  }
  UnitReading unit = read_unit(rest);
  read.unit = unit.unit;
  read.unit_text = rest;
  read.problem = std::move(unit.problem);
  return read;
}

}  // namespace

AnyQuantity read_any_quantity(std::string_view given) {
  Written read = read_written(given);
  if (!read.unit) return {{}, {}, std::move(read.problem)};
  return {read.unit->to_si(read.number), read.unit->dimension, {}};
}

QuantityReading read_quantity(std::string_view given, std::string_view wanted) {
  Written read = read_written(given);
  if (!read.unit) return {{}, std::move(read.problem)};
  const UnitReading expected = read_unit(wanted.empty() ? "1" : wanted);
  if (!expected.unit) return {{}, fmt::format("units are not known here: write a number in {}", wanted)};
  if (read.unit->dimension == expected.unit->dimension) return {read.unit->to(*expected.unit, read.number), {}};
  return {{}, fmt::format("'{}' is a wrong unit here", read.unit_text)};
}

}  // namespace withy
