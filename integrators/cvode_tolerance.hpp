/// \file
/// The tolerance that CVODE is given for one that is asked for.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "step_control.hpp"

namespace withy {

/// What CVODE is asked for. It controls the mean error of a step where a tolerance is of the greatest, and errors of
/// steps, whose number rises as the tolerance falls, add up: the error of a run is in proportion to tolerance^a. So the
/// tolerance is calibrated after Söderlind & Wang (J. Comput. Appl. Math. 185, 2006, 244–260), both parts alike:
///   rtol′ = κ rtol^(1/a) / √n
/// with n elements of y; a and κ are measured such that a run of some vibrations ends within ten times the tolerance.
class CalibratedTolerance {
 public:
  CalibratedTolerance(const StepControl& control, bool stiff, std::size_t n) {
    const double power = stiff ? 1 / 0.8 : 1 / 0.885, kappa = stiff ? 0.22 : 0.1;
    const double asked = kappa * std::pow(control.rtol, power) / std::sqrt(static_cast<double>(n));
    rtol = std::max(asked, least);
    atol = control.atol * (rtol / control.rtol);
    if (asked < least)
      remark = fmt::format(
          "rtol {:.3g} asks for errors of {:.2g} a step, less than rounding leaves: {:.2g} is held, and the run's "
          "error may be more than ten times its tolerance",
          control.rtol, asked, least);
  }

  double rtol, atol;
  std::string remark;  ///< what could not be had; empty where nothing is missing

 private:
  static constexpr double least = 0x1p-51;  ///< CVODE refuses less than half of it
};

}  // namespace withy
