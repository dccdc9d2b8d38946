#include "withy/core/simulation/end_notes.hpp"

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/given_steps.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {

std::string note_on_jumps(const Model& model, const std::vector<double>& times) {
  std::string text = "Steps were rejected again and again near t =";
  for (const double t : times) text.append(" ").append(brief(t));
  const std::size_t loops = loops_of(model).size();  // which are among the loads
  text +=
      model.loads().size() == loops && model.motions().empty()
          ? " s: what moves there is fast beside the rest"
          : " s: something changes there within a step, as where a stop is met or a load jumps without declaring it";
  return text + ".";
}

std::string note_on_missed_events(const Model& model, const State& end) {
  const EventBook book(model);
  if (!book.any()) return {};
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < book.plan().events.size(); ++i) {
    const ActingEvent& event = book.plan().events[i];
    if (book.numbers(end.y, i).happened > 0 || (event.actions.empty() && !event.stops)) continue;
    names += (++count > 1 ? ", '" : "'") + event.name + "'";
  }
  if (count == 0) return {};
  return (count > 1 ? "The events " : "The event ") + names + " did not happen.";
}

std::string note_on_given_steps(const Stepper& stepper, double scale) {
  constexpr double too_much = 0.1;
  const auto* given = dynamic_cast<const GivenSteps*>(&stepper);
  if (given == nullptr || !(scale > 0)) return {};
  const GivenSteps::WorkGap gap = given->greatest_gap();
  if (!(gap.work > too_much * scale)) return {};
  return "A step of " + brief(gap.step) + " s is too long for what acts, most at t = " + brief(gap.time) +
         " s: the work over it is known to " + brief(gap.work / scale) +
         " of the greatest energy, though energy balances: the method's steps do that by construction. Take shorter "
         "steps, or an integrator that controls its error.";
}

std::string note_on_impulses(const Model& model, const State& end) {
  const EventBook book(model);
  std::size_t most = 0;
  for (std::size_t i = 0; book.any() && i < book.plan().events.size(); ++i)
    if (book.numbers(end.y, i).loss > book.numbers(end.y, most).loss) most = i;
  if (!book.any() || !(book.numbers(end.y, most).loss > 0)) return {};
  const EventNumbers n = book.numbers(end.y, most);
  return " Before that, at t = " + brief(n.last) + " s, event '" + book.plan().events[most].name +
         "' locked hinges that moved: its impulses took " + brief(n.loss) + " J and set the bodies' modes in motion.";
}

}  // namespace withy
