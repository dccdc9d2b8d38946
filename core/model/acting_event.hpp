/// \file
/// Which events of a scene act on its motion.
#pragma once

#include "withy/core/model/event_plan.hpp"

namespace withy {

/// The name of the first event of a model that does something to hinges or loads; empty where there is none: those that
/// are left are looked for alone, though they may end a run.
inline std::string acting_event(const Model& model) {
  const EventBook book(model);
  if (!book.any()) return {};
  for (const ActingEvent& event : book.plan().events)
    if (!event.actions.empty()) return event.name;
  return {};
}

}  // namespace withy
