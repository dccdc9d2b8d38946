#include "withy/study/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

constexpr double least_distance = 1e-9;  // rad or m; what outputs that stand still may move by

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Reads one part into the member that its unit tells.
void read_part(Accuracy& a, const std::string& part, const std::string& whole) {
  std::optional<double> value = plain_number(part);
  std::optional<double>* kind = &a.share;
  if (!value) {
    value = read_quantity(part, "1").value;
    if (!value && (value = read_quantity(part, "m").value)) kind = &a.length;
    if (!value && (value = read_quantity(part, "rad").value)) kind = &a.angle;
  }
  if (!value)
    throw InputError("accuracy: got '" + part + "'; need a share as 1%, a length as 2mm or an angle as 0.1deg");
  if (*kind) throw InputError("accuracy: '" + whole + "' says the same twice");
  if (!(*value > 0) || (kind == &a.share && *value > 1))
    throw InputError(fmt::format("accuracy: got '{}'; need above 0{}", part, kind == &a.share ? ", at most 1" : ""));
  *kind = value;
}

}  // namespace

Accuracy Accuracy::parse(const std::string& text) {
  Accuracy a;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    read_part(a, trimmed(text.substr(begin, end - begin)), text);
    begin = end + 1;
  }
  return a;
}

Distances scales(const Outputs& outputs, const Distances& ways) {
  const PerMeasure greatest = outputs.per_measure(ways);
  Distances scales;
  for (const Output& o : outputs.list()) scales.push_back(greatest.at(static_cast<std::size_t>(o.measure)));
  return scales;
}

double relative_error(const Outputs& outputs, const Distances& distances, const Distances& ways) {
  const Distances scale = scales(outputs, ways);
  double most = 0;
  for (std::size_t i = 0; i < scale.size(); ++i)
    if (scale[i] > 0) most = std::max(most, distances[i] / scale[i]);
  return most;
}

Distances Accuracy::limits(const Outputs& outputs, const Distances& ways) const {
  const Distances scale = scales(outputs, ways);
  Distances limits(ways.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const std::optional<double>& distance = outputs.list()[i].measure == Measure::angle ? angle : length;
    if (distance) limits[i] = *distance;
    if (share) limits[i] = std::min(limits[i], std::max(*share * scale[i], least_distance));
  }
  return limits;
}

void Accuracy::require_something_of(const Outputs& outputs) const {
  const bool lengths = outputs.has(Measure::slide) || outputs.has(Measure::place) || outputs.has(Measure::deflection);
  if (share || (length && lengths) || (angle && outputs.has(Measure::angle))) return;
  throw InputError("accuracy: '" + text() + "' asks nothing of the outputs, which are " +
                   std::string(lengths ? "lengths" : "angles"));
}

std::string Accuracy::text() const {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (share) add(fmt::format("{:.4g} %", 100 * *share));
  if (length) add(fmt::format("{:.4g} mm", 1e3 * *length));
  if (angle) add(fmt::format("{:.4g} deg", *angle * 180 / std::numbers::pi));
  return text;
}

}  // namespace withy::study
