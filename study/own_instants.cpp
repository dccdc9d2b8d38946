#include "withy/study/own_instants.hpp"

#include <fmt/format.h>

#include "withy/core/model/acting_event.hpp"

namespace withy::study {
namespace {

/// What makes an event more than one that watches a coordinate or rate of a hinge.
const char* more_than_watching(const ActingEvent& event) {
  if (event.when == ActingEvent::When::at) return "is at a time";
  if (event.when == ActingEvent::When::after) return "comes after another";
  if (event.element < 0) return "watches more than a coordinate or rate of a hinge";
  if (event.delay > 0) return "waits";
  return "repeats or is followed by another";
}

}  // namespace

std::string own_instants(const Model& model) {
  const EventBook book(model);
  if (const ActingEvent* event = first_acting(book)) {
    const bool at_a_time = event->when == ActingEvent::When::at;
    return fmt::format("event '{}' acts{}", event->name, at_a_time ? "" : ", at times of its own in every model");
  }
  if (book.any()) {
    const ActingEvent& event = book.plan().events.front();
    return fmt::format(
        "event '{0}' does nothing to the motion but {1}, and is dealt with as those that act: leave it "
        "out (--set events.{0}=null)",
        event.name, more_than_watching(event));
  }
  for (const LoadNode& load : model.loads())
    if (load.load->discrete() != nullptr && load.load->discrete()->switches() > 0)
      return fmt::format("load '{}' switches at zeros of a function of the state, at times of its own in every model",
                         load.name);
  return "a load switches at times of its own in every model";
}

}  // namespace withy::study
