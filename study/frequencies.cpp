#include "withy/study/frequencies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/study/input_error.hpp"
#include "withy/study/reference.hpp"
#include "withy/study/refusals.hpp"

namespace withy::study {
namespace {

/// Of the mode that bears the name; nothing where it is no vibration: rigid, comes to rest or grows.
std::optional<double> frequency_of(const ModesAt& at, const std::string& name) {
  const Eigen::Index speed = std::find(at.names.begin(), at.names.end(), name) - at.names.begin();
  const Mode* mode = nullptr;
  for (const Mode& m : at.modes) {
    if (mode == nullptr || m.shares[speed] > mode->shares[speed]) mode = &m;
  }
  if (mode == nullptr || mode->rigid || mode->single || unstable(at, *mode)) return std::nullopt;
  return mode->frequency();
}

}  // namespace

FrequencyStudy::FrequencyStudy(const Prepared& base, Registry& registry, FrequencyQuestion question)
    : base_(base), registry_(registry), question_(std::move(question)), reference_(question_.points.front()) {
  // Modes are found again by what moves in them, which does not tell those of a loop from each other.
  refuse_states_of_loads(base_, "a trade of frequencies");
  reference_.family.clear();
  for (const Point& p : question_.points) reference_.modes = std::max(reference_.modes, p.modes);
  ++reference_.modes;
  const double value = question_.sweep.values.at(1);
  const std::vector<std::string> formulations = reference_formulations(registry);
  for (const std::string& formulation : formulations) {
    reference_.formulation = formulation;
    try {
      static_cast<void>(reference_at(value));
      break;
    } catch (const InputError&) {
      if (formulation == formulations.back()) throw;
    } catch (const SceneError&) {  // where loops are closed the scene's equations are asked for as it is made
      if (formulation == formulations.back()) throw;
    }
  }
  const ModesAt& first = reference_at(value);
  for (const Mode& m : first.modes) {
    if (m.rigid || m.single || names_.size() == question_.count) continue;
    const std::string name = dominating(first, m);
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
  }
  if (names_.empty())
    throw InputError(base.scene.file + ": no mode vibrates; frequencies cannot be compared" +
                     (first.problem.empty() ? "" : ": " + first.problem));
}

ModesAt FrequencyStudy::find(const Point& point, double value) const {
  const Sweep& sweep = question_.sweep;
  SceneValues values = values_at(base_.values, base_.scene, point, registry_);
  if (sweep.spun().empty()) values.set_text(fmt::format("{}={}", sweep.path, value));
  const Prepared prepared = prepare(std::move(values), registry_);
  Configuration c(prepared, prepared.scene.initial, question_.holding);
  if (!sweep.spun().empty()) c.spin({sweep.spun(), value});
  ModesAt at = modes_at(c, false);
  at.value = value;
  return at;
}

const ModesAt& FrequencyStudy::reference_at(double value) {
  const auto known = references_.find(value);
  if (known != references_.end()) return known->second;
  return references_.emplace(value, find(reference_, value)).first->second;
}

double FrequencyStudy::reference_frequency(const std::string& name, double value) {
  const ModesAt& found = reference_at(value);
  const auto frequency = frequency_of(found, name);
  if (!frequency)
    throw InputError(fmt::format("the reference ({}, {} modes) has no stable mode of '{}' at {} = {}{}",
                                 reference_.formulation, reference_.modes, name, question_.sweep.path, value,
                                 !found.problem.empty() ? ": " + found.problem
                                 : found.frozen()       ? ": the equations change over a turn or with time, and modes "
                                                          "of one frozen angle may grow where a whole turn is stable"
                                                        : ""));
  return *frequency;
}

double FrequencyStudy::error(const Point& point, const std::string& name, double value) {
  const double truth = reference_frequency(name, value);
  const auto key = std::pair(point.text(), value);
  auto known = found_.find(key);
  if (known == found_.end()) known = found_.emplace(key, find(point, value)).first;
  const auto frequency = frequency_of(known->second, name);
  return frequency ? std::abs(*frequency / truth - 1) : std::numeric_limits<double>::infinity();
}

std::optional<double> FrequencyStudy::frozen_from() const {
  for (const auto& [value, at] : references_)
    if (at.frozen()) return value;
  return {};
}

double FrequencyStudy::reference_error() {
  Point coarser = reference_;
  --coarser.modes;
  double own = 0;
  for (const std::string& name : names_)
    for (const double value : {question_.sweep.values.front(), question_.sweep.values.back()})
      own = std::max(own, error(coarser, name, value));
  return own;
}

}  // namespace withy::study
