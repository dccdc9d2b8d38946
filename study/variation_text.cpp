#include "withy/study/variation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {
constexpr std::size_t most_values = 100000;

/// As fifteen digits have it: 220, and not the 219.99999999999997 that steps leave.
double of_fifteen_digits(double value) { return to_digits(value, 15); }

/// "15 rpm" or "15rpm", as in scenes: a number, and the unit after it.
struct RangeEnd {
  std::optional<double> number;
  std::string unit;
};
RangeEnd read_end(const std::string& text) {
  const auto without_blanks = [](std::string_view part) {
    const std::size_t first = part.find_first_not_of(" \t"), last = part.find_last_not_of(" \t");
    return first == std::string_view::npos ? std::string_view() : part.substr(first, last - first + 1);
  };
  const std::string_view all = without_blanks(text);
  // The longest number that it begins with: "1e3 m" is no "1 e3 m".
  for (std::size_t length = all.size(); length > 0; --length) {
    const auto number = plain_number(all.substr(0, length));
    if (!number) continue;
    const std::string_view unit = without_blanks(all.substr(length));
    const bool digits = !unit.empty() && std::string_view("0123456789.,:+-").find(unit[0]) != std::string_view::npos;
    if (digits) return {};
    return {number, std::string(unit)};
  }
  return {};
}
}  // namespace

std::string label_of(const std::string& path) { return path.substr(path.find_last_of('.') + 1); }

Variation parse_variation(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw OptionError("over", "got '" + text + "'; need PATH=VALUE,VALUE,...");
  Variation v{text.substr(0, equals), {}};
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    v.values.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return v;
}

Sweep parse_sweep(const std::string& text, const std::string& option, std::optional<std::size_t> count) {
  if (text.empty()) return {};
  const auto bad = [&](const std::string& why) {
    return OptionError(option, "got '" + text + "'; " + why + "need PATH=FROM:TO" + (count ? "[:COUNT]" : ":COUNT") +
                                   ", as spin.axle=0:12:49 or gravity.0=0:-9:31");
  };
  const std::size_t equals = text.find('=');
  const std::size_t first = text.find(':', equals == std::string::npos ? 0 : equals);
  if (equals == 0 || equals == std::string::npos || first == std::string::npos) throw bad("");
  const std::size_t second = text.find(':', first + 1);
  if (second == std::string::npos && !count) throw bad("");
  const std::size_t end = std::min(second, text.size());
  const RangeEnd from_end = read_end(text.substr(equals + 1, first - equals - 1)),
                 to_end = read_end(text.substr(first + 1, end - first - 1));
  const auto from = from_end.number, to = to_end.number;
  if (!from || !to) throw bad("the ends of the range are numbers, with a unit or in SI units; ");
  if (!from_end.unit.empty() && !to_end.unit.empty() && from_end.unit != to_end.unit)
    throw bad("its ends have different units; ");
  if (count && !(from_end.unit.empty() && to_end.unit.empty()))
    throw bad("the ends of this range are plain numbers in SI units; ");
  if (second != std::string::npos) {
    const auto given = plain_number(std::string_view(text).substr(second + 1));
    if (!given || *given != std::floor(*given) || *given < 2 || *given > most_values)
      throw bad(fmt::format("the count is a whole number from 2 to {}; ", most_values));
    count = static_cast<std::size_t>(*given);
  }
  Sweep sweep{text.substr(0, equals), {}, from_end.unit.empty() ? to_end.unit : from_end.unit};
  for (std::size_t k = 0; k < *count; ++k) {
    const double r = static_cast<double>(k) / static_cast<double>(*count - 1);
    sweep.values.push_back(k + 1 == *count ? *to : of_fifteen_digits(*from + r * (*to - *from)));
  }
  return sweep;
}

}  // namespace withy::study
