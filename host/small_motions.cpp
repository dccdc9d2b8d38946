/// \file
/// Steady states of a scene, small motions about them, and what motions take; as JSON text.
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "withy/host/asked_scene.hpp"
#include "withy/host/run_result.hpp"
#include "withy/host/stopped.hpp"
#include "withy/results/equilibrium_text.hpp"
#include "withy/results/inverse_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/linear_files.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/response_files.hpp"
#include "withy/scene/state_as_given.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/formulation_modes.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/inverse.hpp"
#include "withy/study/recorded_motion.hpp"
#include "withy/study/response.hpp"
#include "withy/study/variation_text.hpp"

namespace withy::host {
namespace {

StateAsGiven state_at(const study::Prepared& prepared, const Given& at) {
  if (!at.any()) return prepared.scene.initial;
  return at.text ? parse_state_as_given(*at.text, at.file, prepared.scene)
                 : read_state_as_given(at.file, prepared.scene);
}

/// What `act` makes of the place; where it has no value there, what stops it.
template <class Act>
std::string text_at(const study::Prepared& prepared, const std::vector<std::string>& lock, const Place& place,
                    Act&& act) {
  const study::Holding holding = study::read_holding(prepared.model(), lock, place.spin);
  const study::Configuration at(prepared, state_at(prepared, place.at), holding);
  try {
    return json_line(act(at, holding));
  } catch (const study::Unfelt& e) {
    throw study::InputError(e.what());
  } catch (const std::domain_error& e) {
    // A law may also fail where it is differenced.
    const study::NotFinite found = study::not_finite(at, at.state());
    const char* status = found.failed ? "load-failed" : found.text.empty() ? "singular" : "diverged";
    throw SimulationStopped(status, found.text.empty() ? e.what() : found.text, at.state().time);
  }
}

}  // namespace

std::string Scene::modes(const std::vector<std::string>& lock, const Follow& follow) const {
  return modes(lock, follow, {});
}

std::string Scene::modes(const std::vector<std::string>& lock, const Follow& follow, const ModesWish& wish) const {
  study::ModesQuestion question;
  question.sweep = study::parse_sweep(wish.sweep, "sweep");
  question.wish = study::turning_wish(wish.floquet, wish.blades, wish.period);
  question.as_is = wish.as_is;
  question.compared = wish.count;
  question.masses = wish.effective_mass;
  question.damp = study::read_damping_ratios(wish.damp);
  study::check_question(question);
  const std::shared_ptr<const study::Prepared> base = prepare();
  question.holding = study::read_holding(base->model(), lock, wish.place.spin);
  question.start = [&](const study::Prepared& prepared) { return state_at(prepared, wish.place.at); };
  try {
    const study::ModesFound found = study::find_modes(*base, library().registry(), question,
                                                      [&](const std::string&) { return control_of(follow); });
    nlohmann::ordered_json all = modes_study_json(base->scene.file, question.sweep, found);
    nlohmann::ordered_json run = std::move(all["runs"].front());
    for (const char* beside : {"effective_mass", "damping"})
      if (all.contains(beside)) run[beside] = std::move(all[beside]);
    return json_line(run);
  } catch (const std::domain_error& e) {
    throw study::InputError(e.what());
  }
}

std::string Scene::linearize(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                             const std::vector<std::string>& lock) const {
  return linearize(inputs, outputs, lock, {});
}

std::string Scene::linearize(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                             const std::vector<std::string>& lock, const Place& place) const {
  return text_at(*with_outputs(*this, outputs), lock, place, [&](const study::Configuration& at, const auto&) {
    return linear_model_json(at, study::linear_model(at, {inputs, outputs}));
  });
}

std::string Scene::response(const ResponseWish& wish, const std::vector<std::string>& lock, const Place& place) const {
  const std::vector<std::string> outputs(wish.output.empty() ? 0 : 1, wish.output);
  return text_at(*with_outputs(*this, outputs), lock, place, [&](const study::Configuration& at, const auto&) {
    return response_json(at,
                         study::response(at, {wish.input, wish.output, wish.from, wish.to, wish.points, wish.reduce}));
  });
}

std::string Scene::equilibrium(const std::vector<std::string>& lock, const Place& place) const {
  return text_at(*prepare(), lock, place, [&](const study::Configuration& at, const study::Holding& holding) {
    return equilibrium_json(at, study::find_equilibrium(at, holding, library().registry()));
  });
}

Inverse Scene::inverse(const Given& motion, const Follow& follow) const {
  const auto [led, ignored] = study::led_scene(*prepare(), {motion.file, motion.text}, library().registry());
  study::InverseStudy study(led);
  RunResult run = run_result(led, library().registry(), study.run_settings(control_of(follow)));
  Inverse found;
  found.json = json_line(inverse_json(led.scene, run.summary, study, ignored));
  found.times = study.times();
  for (const study::Drive& drive : study.drives())
    found.drives.push_back({{drive.name, drive.unit}, drive.effort, drive.rate});
  found.run = std::move(run.result);
  return found;
}

}  // namespace withy::host
