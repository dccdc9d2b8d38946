/// \file
/// Studies of whole runs of a scene, as JSON text.
#include <nlohmann/json.hpp>

#include "withy/host/asked_scene.hpp"
#include "withy/host/scene.hpp"
#include "withy/results/advice_json.hpp"
#include "withy/results/advice_text.hpp"
#include "withy/results/comparison_report.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/results/trade_files.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/left_out.hpp"
#include "withy/study/unfit.hpp"

namespace withy::host {
namespace {

/// The axes asked for, those of `usual` where nothing is.
study::Axes axes_of(const Scene::Axes& asked, study::Axes usual) {
  const auto take = [](const auto& given, auto& target) {
    if (!given.empty()) target.assign(given.begin(), given.end());
  };
  take(asked.formulations, usual.formulations);
  take(asked.families, usual.families);
  take(asked.modes, usual.modes);
  take(asked.integrators, usual.integrators);
  take(asked.tolerances, usual.tolerances);
  study::check_axes(usual);
  return usual;
}

std::string advice_of(const study::Prepared& prepared, const study::Outputs& outputs, const study::Accuracy& accuracy,
                      const study::Advice& advice, study::Evaluator& evaluator) {
  const AdviceQuestion question{prepared, outputs, accuracy};
  if (!advice.choice) {
    const std::string why = advice.interrupted ? "interrupted" : no_advice_text(advice, question);
    return json_line(search_json(question, advice, why));
  }
  std::vector<std::string> changes;
  for (const study::Change& change : study::new_changes(prepared.scene, advice.choice->point, evaluator.registry()))
    changes.push_back(change.text());
  return json_line(advice_json(question, advice, study::left_out(evaluator.model(advice.choice->point)), changes,
                               scene_lines(changes)));
}

}  // namespace

std::string Scene::compare(const std::vector<std::string>& formulations, const std::string& reference,
                           const Follow& follow, const std::vector<std::string>& outputs) const {
  const std::shared_ptr<const study::Prepared> base = with_outputs(*this, outputs);
  std::vector<study::Unfit> left_out;
  const std::vector<std::string> chosen =
      formulations.empty() ? study::usual_formulations(base->scene, library().registry(), left_out) : formulations;
  std::vector<ComparisonAt> compared;
  compared.push_back({{},
                      study::compare(
                          base->values, library().registry(), chosen, reference,
                          [&](const study::Prepared& prepared, const std::function<void(const State&)>& output) {
                            return study::simulate(prepared, library().registry(), output, control_of(follow));
                          },
                          outputs)});
  return json_line(comparison_json(compared, reference, {}, left_out, library().registry()));
}

std::string Scene::trade(const Axes& axes, std::size_t jobs, const Follow& follow,
                         const std::vector<std::string>& outputs) const {
  const std::shared_ptr<const study::Prepared> base = with_outputs(*this, outputs);
  const study::Axes all = study::trade_axes(axes_of(axes, {}), base->scene, library().registry());
  study::TradeStudy study(*base, library().registry(), study::points_of(all),
                          {jobs, nullptr, control_of(follow), outputs});
  study.run();
  const auto results = study.results();
  return json_line(trade_json(base->scene, study, results, study::pareto_front(results)));
}

std::string Scene::advise(const std::string& accuracy, const std::vector<std::string>& outputs, const Axes& axes,
                          const Follow& follow) const {
  return advise(accuracy, outputs, axes, follow, {});
}

std::string Scene::advise(const std::string& accuracy, const std::vector<std::string>& outputs, const Axes& axes,
                          const Follow& follow, std::optional<double> seconds) const {
  const std::shared_ptr<const study::Prepared> base = with_outputs(*this, outputs);
  const study::Accuracy asked = study::Accuracy::parse(accuracy);
  const study::Outputs measured(base->model(), outputs, base->scene.outputs);
  const study::Candidates candidates =
      study::candidates_for(*base, library().registry(), axes_of(axes, study::usual_axes()));
  study::Evaluator evaluator(*base, library().registry(), measured, control_of(follow));
  const study::Advice advice = study::advise(evaluator, candidates, asked, {}, seconds);
  return advice_of(*base, measured, asked, advice, evaluator);
}

}  // namespace withy::host
