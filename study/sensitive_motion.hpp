/// \file
/// Motions of which two runs part, however closely each follows its equations: chaotic ones, and others that grow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/control.hpp"
#include "withy/study/prepared.hpp"
#include "withy/study/rung_plan.hpp"

namespace withy::study {

/// Part of an output's range by which another run of the same equations may be off a run; beyond it is another motion.
inline constexpr double another_motion = 0.3;
/// Where a run comes to another end, tolerances so much lower tell why, for so many times the evaluations of the run:
/// an integrator of fifth order needs 2.5 times as many for a hundredth.
inline constexpr double closer = 0.01;
inline constexpr std::size_t most_closer = 3;

/// What is known where another run of the same equations ends elsewhere.
/// \param apart from the run, as a part of an output's range
/// \param rtol of that other run
std::string sensitive_text(double apart, double rtol);

/// How a run agrees with others of the same equations.
struct OtherRuns {
  double apart = 0;       ///< of the closest, the greatest part of an output's range
  std::string sensitive;  ///< why what the run is off is not known, in a sentence; empty where another agrees
};

/// Follows the equations of a rung again where the coarse run of a plan was another motion than the run: at the
/// tolerances of estimates at any price, and where that is another motion too, at a hundredth of them.
/// \param coarse what the coarse run was apart from the run
/// \param own readings of the run at the times of the plan's; empty where there is none
/// \param plan is charged with the evaluations \throws InputError where an integrator is missing
OtherRuns other_runs(const Prepared& prepared, std::size_t rung, double coarse,
                     const std::vector<std::vector<double>>& own, const RunSummary& summary, RungPlan& plan,
                     Registry& registry, const Control& control);

}  // namespace withy::study
