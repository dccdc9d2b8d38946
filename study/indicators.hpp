/// \file
/// How a run stands against the limits of its formulation (theory, section 5).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/scene/scene.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// An indicator of validity against its limit.
struct Indicator {
  std::string text;  ///< "tip deflection of 'link2' over its length"
  double value = 0;
  double limit = 0;
  std::string meaning;  ///< what happens past the limit
  [[nodiscard]] double use() const { return value / limit; }
};

/// "the tip", or what stands for it: "station '21'", "what moves most of the tip, left, right".
std::string measured_name(const BodyValidity& body);
/// "tip deflection", or of what stands for the tip: "deflection of station '21'".
std::string deflection_name(const BodyValidity& body);

/// How far a body was bent where it is measured; nothing where that is not known.
std::optional<Bend> greatest_bend(const BodyValidity& body, const RunSummary& summary);

/// What the modes of a family are called before the word "mode": "bending_y ", and nothing of modes without a family,
/// whose name is "mode" itself.
std::string before_mode(const std::string& family);

/// Whether the shares that a body's highest modes have of its energy tell nothing: it bends no more than a thousand
/// times the absolute tolerance of the scene's integrator, which leaves as much in any mode; or it is one of several
/// segments, which are to a beam what modes are.
bool needs_no_modes(const Scene& scene, const BodyValidity& body, const RunSummary& summary);

/// Those that matter to the scene's formulation, the one nearest to its limit (or furthest past it) first.
/// \param used what the run kept in the end, where that is not what the scene's formulation says
std::vector<Indicator> indicators(const Scene& scene, const RunSummary& summary, std::optional<Terms> used = {});

/// Adds one in its place.
void add_in_place(std::vector<Indicator>& indicators, Indicator indicator);
/// Adds the error that rounding leaves the accelerations at a state, where that is a number. \returns it
std::optional<double> add_rounding(std::vector<Indicator>& indicators, const Model& model,
                                   const EquationsOfMotion& equations, const State& state);

/// Of a run that begins at a state and ends there: what the motion makes of it later is not in them. None where no run
/// can begin at the state.
std::vector<Indicator> indicators_at(const Prepared& prepared, const State& state);

}  // namespace withy::study
