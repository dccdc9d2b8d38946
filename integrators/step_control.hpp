/// \file
/// Options of the integrators with error control, as a scene states them.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "withy/core/plugin/parameters.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// A step is accepted when the estimated error of every position and speed is at most atol + rtol |y|. The work
/// element of State has no part in it, but where motions prescribe every speed: there nothing else is left to find.
struct StepControl {
  double rtol = 1e-6;
  double atol = 1e-9;       ///< in the unit of each element
  double initial_step = 0;  ///< [s], at the start and after discontinuities; 0: found from the equations
  double max_step = std::numeric_limits<double>::infinity();  ///< [s]; exceeded by at most 1 % to land
  double min_step = 0;                                        ///< [s], below it the run ends with step-underflow
};

inline std::vector<ParameterSpec> step_control_parameters() {
  return {number("rtol", "1", "relative tolerance of an accepted step").above(0).most(1).otherwise(1e-6),
          number("atol", "1", "absolute tolerance of an accepted step, in the unit of each coordinate and speed")
              .above(0)
              .otherwise(1e-9),
          number("initial_step", "s", "first step and first step after a discontinuity; chosen where left out")
              .above(0)
              .optional(),
          number("max_step", "s", "greatest step; unlimited where left out").above(0).optional(),
          number("min_step", "s", "a smaller step ends the run; where left out, the resolution of time")
              .above(0)
              .optional()};
}

/// Reads checked parameters; nothing after a reported error.
inline std::optional<StepControl> read_step_control(const Value& p, const MakeContext& context) {
  StepControl c;
  c.rtol = p.number_at("rtol");
  c.atol = p.number_at("atol");
  if (const Value* v = p.find("initial_step")) c.initial_step = v->number();
  if (const Value* v = p.find("max_step")) c.max_step = v->number();
  if (const Value* v = p.find("min_step")) c.min_step = v->number();
  if (c.min_step > c.max_step) {
    context.diagnostics.error(p.at("min_step").place(), "min_step is greater than max_step");
    return {};
  }
  return c;
}

}  // namespace withy
