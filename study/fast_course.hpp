/// \file
/// Loads and motions whose own course in time no run can follow to its end.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "withy/study/prepared.hpp"

namespace withy::study {

struct FastCourse {
  bool of_motion = false;  ///< of a prescribed motion, else of a load
  std::string name;
  double period = 0;  ///< [s] of its clock, or about that in which it goes to and fro
  std::string text;   ///< both, and how often up to the end of the run, in a clause
};

/// What changes with time by itself, whatever moves, so often that steps which resolve it are more than `most_steps` up
/// to the end of the run; nothing where there is no such load or motion, or the run has no end.
std::optional<FastCourse> fast_course(const Prepared& prepared, const State& state,
                                      std::size_t most_steps = RunOptions().most_steps);

/// What changes with time by itself, whatever moves, in less than two steps of an integrator that nothing tells of
/// errors: it is read at points within a step that may miss it, or take it for something slower. Nothing where there is
/// no such load or motion, or the integrator controls its error.
std::optional<FastCourse> unseen_course(const Prepared& prepared, const State& state);

}  // namespace withy::study
