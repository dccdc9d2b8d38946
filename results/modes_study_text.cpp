#include <fmt/format.h>

#include <algorithm>

#include "withy/results/modes_text.hpp"
#include "withy/study/at_limits.hpp"

namespace withy {
namespace {

std::string run_of_modes_text(const study::ModesOf& run, const std::optional<study::AgainstNext>& against,
                              const study::Sweep& sweep, std::size_t count, bool poles) {
  const bool none = run.points.front().modes.empty();
  if (none && sweep.none() && run.points.front().problem.empty())
    return "\nNothing is free to move: hinges that can move have motions, and no body deforms.\n";
  std::string text;
  if (!none || !sweep.none()) text += '\n' + (sweep.none() ? modes_text(run, count) : sweep_text(run, sweep, count));
  if (const std::string words = study::against_next_text(
          against, !against || against->compared == 1 ? "the lowest frequency"
                   : against->compared == 0           ? "the lowest frequencies"
                                                      : fmt::format("the {} lowest frequencies", against->compared));
      !words.empty())
    text += '\n' + words + '\n';
  if (const std::string words = study::sampling_text(run); !words.empty()) text += '\n' + words + '\n';
  const auto bent = std::find_if(run.points.begin(), run.points.end(), [](const auto& at) { return !at.bent.empty(); });
  if (bent != run.points.end())
    text +=
        '\n' + (sweep.none() ? "" : fmt::format("{} = {}: ", sweep.path, sweep.text(bent->value))) + bent->bent + '\n';
  const auto limited =
      std::find_if(run.points.begin(), run.points.end(), [](const auto& at) { return !at.limited.empty(); });
  if (limited != run.points.end())
    text += '\n' + (sweep.none() ? "" : fmt::format("{} = {}: ", sweep.path, sweep.text(limited->value))) +
            study::at_limits_text(limited->limited) + '\n';
  // Of a sweep the first value at which the equations are periodic speaks for all.
  const auto frozen = std::find_if(run.points.begin(), run.points.end(), [](const auto& at) { return at.frozen(); });
  const study::ModesAt& spoken_of = frozen != run.points.end() ? *frozen : run.points.back();
  if (spoken_of.turn) {
    if (const std::string words = study::turn_text(*spoken_of.turn); !words.empty()) text += '\n' + words + '\n';
  }
  if (poles && !none) text += '\n' + poles_text(run.points.front());
  for (const study::ModesAt& at : run.points) {
    if (study::stands_still(at, sweep))
      text += fmt::format("\nAt {} = {} nothing turns: the frequencies there are those of the table above.\n",
                          sweep.path, sweep.text(at.value));
    else if (at.turn)
      text += turning_text(*at.turn, sweep.none() ? "" : fmt::format("{} = {}", sweep.path, sweep.text(at.value)));
  }
  return text;
}

}  // namespace

std::string modes_study_text(const std::string& scene, const study::Sweep& sweep, const study::ModesFound& found,
                             std::size_t count, bool poles) {
  std::string text;
  for (std::size_t i = 0; i < found.runs.size(); ++i)
    text += fmt::format("{}{} in {}\n", i == 0 ? "" : "\n", scene, found.runs[i].formulation) +
            run_of_modes_text(found.runs[i], found.against[i], sweep, count, poles);
  return text;
}

}  // namespace withy
