#include "withy/study/agreement.hpp"

#include <fmt/format.h>

#include "withy/study/accuracy.hpp"

namespace withy::study {

Agreement::Agreement(const Prepared& prepared, const ChangingEquations& equations, const RungPlan& plan)
    : plan_(plan), equations_(equations), own_(plan.readings.size()) {
  if (plan.readings.empty()) return;
  outputs_.emplace(prepared.model());
  for (const Rung& rung : prepared.rungs)
    readers_.push_back(std::make_unique<OutputReader>(*outputs_, prepared.model(), *rung.equations));
  apart_ = outputs_->none();
}

void Agreement::look(const State& state) {
  for (; next_ < plan_.readings.size() && plan_.readings[next_].time <= state.time; ++next_)
    if (plan_.readings[next_].time == state.time) {
      own_[next_] = readers_[equations_.rung()]->read(state);
      outputs_->raise(own_[next_], plan_.readings[next_].values, apart_);
    }
}

void Agreement::remember(Memory& memory) {
  memory(next_);
  memory(apart_);
  memory(own_);
}

double Agreement::apart() const { return outputs_ ? relative_error(apart_, plan_.scales) : 0; }

std::string Agreement::text() const {
  return fmt::format(
      "The coarse run that its error is estimated by is {:.2g} % of an output's range off: the motion "
      "is sensitive, and the error is not known.",
      100 * apart());
}

OtherRuns others_of(const Prepared& prepared, Registry& registry, const Control& control, const Agreement& agreement,
                    const RunSummary& summary, RungPlan& plan) {
  if (!(agreement.apart() > another_motion)) return {agreement.apart(), {}};
  return other_runs(prepared, plan.stretches.front().stretch.rung, agreement.apart(), agreement.own(), summary, plan,
                    registry, control);
}

std::string without_difference(const Prepared& prepared, const RungPlan& plan, const RunSummary& summary) {
  const std::string& rung = prepared.rungs[plan.stretches.front().stretch.rung].name;
  std::string text = fmt::format("none against {}, in which all of the run is", rung);
  if (!plan.sensitive.empty()) return text + "; what integration leaves is not known: " + plan.sensitive;
  if (summary.status == RunStatus::completed)
    text += fmt::format("; another run in it is up to {:.2g} % of an output's range off", 100 * plan.apart);
  return text + "; what integration leaves is not estimated: another tolerance tells";
}

}  // namespace withy::study
