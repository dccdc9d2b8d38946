#include "withy/scene/events_done.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/switched_load.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

/// Index in State::y of the form of a load that events switch; 0 where none does.
std::size_t place_of_form(const Model& model, const std::string& name) {
  for (const LoadNode& node : model.loads())
    if (node.name == name && node.slot.count > 0) return SwitchedLoad::place_of_form(node.slot);
  return 0;
}

/// What the settings of a load that events switch are called: "on", "off", and for what an event sets its name.
std::vector<std::pair<std::string, double>> forms_of(const Model& model, const std::string& name) {
  const EventBook book(model);
  std::vector<std::pair<std::string, double>> forms;
  if (!book.any()) return forms;
  for (const ActingEvent& event : book.plan().events)
    for (const EventAction& action : event.actions) {
      if (action.kind != EventAction::Kind::form || model.loads()[action.index].name != name) continue;
      if (forms.empty()) forms = {{"on", SwitchedLoad::as_stated}, {"off", SwitchedLoad::off}};
      if (action.form > 0) forms.emplace_back(event.name, action.form);
    }
  return forms;
}

class EventsDoneReader {
 public:
  EventsDoneReader(const Model& model, const Checker& checker, State& state)
      : model_(model), checker_(checker), state_(state), book_(model) {}

  bool read(const Value& value) {
    if (const Value* locked = value.find("locked")) read_locked(*locked, value.has("events"));
    if (const Value* settings = value.find("settings")) read_settings(*settings);
    if (const Value* events = value.find("events")) read_events(*events);
    if (book_.any()) check_locked(value);
    return good_;
  }

 private:
  void key_error(const Value& member, std::string message) {
    checker_.key_error(member.place().path, std::move(message));
    good_ = false;
  }

  /// \param whole the list says all; else bodies that are to be released hang on their welds still
  void read_locked(const Value& value, bool whole) {
    const auto refuse = [&](const Place& place, const std::string& why) {
      checker_.diagnostics().error(place, why);
      good_ = false;
    };
    if (value.kind() != Value::Kind::list)
      return refuse(value.place(), fmt::format("got {}; need a list of hinge names", shown(value)));
    std::vector<std::string> names;
    for (const HingeNode& h : model_.hinges()) names.push_back(h.name);
    std::vector<std::size_t> locked;
    for (const Value& item : value.items()) {
      const int hinge = model_.hinge(item.text());
      if (hinge < 0)
        return refuse(item.place(),
                      fmt::format("no hinge {}{}", in_quotes(item.text()), checker_.suggest(item.text(), names)));
      locked.push_back(static_cast<std::size_t>(hinge));
    }
    if (!whole && book_.any()) {
      for (const ActingEvent& event : book_.plan().events)
        for (const EventAction& action : event.actions)
          if (action.releases) locked.push_back(action.index);
    }
    std::sort(locked.begin(), locked.end());
    locked.erase(std::unique(locked.begin(), locked.end()), locked.end());
    const int configuration = book_.any() ? book_.plan().configuration(locked) : (locked.empty() ? 0 : -1);
    if (configuration < 0)
      return refuse(value.place(),
                    "no event locks or unlocks these hinges together; a hinge that stays locked has a motion 'locked'");
    if (book_.any()) book_.set_configuration(state_.y, configuration);
  }

  /// Locked hinges are at rest.
  void check_locked(const Value& value) {
    const Value* hinges = value.find("hinges");
    for (const std::size_t h : book_.locked(state_.y)) {
      const Slot& slot = model_.layout().hinges[h];
      for (std::size_t i = 0; i < slot.speeds; ++i) {
        double& rate = state_.y[model_.layout().positions + slot.speed + i];
        if (rate == 0) continue;
        const Value* hinge = hinges == nullptr ? nullptr : hinges->find(slot.name);
        checker_.diagnostics().error(hinge == nullptr ? value.place() : hinge->place(),
                                     fmt::format("hinge '{}' is locked, and has a rate of {}", slot.name, rate));
        good_ = false;
        break;
      }
    }
  }

  void read_settings(const Value& value) {
    if (!checker_.is_map(value, "a map of names of loads that events switch")) {
      good_ = false;
      return;
    }
    for (const auto& [name, member] : value.members()) {
      const auto forms = forms_of(model_, name);
      if (forms.empty()) {
        key_error(member, fmt::format("no event switches a load {}", in_quotes(name)));
        continue;
      }
      const auto form =
          std::find_if(forms.begin(), forms.end(), [&, &m = member](const auto& f) { return f.first == m.text(); });
      if (form == forms.end()) {
        std::vector<std::string> names;
        for (const auto& f : forms) names.push_back(f.first);
        checker_.diagnostics().error(member.place(),
                                     fmt::format("got {}; need one of: {}", shown(member), listed(names)));
        good_ = false;
        continue;
      }
      state_.y[place_of_form(model_, name)] = form->second;
    }
  }

  void read_events(const Value& value) {
    if (!checker_.is_map(value, "a map of names of events that act")) {
      good_ = false;
      return;
    }
    std::vector<std::string> names;
    if (book_.any())
      for (const ActingEvent& event : book_.plan().events) names.push_back(event.name);
    for (const auto& [name, member] : value.members()) {
      const auto at = std::find(names.begin(), names.end(), name);
      if (at == names.end()) {
        key_error(member, fmt::format("no event that acts {}{}", in_quotes(name), checker_.suggest(name, names)));
        continue;
      }
      const auto checked = checker_.check_members(
          member,
          {number("happened", "1", "how often it has acted").least(0).otherwise(0.0),
           number("due", "s", "when it will act").optional(), number("last", "s", "when it last acted").otherwise(0.0),
           number("loss", "J", "kinetic energy that its impulses have taken").otherwise(0.0)});
      if (!checked) {
        good_ = false;
        continue;
      }
      EventNumbers n{.happened = checked->number_at("happened"),
                     .last = checked->number_at("last"),
                     .loss = checked->number_at("loss")};
      if (const Value* due = checked->find("due")) n.due = due->number();
      n.waiting = member.has("due") ? 1 : 0;
      book_.set_numbers(state_.y, static_cast<std::size_t>(at - names.begin()), n);
    }
  }

  const Model& model_;
  const Checker& checker_;
  State& state_;
  EventBook book_;
  bool good_ = true;
};

}  // namespace

std::optional<EventsDone> events_done(const Model& model, const State& state) {
  const EventBook book(model);
  if (!book.any()) return {};
  EventsDone done;
  for (const std::size_t hinge : book.locked(state.y)) done.locked.push_back(model.hinges()[hinge].name);
  for (const LoadNode& node : model.loads())
    for (const auto& [setting, form] : forms_of(model, node.name))
      if (form != SwitchedLoad::as_stated && state.y[SwitchedLoad::place_of_form(node.slot)] == form)
        done.settings.emplace_back(node.name, setting);
  for (std::size_t i = 0; i < book.plan().events.size(); ++i) {
    const EventNumbers n = book.numbers(state.y, i);
    std::vector<std::pair<std::string, double>> numbers{{"happened", n.happened}};
    if (n.waiting > 0) numbers.emplace_back("due", n.due);
    if (n.happened > 0) numbers.insert(numbers.end(), {{"last", n.last}, {"loss", n.loss}});
    done.events.emplace_back(book.plan().events[i].name, std::move(numbers));
  }
  return done;
}

bool read_events_done(const Value& value, const Model& model, const Checker& checker, State& state) {
  return EventsDoneReader(model, checker, state).read(value);
}

}  // namespace withy
