#include "withy/core/model/event_plan.hpp"

#include <algorithm>
#include <stdexcept>

namespace withy {
namespace {

/// Binds to the states that it was made with.
class EventLoad final : public Load {
 public:
  explicit EventLoad(std::shared_ptr<const EventPlan> plan) : plan_(std::move(plan)) {}
  std::unique_ptr<BoundLoad> bind(const Model& /*model*/) const override {
    return std::make_unique<EventStates>(plan_);
  }

 private:
  std::shared_ptr<const EventPlan> plan_;
};

using Locked = std::vector<std::size_t>;

}  // namespace

Locked ActingEvent::leaves_locked(Locked locked) const {
  for (const EventAction& action : actions) {
    const auto at = std::lower_bound(locked.begin(), locked.end(), action.index);
    const bool held = at != locked.end() && *at == action.index;
    if (action.kind == EventAction::Kind::lock && !held) locked.insert(at, action.index);
    if (action.kind == EventAction::Kind::unlock && held) locked.erase(at);
  }
  return locked;
}

int EventPlan::configuration(const Locked& locked) const {
  const auto at = std::find(configurations.begin(), configurations.end(), locked);
  return at == configurations.end() ? -1 : static_cast<int>(at - configurations.begin());
}

void EventPlan::find_configurations(std::vector<Locked> from) {
  configurations = {{}};
  const auto add = [&](const Locked& locked) {
    if (configuration(locked) < 0) configurations.push_back(locked);
  };
  for (const Locked& locked : from) add(locked);
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    for (const ActingEvent& event : events) add(event.leaves_locked(configurations[i]));
    if (configurations.size() > most_configurations)
      throw std::invalid_argument("the events lock and unlock hinges in more than " +
                                  std::to_string(most_configurations) + " combinations");
  }
}

std::size_t EventStates::states() const { return 1 + EventNumbers::count * plan_->events.size(); }

EventBook::EventBook(const Model& model) {
  for (const LoadNode& node : model.loads()) {
    if (node.name != name_of_event_states) continue;
    states_ = dynamic_cast<const EventStates*>(node.load.get());
    first_ = node.slot.first;
  }
}

const Locked& EventBook::locked(std::span<const double> y) const {
  return plan().configurations[static_cast<std::size_t>(y[first_])];
}

void EventBook::set_configuration(std::span<double> y, int configuration) const {
  if (configuration < 0 || static_cast<std::size_t>(configuration) >= plan().configurations.size())
    throw std::logic_error("hinges are locked together that no event locks together");
  y[first_] = configuration;
}

EventNumbers EventBook::numbers(std::span<const double> y, std::size_t event) const {
  const auto own = y.subspan(first_ + 1 + EventNumbers::count * event, EventNumbers::count);
  return {own[0], own[1], own[2], own[3], own[4]};
}

void EventBook::set_numbers(std::span<double> y, std::size_t event, const EventNumbers& n) const {
  const auto own = y.subspan(first_ + 1 + EventNumbers::count * event, EventNumbers::count);
  own[0] = n.happened;
  own[1] = n.waiting;
  own[2] = n.due;
  own[3] = n.last;
  own[4] = n.loss;
}

void EventBook::begin(std::span<double> y) const {
  set_configuration(y, plan().start);
  for (std::size_t i = 0; i < plan().events.size(); ++i) {
    const ActingEvent& event = plan().events[i];
    const bool at = event.when == ActingEvent::When::at;
    set_numbers(y, i, {.waiting = at ? 1.0 : 0.0, .due = at ? event.time + event.delay : 0.0});
  }
}

std::vector<std::size_t> locked_hinges(const Model& model, const State& state) {
  const EventBook book(model);
  return book.any() ? book.locked(state.y) : Locked{};
}

void add_events(Model& model, EventPlan plan) {
  model.add_load(name_of_event_states, EventLoad(std::make_shared<const EventPlan>(std::move(plan))));
}

}  // namespace withy
