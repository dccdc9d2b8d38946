#include "withy/apps/withy/trade_frequencies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/analysis.hpp"

namespace withy::study {
namespace {

/// Share of a speed in Σ |δ_i|² M_ii.
double share(const Mode& mode, const Eigen::VectorXd& masses, Eigen::Index speed) {
  return std::norm(mode.shape[speed]) * masses[speed] / mode.shape.cwiseAbs2().dot(masses);
}

}  // namespace

FrequencyStudy::FrequencyStudy(const TradeArguments& arguments, const std::vector<TradePoint>& points, Sweep sweep)
    : arguments_(arguments), engine_(arguments), sweep_(std::move(sweep)), reference_(points.front()) {
  reference_.formulation = "exact";
  reference_.family.clear();
  for (const TradePoint& p : points) reference_.modes = std::max(reference_.modes, p.modes);
  ++reference_.modes;
  const double value = sweep_.values.at(1);
  try {
    static_cast<void>(reference(value));
  } catch (const InputError&) {
    reference_.formulation = "quadratic";
  }
  const Found& first = reference(value);
  for (const Mode& m : first.at.modes) {
    if (m.rigid || names_.size() == arguments.count) continue;
    const std::string name = dominating(first.at, m);
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
  }
  if (names_.empty()) throw InputError(arguments.scene + ": no mode vibrates; frequencies cannot be compared");
}

FrequencyStudy::Found FrequencyStudy::find(const TradePoint& point, double value) const {
  ConfigurationArguments a;
  static_cast<SceneArguments&>(a) = arguments_at(arguments_, engine_.scene(), point);
  a.lock = arguments_.lock;
  a.spin = arguments_.spin;
  const std::string spun = sweep_.spun();
  if (spun.empty()) a.options.overrides.push_back(fmt::format("{}={}", sweep_.path, value));
  Configuration c(a);
  if (!spun.empty()) c.spin(c.read_spin(fmt::format("{}={}", spun, value), "--over"));
  Found found;
  found.at.value = value;
  found.at.names = c.layout().speed_names;
  const SteadyState steady = find_steady_state(c.dynamics(), c.state(), c.held());
  found.at.problem = no_steady_state(c, steady);
  if (!steady.converged) return found;
  try {
    const Tangents tangents =
        c.dynamics().tangents(steady.state.time, steady.state.y, c.dynamics().steady_accelerations(steady.state.time));
    found.masses = tangents.mass.diagonal().cwiseAbs();
    found.at.modes = natural_modes(tangents, c.held());
  } catch (const std::domain_error& e) {
    found.at.problem = e.what();
  }
  return found;
}

std::optional<double> FrequencyStudy::frequency(const Found& found, const std::string& name) {
  const auto& names = found.at.names;
  const Eigen::Index speed = std::find(names.begin(), names.end(), name) - names.begin();
  const Mode* mode = nullptr;
  for (const Mode& m : found.at.modes) {
    if (mode == nullptr || share(m, found.masses, speed) > share(*mode, found.masses, speed)) mode = &m;
  }
  if (mode == nullptr || mode->rigid || unstable(found.at, *mode)) return std::nullopt;
  return mode->frequency();
}

const FrequencyStudy::Found& FrequencyStudy::reference(double value) {
  const auto known = references_.find(value);
  if (known != references_.end()) return known->second;
  return references_.emplace(value, find(reference_, value)).first->second;
}

double FrequencyStudy::reference_frequency(const std::string& name, double value) {
  const Found& found = reference(value);
  const auto frequency = FrequencyStudy::frequency(found, name);
  if (!frequency)
    throw InputError(fmt::format("the reference ({}, {} modes) has no stable mode of '{}' at {} = {}{}",
                                 reference_.formulation, reference_.modes, name, sweep_.path, value,
                                 found.at.problem.empty() ? "" : ": " + found.at.problem));
  return *frequency;
}

double FrequencyStudy::error(const TradePoint& point, const std::string& name, double value) {
  const double truth = reference_frequency(name, value);
  const auto key = std::pair(point.text(), value);
  auto known = found_.find(key);
  if (known == found_.end()) known = found_.emplace(key, find(point, value)).first;
  const auto frequency = FrequencyStudy::frequency(known->second, name);
  return frequency ? std::abs(*frequency / truth - 1) : std::numeric_limits<double>::infinity();
}

nlohmann::ordered_json FrequencyStudy::reference_json() {
  TradePoint coarser = reference_;
  --coarser.modes;
  double own = 0;
  for (const std::string& name : names_)
    for (const double value : {sweep_.values.front(), sweep_.values.back()})
      own = std::max(own, error(coarser, name, value));
  return {{"formulation", reference_.formulation}, {"modes", reference_.modes}, {"relative_error", own}};
}

}  // namespace withy::study
