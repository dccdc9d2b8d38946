#include "withy/study/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

constexpr double least_distance = 1e-9;  // of its unit; what outputs without a scale may move by
constexpr double least_effort = 1e-3;    // of the kinetic energy over a radian or the longest body

constexpr double least_range = 1e-7;      // of its unit, of what a sensor shows
constexpr double most_plain_share = 0.5;  // a number without % that is larger was meant in %

constexpr double beside_others = 1e-3;  // of the greatest range of the same sensor's numbers of the same unit

/// The greatest range among the numbers of an output's sensor that have its unit.
double greatest_beside(const Outputs& outputs, const Distances& ranges, std::size_t i) {
  double most = 0;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Output &o = outputs.list()[i], &other = outputs.list()[k];
    if (other.measure == Measure::sensor && other.group == o.group && other.unit == o.unit)
      most = std::max(most, ranges[k]);
  }
  return most;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Reads one part into the member that its unit tells.
void read_part(Accuracy& a, const std::string& part, const std::string& whole, const std::string& option) {
  std::optional<double> value = plain_number(part);
  std::optional<double>* kind = &a.share;
  if (!value) {
    value = read_quantity(part, "1").value;
    if (!value && (value = read_quantity(part, "m").value)) kind = &a.length;
    if (!value && (value = read_quantity(part, "rad").value)) kind = &a.angle;
  }
  if (!value)
    throw OptionError(option, "got '" + part + "'; need a share as 1%, a length as 2mm or an angle as 0.1deg");
  if (*kind) throw OptionError(option, "'" + whole + "' says the same twice");
  if (kind == &a.share && plain_number(part) && *value >= most_plain_share)
    throw OptionError(
        option,
        fmt::format("got '{0}', which without a unit is a share: an error of {1:.4g} % of each "
                    "output's own range; need {0}%{2}",
                    part, 100 * *value, *value > 1 ? "" : fmt::format(", or {:.4g}% if that is meant", 100 * *value)));
  if (!(*value > 0) || (kind == &a.share && *value > 1))
    throw OptionError(option, fmt::format("got '{}'; need above 0{}", part, kind == &a.share ? ", at most 1" : ""));
  *kind = value;
}

}  // namespace

Accuracy Accuracy::parse(const std::string& text, const std::string& option) {
  Accuracy a;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    read_part(a, trimmed(text.substr(begin, end - begin)), text, option);
    begin = end + 1;
  }
  return a;
}

Distances scales(const Outputs& outputs, const Distances& ranges, double energy) {
  Distances scales = ranges;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const Output& o = outputs.list()[i];
    double floor = o.floor;
    if (o.unit == "N m") floor = least_effort * energy;
    if (o.unit == "N" && outputs.length() > 0) floor = least_effort * energy / outputs.length();
    if (o.measure == Measure::sensor)
      floor = std::max({floor, least_range, beside_others * greatest_beside(outputs, ranges, i)});
    scales[i] = std::max(scales[i], floor);
  }
  return scales;
}

double relative_error(const Distances& distances, const Distances& scales) {
  double most = 0;
  for (std::size_t i = 0; i < scales.size(); ++i)
    if (scales[i] > 0) most = std::max(most, distances[i] / scales[i]);
  return most;
}

const char* floors_text() {
  return "a range below a thousandth of a radian, of the body's length (deflections), of the longest body (places, "
         "slides), or of the kinetic energy over a radian or that length (efforts) counts as that; of an output of the "
         "scene also one below a thousandth of its other components of that unit";
}

Distances Accuracy::limits(const Outputs& outputs, const Distances& scales) const {
  Distances limits(scales.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const std::string& unit = outputs.list()[i].unit;
    if (unit == "rad" && angle) limits[i] = *angle;
    if (unit == "m" && length) limits[i] = *length;
    if (share) limits[i] = std::min(limits[i], std::max(*share * scales[i], least_distance));
  }
  return limits;
}

void Accuracy::require_something_of(const Outputs& outputs) const {
  const auto any_in = [&](const char* unit) {
    return std::any_of(outputs.list().begin(), outputs.list().end(), [&](const Output& o) { return o.unit == unit; });
  };
  const bool lengths = any_in("m"), angles = any_in("rad");
  if (share || (length && lengths) || (angle && angles)) return;
  throw OptionError("accuracy", "'" + text() + "' asks nothing of the outputs, which are " +
                                    (lengths  ? "lengths"
                                     : angles ? "angles"
                                              : "neither lengths nor angles"));
}

Accuracy Accuracy::times(double factor) const {
  const auto more = [factor](const std::optional<double>& allowed, double unit) -> std::optional<double> {
    if (!allowed) return {};
    const double x = factor * *allowed / unit, step = std::pow(10, std::floor(std::log10(x)) - 1);
    return unit * step * std::ceil(x / step - least_distance);
  };
  Accuracy a{more(share, 0.01), more(angle, std::numbers::pi / 180), more(length, 1e-3)};
  if (a.share) a.share = std::min(*a.share, 1.0);
  return a;
}

std::string Accuracy::option() const {
  std::string option = text();
  std::erase(option, ' ');
  return option;
}

std::string Accuracy::text() const {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (share) add(fmt::format("{:.4g} %", 100 * *share));
  if (length) add(fmt::format("{:.4g} mm", 1e3 * *length));
  if (angle) add(fmt::format("{:.4g} deg", *angle * 180 / std::numbers::pi));
  return text;
}

std::vector<double> read_shares(const std::vector<std::string>& texts, const std::string& option) {
  std::vector<double> shares;
  for (const std::string& text : texts) {
    const Accuracy given = Accuracy::parse(text, option);
    if (!given.share || given.angle || given.length)
      throw InputError("--" + option + ": got '" + text + "'; need a relative error, as 1% or 0.01");
    shares.push_back(*given.share);
  }
  return shares;
}

}  // namespace withy::study
