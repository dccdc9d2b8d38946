/// \file
/// Which events of a scene act on its motion.
#pragma once

#include "withy/core/model/event_plan.hpp"

namespace withy {

/// The first event of a model that does something to hinges or loads; null where there is none: those that are left are
/// looked for alone, though they may end a run. \param book of the model, which it must not outlive
inline const ActingEvent* first_acting(const EventBook& book) {
  if (!book.any()) return nullptr;
  for (const ActingEvent& event : book.plan().events)
    if (!event.actions.empty()) return &event;
  return nullptr;
}

/// Its name; empty where there is none.
inline std::string acting_event(const Model& model) {
  const EventBook book(model);
  const ActingEvent* event = first_acting(book);
  return event == nullptr ? std::string() : event->name;
}

}  // namespace withy
