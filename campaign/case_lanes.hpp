/// \file
/// The cases of one thread, several of them at once.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "withy/campaign/case_run.hpp"

namespace withy::campaign {

/// Where cases come from and go to.
struct CaseFlow {
  std::function<std::optional<std::uint64_t>()> next;  ///< the index of one more case; nothing: there are no more
  std::function<void(const CaseResult&)> done;         ///< takes the result of one
  std::function<void(const std::string&)> alone;       ///< told why a case is evaluated by itself; may be empty
};

/// Runs cases until there are no more, or the control interrupts. Those that differ in numbers only are evaluated
/// together (LaneEquations): each run, with its integrator, its step, its events and its watches, has a stack of its
/// own and stops where it needs an evaluation, until all of them do; a lane whose case has ended takes the next.
/// Whether a case is evaluated so depends on the case alone (CaseRun::alone_because), and what it gives neither on its
/// lane nor on its company: the same bits for the same case, alone or among others, whatever the thread. \throws
/// PluginError; what a plugin throws.
void run_cases(const Plan& plan, const Cases& cases, Registry& registry, const study::Control& control,
               const CaseFlow& flow);

/// One of them. A case that is interrupted has that status and is no result.
CaseResult run_case(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry,
                    const study::Control& control);

}  // namespace withy::campaign
