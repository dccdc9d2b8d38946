/// \file
/// The certificate of a run: what was modelled, what was left out and how large that was, what binds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/error_estimate.hpp"
#include "withy/study/indicators.hpp"
#include "withy/study/step_limit.hpp"

namespace withy::study {

/// A stretch of a run of formulation `auto`, with the name of what it was in.
struct NamedStretch {
  std::string formulation;
  Stretch stretch;
};

struct Certificate {
  std::string formulation;                ///< of the scene
  std::string meaning;                    ///< the formulation in a sentence
  std::vector<NamedStretch> stretches;    ///< of formulation `auto`; else empty
  std::size_t discarded_evaluations = 0;  ///< the same
  std::vector<std::string> compiled;      ///< what the compiled equations save
  double energy_drift = 0;                ///< RunSummary::energy_drift
  std::optional<double> rounding;         ///< relative error of accelerations that rounding may leave at the end
  std::size_t samples = 0;                ///< of validity
  std::vector<BodyValidity> bodies;       ///< of every flexible body
  std::string against;                    ///< formulation that accelerations were compared with; empty: none
  NeglectedAcceleration neglected;        ///< no samples where there was nothing to compare with
  std::optional<ErrorEstimate> estimate;  ///< none where there is no model up, or it was not asked for
  StepLimit steps;
  std::vector<Indicator> indicators;  ///< the one that binds first
};

/// What a run leaves for its certificate.
struct Evidence {
  const RunSummary* summary = nullptr;
  const Beyond* beyond = nullptr;           ///< null: nothing to compare with
  const EscalatedRun* escalated = nullptr;  ///< of formulation `auto`
  std::optional<ErrorEstimate> estimate;
};
Certificate certify(const Prepared& prepared, Evidence evidence, Registry& registry);

/// The motion that a load on a body comes from most.
std::size_t greatest_share(const LoadRatio& load);

}  // namespace withy::study
