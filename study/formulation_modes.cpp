#include "withy/study/formulation_modes.hpp"

#include <fmt/format.h>

#include <utility>

#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// What is asked for one configuration beside its modes, about the state that these are about.
void look_further(const Prepared& base, Registry& registry, const ModesQuestion& question, ModesFound& found) {
  const ModesAt& at = found.runs.front().points.front();
  if (!at.problem.empty() || !(question.masses || !question.damp.empty())) return;
  Configuration c(base, question.start ? question.start(base) : StateAsGiven(base.scene.initial), question.holding);
  if (at.steady) c.set_state(at.steady->steady.state);
  if (question.masses) found.masses = effective_masses(c);
  if (question.damp.empty()) return;
  found.damping = mounted_damping(c, registry, question.damp);
  found.damping->frozen = at.frozen();
}

}  // namespace

void check_question(const ModesQuestion& question) {
  if (question.sweep.none() && question.formulations.empty()) return;
  for (const auto& [asked, option] : {std::pair{question.masses, "effective-mass"}, {!question.damp.empty(), "damp"}}) {
    if (asked)
      throw OptionError(option,
                        "of one configuration, in the scene's formulation: leave out --sweep and "
                        "--formulations, or --set formulation=ID");
  }
}

ModesFound find_modes(const Prepared& base, Registry& registry, const ModesQuestion& question,
                      const std::function<Control(const std::string& formulation)>& control) {
  check_question(question);
  std::vector<std::string> formulations = question.formulations;
  if (formulations.empty()) formulations.push_back(base.scene.formulation_name);
  ModesFound found;
  for (const std::string& formulation : formulations) {
    SceneValues values = base.values;
    values.choose_formulation(formulation, "--formulations " + formulation);
    const Control sweeping = control(formulation);
    found.runs.push_back(sweep_modes(values, registry, question.start, question.holding, question.sweep, question.as_is,
                                     question.wish, sweeping));
    found.against.emplace_back();
    if (question.sweep.none() && question.compared > 0 && !sweeping.stop())
      found.against.back() =
          frequencies_against_next(found.runs.back(), values, registry, question.start, question.holding,
                                   question.as_is, question.compared, control(formulation));
    found.interrupted = sweeping.stop();
    if (!found.interrupted) continue;
    if (question.sweep.none() || found.runs.back().points.empty()) found.runs.pop_back(), found.against.pop_back();
    return found;
  }
  look_further(base, registry, question, found);
  return found;
}

bool stands_still(const ModesAt& at, const Sweep& sweep) {
  return !sweep.spun().empty() && at.value == 0 && at.turn && !at.turn->problem.empty() &&
         at.turn->check.turning.period == 0;
}

std::vector<std::string> modes_problems(const std::vector<ModesOf>& runs, const Sweep& sweep) {
  std::vector<std::string> problems;
  for (const ModesOf& run : runs) {
    for (const ModesAt& at : run.points) {
      const std::string where = sweep.none() ? "" : fmt::format("{} = {}", sweep.path, sweep.text(at.value));
      const std::string before = where.empty() ? "" : where + ": ";
      if (at.turn && !at.turn->problem.empty() && !stands_still(at, sweep))
        problems.push_back(before + "a whole turn: " + at.turn->problem);
      if (at.turn && !at.turn->blade_problem.empty())
        problems.push_back(before + "--blades: " + at.turn->blade_problem);
      if (!at.problem.empty())
        problems.push_back(run.formulation + (where.empty() ? "" : ", " + where) + ": " + at.problem);
    }
  }
  return problems;
}

}  // namespace withy::study
