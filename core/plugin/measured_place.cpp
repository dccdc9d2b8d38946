#include "withy/core/plugin/measured_place.hpp"

#include <cmath>
#include <limits>

namespace withy {
namespace {

/// How far a place gives. One that is none, of another number of modes or without numbers, gives more than all: it
/// becomes a frame, and the model that is built of it says what is wrong there.
double compliance_at(const ModalShape& shape, const PointExpansion& at) {
  const double compliance = at.phi.cols() == shape.modes() ? shape.compliance(at) : std::nan("");
  return std::isfinite(compliance) ? compliance : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string MeasuredPlace::in_words() const {
  if (name == "tip") return "the tip";
  if (name.starts_with("at_")) return "the section at " + name.substr(3) + " % of the length";
  return "station '" + name + "'";
}

std::optional<MeasuredPlace> measured_place(const Body& body) {
  // A tip gives most of all where it is free: a place that gives this much more is where the body bends.
  constexpr double much_more = 4;
  constexpr int parts = 20, percent = 5;
  const ModalShape& shape = body.shape();
  const std::string name = body.measured_station();
  std::optional<PointExpansion> station = name.empty() ? std::nullopt : body.station(name);
  std::optional<MeasuredPlace> most;
  if (station) most = {name, *std::move(station)};
  double greatest = most ? much_more * compliance_at(shape, most->at) : 0;
  for (int k = 1; k < parts && shape.modes() > 0; ++k) {
    std::optional<PointExpansion> at = body.station(shape.length * k / parts);
    if (!at) break;  // it has none along itself
    const double here = compliance_at(shape, *at);
    if (here <= greatest) continue;
    greatest = here;
    most = {"at_" + std::to_string(percent * k), *std::move(at)};
  }
  return most;
}

std::vector<MeasuredPlace> measured_places(const Body& body) {
  std::vector<MeasuredPlace> all;
  if (auto place = measured_place(body)) all.push_back(*std::move(place));
  for (const std::string& name : body.measured_beside())
    if (auto at = body.station(name)) all.push_back({name, *std::move(at)});
  return all;
}

}  // namespace withy
