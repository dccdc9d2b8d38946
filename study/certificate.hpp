/// \file
/// The certificate of a run: what was modelled, what was left out and how large that was, what binds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/dropped_terms.hpp"
#include "withy/study/error_estimate.hpp"
#include "withy/study/indicators.hpp"
#include "withy/study/more_modes.hpp"
#include "withy/study/rung_plan.hpp"
#include "withy/study/step_limit.hpp"

namespace withy::study {

/// A body in a formulation of its own.
struct OwnFormulation {
  std::string body;
  std::string formulation;
  std::string meaning;  ///< in a sentence
};

/// The modes of a body in one strain, with the family they are of, named after the ends it is made for.
struct BodyFamilies {
  std::string body;
  std::string strain;  ///< as "bending_y"; empty: of the whole body
  std::string family;  ///< empty where there is no choice of one
  std::size_t modes = 0;
};
/// As the scene chooses them, then those that bodies bring with them.
std::vector<BodyFamilies> families_of(const Scene& scene);

/// A drift, told apart.
struct DriftShare {
  double model = 0;        ///< what the formulation leaves out makes of it
  double integration = 0;  ///< no more than this is the integration's; zero where `model` is all of it
};

/// Of energy and momenta; none where the coarse run that tells them apart drifts by more itself.
struct DriftShares {
  std::optional<DriftShare> energy, linear, angular;
};

struct Certificate {
  std::string formulation;             ///< of the scene
  std::string meaning;                 ///< the formulation in a sentence
  std::vector<OwnFormulation> own;     ///< bodies whose formulation is another; the scene's does not hold for them
  std::optional<RungPlan> plan;        ///< of formulation `auto`, as far as the run went
  std::vector<std::string> rungs;      ///< its formulations
  std::vector<std::string> compiled;   ///< what the compiled equations save
  double energy_drift = 0;             ///< RunSummary::energy_drift
  double untruncated_drift = 0;        ///< RunSummary::untruncated_drift
  MomentumDrift momentum;              ///< RunSummary::momentum
  std::optional<DriftShares> shares;   ///< of these drifts; none where they cannot be told apart
  std::vector<DroppedForces> dropped;  ///< along the run; empty where there is no model up
  std::vector<BodyFamilies> families;  ///< of every body that has modes
  std::optional<double> rounding;      ///< relative error that rounding leaves the final accelerations; none: no digit
  std::size_t samples = 0;             ///< of validity
  std::vector<BodyValidity> bodies;    ///< of every flexible body
  std::string against;                 ///< formulation that accelerations were compared with; empty: none
  NeglectedAcceleration neglected;     ///< no samples where there was nothing to compare with
  std::optional<ErrorEstimate> estimate;  ///< none where there is no model up, or it was not asked for
  std::string without_estimate;           ///< why there is none, and what is known without one
  MoreModesOutcome more_modes;            ///< empty where no body has a number of modes
  StepLimit steps;
  std::vector<Indicator> indicators;  ///< the one that binds first
};

/// What a run leaves for its certificate.
struct Evidence {
  const RunSummary* summary = nullptr;
  const Beyond* beyond = nullptr;  ///< null: nothing to compare with
  std::optional<RungPlan> plan;    ///< of formulation `auto`
  std::optional<ErrorEstimate> estimate;
  std::string without_estimate = {};  ///< why there is none
  std::vector<DroppedForces> dropped = {};
  MoreModesOutcome more_modes = {};
};
Certificate certify(const Prepared& prepared, Evidence evidence, Registry& registry);

/// The motion that a load on a body comes from most.
std::size_t greatest_share(const LoadRatio& load);

}  // namespace withy::study
