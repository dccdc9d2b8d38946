/// \file
/// Equations of motion of one large tree, its branches evaluated on threads.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// No tree has more branches that are worth one.
constexpr std::size_t most_threads = 256;

/// What on_threads makes.
struct BranchEquations {
  std::unique_ptr<EquationsOfMotion> equations;  ///< null where there is a refusal
  std::string refusal;                           ///< why the branches are not evaluated on threads
  /// What is left of an evaluation's sweeps: those of the trunk and of the thread that has most, by the count of nodes
  /// and their modes.
  double share = 1;
};

/// Equations that give what the given ones do, to the last bit, whatever the number of threads; `derivatives` sweeps
/// the branches of the tree on that many threads, its caller one of them. Loads are evaluated by the caller. One
/// evaluation at a time has the threads; others at the same time go on their own, with the same bits. Handing over
/// takes some microseconds: what has evaluations of less than these is slower so. The threads end with the equations.
/// \param threads 2 to most_threads; \throws std::invalid_argument else
[[gnu::visibility("default")]] BranchEquations on_threads(std::shared_ptr<const EquationsOfMotion> equations,
                                                          std::size_t threads);

/// What an evaluation of a small tree spends on handing over to that many threads and back [s], with what goes from
/// cache to cache: wall time, the least of many.
[[gnu::visibility("default")]] double hand_over_seconds(std::size_t threads);

}  // namespace withy
