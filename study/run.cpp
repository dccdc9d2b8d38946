#include "withy/study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <optional>
#include <utility>

#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/changing_equations.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/agreement.hpp"
#include "withy/study/check_loads.hpp"
#include "withy/study/fast_course.hpp"
#include "withy/study/growth.hpp"
#include "withy/study/indicators.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/own_instants.hpp"
#include "withy/study/remedy.hpp"
#include "withy/study/rung_plan.hpp"
#include "withy/study/sampled_growth.hpp"
#include "withy/study/sensitive_motion.hpp"
#include "withy/study/step_limit.hpp"
#include "withy/study/third_order.hpp"

namespace withy::study {
namespace {

RunOptions options_of(const Prepared& prepared, const Control& control) {
  RunOptions options = run_options(prepared.scene);
  options.interrupted = control.interrupted;
  return options;
}

void add_sentence(std::string& text, const std::string& sentence) {
  if (!text.empty() && !sentence.empty()) text += ' ';
  text += sentence;
}

/// Whether the wall time between checkpoints has passed since the last one was written: a disk that takes longer than
/// this to write one does not stop the run. It is asked at each step; the clock is read about every millisecond.
class Timer {
 public:
  explicit Timer(double seconds) : interval_(seconds), last_(Clock::now()), read_(last_) {}
  [[nodiscard]] bool due() {
    if (++asked_ < enough_) return false;
    const Clock::time_point now = Clock::now();
    const bool brief = now - read_ < std::chrono::milliseconds(1);
    enough_ = brief ? std::min(2 * enough_, 1024) : std::max(enough_ / 2, 1);
    asked_ = 0;
    read_ = now;
    return now - last_ >= interval_;
  }
  void restart() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> interval_;
  Clock::time_point last_, read_;
  int asked_ = 0, enough_ = 1;
};

/// Names of the outputs whose statistics the scene asks for.
std::vector<std::string> watched_outputs(const Scene& scene) {
  std::vector<std::string> names;
  const Value* outputs = scene.source.find("outputs");
  for (const auto& [name, output] : outputs == nullptr ? std::vector<Value::Member>{} : outputs->members())
    if (const Value* asked = output.find("statistics"); asked != nullptr && asked->boolean()) names.push_back(name);
  return names;
}

/// The run of some equations, which may change. \param looking may be null
RunSummary run_equations(const Prepared& prepared, const RunSettings& settings, const EquationsOfMotion& equations,
                         ChangingEquations* changing, const EquationsOfMotion* beyond, Looking* looking) {
  const Scene& scene = prepared.scene;
  RunOptions options = options_of(prepared, settings.control);
  options.beyond = beyond;
  if (looking != nullptr) options.remember = [looking](Memory& memory) { looking->remember(memory); };
  options.changing = changing;
  Timer timer(settings.checkpoint_seconds);
  if (settings.checkpoint)
    options.checkpoint = [&](const Checkpoint& checkpoint) {
      settings.checkpoint(checkpoint);
      timer.restart();
    };
  options.resume = settings.resume;
  options.seen = settings.seen;
  watch_poles(prepared, options);
  if (settings.checkpoint_seconds > 0) options.checkpoint_due = [&] { return timer.due(); };
  std::optional<StatisticsWatch> watch;
  std::vector<std::string> watched = watched_outputs(scene);
  watched.insert(watched.end(), settings.watched.begin(), settings.watched.end());
  if (!watched.empty() && settings.statistics != nullptr)
    watch.emplace(scene.outputs, watched, equations, discontinuities(*scene.model),
                  StepParts(*scene.model, scene.initial.time, options.end));
  RunSummary summary = withy::simulate(
      *scene.model, equations, *scene.integrator, scene.initial, options,
      [&](const State& state) {
        settings.control.tell(state.time, options.end);
        if (looking != nullptr) looking->look(state);
        if (settings.output) settings.output(state, changing != nullptr ? changing->rung() : 0);
      },
      watch ? &*watch : nullptr);
  if (watch) *settings.statistics = watch->results();
  return summary;
}

/// The run of formulation `auto`, by its plan.
RunSummary run_planned(const Prepared& prepared, Registry& registry, const RunSettings& settings, RungPlan& plan) {
  std::vector<Stretch> stretches;
  for (const PlannedStretch& s : plan.stretches) stretches.push_back(s.stretch);
  ChangingEquations equations(prepared.rungs, std::move(stretches));
  Agreement agreement(prepared, equations, plan);
  RunSummary summary = run_equations(prepared, settings, equations, &equations, nullptr, &agreement);
  plan.run_evaluations = equations.evaluations();
  if (summary.status != RunStatus::completed) return summary;
  std::string problem = plan.problem;
  if (plan.throughout) {
    const OtherRuns others = others_of(prepared, registry, settings.control, agreement, summary, plan);
    plan.apart = others.apart;
    plan.sensitive = others.sensitive;
    add_sentence(problem, plan.sensitive);
  } else if (agreement.apart() > another_motion) {
    add_sentence(problem, agreement.text());
  }
  if (problem.empty()) return summary;
  summary.status = RunStatus::inaccurate;
  add_sentence(problem, summary.message);
  summary.message = std::move(problem);
  return summary;
}

RunSummary run_plainly(const Prepared& prepared, const RunSettings& settings, const EquationsOfMotion* beyond) {
  return run_equations(prepared, settings, *prepared.equations, nullptr, beyond, nullptr);
}

/// Where there is no estimate: why, and what is known without one.
std::string without_estimate(const Prepared& prepared, const RunSummary& summary, const std::optional<Beyond>& beyond,
                             const RunSettings& settings) {
  if (!flexible(prepared.model()))
    return "no body is flexible: all formulations are the same; what integration leaves is not estimated: another "
           "tolerance tells";
  if (summary.status == RunStatus::interrupted) return "not estimated: the run was interrupted";
  if (!loops_of(prepared.model()).empty())
    return "not estimated: loops are closed (constraints), and two formulations in one run know trees alone";
  if (has_switches(prepared.model()) && beyond)
    return "not estimated: " + own_instants(prepared.model()) + "; two formulations in one run need common instants";
  if (!(summary.final.time > prepared.scene.initial.time)) return "not estimated: no motion of this run can be trusted";
  if (prepared.scene.formulation->terms().strain == StrainOrder::exact && !beyond)
    return "nothing is left out: kinematics is exact and nothing is truncated";
  if (beyond && !beyond->highest) return "not estimated: `--estimate always` asks for it";
  std::string third = "terms of third order in the deflection are neglected";
  // What second-order kinematics was measured to be off by at a state (ThirdOrder). What a motion is off by after a
  // while is more, for frequencies are wrong by that and phases run apart.
  if (const std::optional<Bend> most = greatest_bend(summary))
    third += ", " + third_order_text(*most) + "; the error of the run grows with time and may be many times larger";
  const std::string lacking = beyond ? "" : without_exact_kinematics(prepared.model());
  if (!lacking.empty())
    return third + "; not measured, for " + lacking +
           " has no kinematics of higher order, and what is compared with has one for all bodies";
  if (!beyond) return third + "; not measured, for no model of higher order can treat all bodies of the scene";
  return third +
         (settings.estimate == Estimate::never ? "" : "; `--estimate always` compares with " + beyond->formulation);
}

/// What the error against another formulation does not contain, where it is asked for and can be told.
MoreModesOutcome more_modes(const Prepared& prepared, Registry& registry, const RunSummary& summary,
                            const RunSettings& settings, bool comparable) {
  if (!settings.look_beyond || !can_be_refined(prepared.scene)) return {};
  if (settings.estimate != Estimate::always) return {{}, "`--estimate always` compares with one more of each"};
  if (has_switches(prepared.model()))
    return {{}, own_instants(prepared.model()) + "; two runs that are compared need common instants"};
  if (!comparable) return {{}, "no motion of this run can be compared"};
  return with_one_mode_more(prepared, registry, summary.final.time, settings.control.interrupted);
}

/// What steps of a fixed size did not see, as a sentence of its own.
void add_unseen(const Prepared& prepared, RunSummary& summary) {
  const std::optional<FastCourse> unseen = unseen_course(prepared, prepared.scene.initial);
  if (!unseen) return;
  std::string text = unseen->text;
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  add_sentence(summary.message, text + ".");
}

/// Of a run that was interrupted before it began.
RunSummary not_begun(const Prepared& prepared) {
  RunSummary summary;
  summary.status = RunStatus::interrupted;
  summary.final = begun(prepared.model(), *prepared.equations, prepared.scene.initial);
  summary.reached = summary.final.time;
  const std::size_t speeds = prepared.model().layout().speeds;
  summary.peak_effort.assign(speeds, 0.0);
  summary.peak_motion_effort.assign(speeds, 0.0);
  summary.message = "the run was interrupted before it began, while its formulations were chosen: run it again";
  return summary;
}

bool wanted(Estimate estimate, const Beyond& beyond) {
  return estimate == Estimate::always || (estimate == Estimate::automatic && !beyond.highest);
}

/// What grows in a run that ended badly, why, and what to do.
std::string why_it_grew(const Prepared& prepared, const RunSummary& summary) {
  const std::string sampled = sampled_growth_text(prepared, summary);
  return growth_text(prepared, summary) + (sampled.empty() ? remedy_text(prepared, summary) : sampled);
}

CertifiedRun run_by_plan(const Prepared& prepared, Registry& registry, const RunSettings& settings) {
  CertifiedRun result;
  RungPlan plan = plan_rungs(prepared, registry, asked_accuracy(prepared.scene), settings.control);
  result.summary = settings.control.stop() ? not_begun(prepared) : run_planned(prepared, registry, settings, plan);
  add_unseen(prepared, result.summary);
  // What is inaccurate here is the choice, and nothing grows.
  if (result.summary.status != RunStatus::inaccurate) result.summary.message += why_it_grew(prepared, result.summary);
  std::string why_not = plan.throughout ? without_difference(prepared, plan, result.summary) : "";
  std::optional<ErrorEstimate> estimate;
  if (!plan.throughout) estimate = plan.estimate;
  if (estimate) estimate->end = result.summary.final.time;
  result.certificate =
      certify(prepared, {&result.summary, nullptr, std::move(plan), std::move(estimate), std::move(why_not)}, registry);
  return result;
}

/// What the model up neglects itself, where that may come to what deflections are told to be off by; else empty.
/// \param terms of the model up
std::string neglected_up(const Prepared& prepared, const RunSummary& summary, const ErrorEstimate& estimate,
                         const Terms& terms) {
  const std::optional<Bend> most = greatest_bend(summary);
  if (!most || terms.strain == StrainOrder::exact) return {};
  double range = 0, off = 0;
  for (const BodyNode& body : prepared.model().bodies())
    if (const auto ratio = summary.peak_deflection_ratio.find(body.name); ratio != summary.peak_deflection_ratio.end())
      range = std::max(range, ratio->second * body.body->shape().length);
  for (const auto& [name, distance] : estimate.distances.deflections) off = std::max(off, distance);
  if (!(third_order_over_a_run(*most) * range > off)) return {};
  return fmt::format("{} itself neglects terms of third order in the deflection, {}: its deflections may be as far off",
                     estimate.against, third_order_text(*most));
}

/// The error of a run against the model up, or why it is not known. \param comparable with a run of another model
EstimateOutcome estimate_of(const Prepared& prepared, Registry& registry, const RunSettings& settings,
                            const std::optional<Beyond>& beyond, const RunSummary& summary, bool comparable) {
  EstimateOutcome outcome;
  if (beyond && wanted(settings.estimate, *beyond) && comparable && loops_of(prepared.model()).empty())
    outcome =
        estimate_error(prepared.scene, *prepared.equations, *beyond, summary, registry,
                       settings.estimate == Estimate::always ? Price::any : Price::tenth, settings.control.interrupted);
  if (outcome.estimate)
    outcome.estimate->lacks =
        neglected_up(prepared, summary, *outcome.estimate, make_formulation(registry, beyond->formulation)->terms());
  if (summary.status != RunStatus::interrupted && settings.control.stop())
    outcome = {{}, "not estimated: the estimate was interrupted"};
  if (outcome.why_not.empty() && !outcome.estimate && settings.look_beyond)
    outcome.why_not = without_estimate(prepared, summary, beyond, settings);
  return outcome;
}

CertifiedRun run_in_one_formulation(const Prepared& prepared, Registry& registry, const RunSettings& settings) {
  CertifiedRun result;
  RunSummary& summary = result.summary;
  std::optional<Beyond> beyond;
  if (settings.look_beyond) beyond = next_model_up(prepared, registry);
  summary = run_plainly(prepared, settings, beyond ? beyond->equations.get() : nullptr);
  if (const Value* closing = prepared.scene.source.find("closing")) add_sentence(summary.message, closing->text());
  add_unseen(prepared, summary);
  summary.message += why_it_grew(prepared, summary);
  const bool comparable = !has_switches(prepared.model()) && summary.status != RunStatus::interrupted &&
                          summary.final.time > prepared.scene.initial.time;
  EstimateOutcome estimate = estimate_of(prepared, registry, settings, beyond, summary, comparable);
  std::vector<DroppedForces> dropped;
  if (beyond) dropped = dropped_terms(prepared, *beyond, summary.validity.along, registry);
  result.certificate = certify(prepared,
                               {&summary,
                                beyond ? &*beyond : nullptr,
                                {},
                                std::move(estimate.estimate),
                                std::move(estimate.why_not),
                                std::move(dropped),
                                more_modes(prepared, registry, summary, settings, comparable)},
                               registry);
  return result;
}

[[noreturn]] void refuse_at_integrator(const Prepared& prepared, std::string why) {
  const Place& place = prepared.scene.source.at("integrator").place();
  throw SceneError(prepared.scene.file, {{{place.line, place.column, "/integrator"}, std::move(why)}},
                   prepared.values.origins());
}

}  // namespace

void check_integrator(const Prepared& prepared) {
  const Scene& scene = prepared.scene;
  try {
    static_cast<void>(start_stepper(*scene.integrator, *prepared.equations, scene.initial,
                                    "integrator '" + scene.integrator_name + "'"));
  } catch (const std::invalid_argument& e) {
    refuse_at_integrator(prepared, e.what());
  }
}

void refuse_integrator(const Prepared& prepared, const std::string& deed) {
  refuse_at_integrator(prepared, fmt::format("integrator '{}' {}", prepared.scene.integrator_name, deed));
}

void check_start(const Prepared& prepared) {
  const Scene& scene = prepared.scene;
  const auto refuse = [&](const Place& place, std::string why) {
    throw SceneError(scene.file, {{place, std::move(why)}}, prepared.values.origins());
  };
  check_integrator(prepared);
  check_loads(prepared);
  const Value& integrator = scene.source.at("integrator");
  const Place chosen{integrator.place().line, integrator.place().column, "/integrator"};
  if (const auto rate = unsolvable_rate(prepared.model(), *prepared.equations, scene.initial)) {
    const std::string& name = prepared.model().hinges()[rate->hinge].name;
    const Value* hinge = scene.source.at("hinges").find(name);  // null: of a segment
    refuse(hinge != nullptr ? hinge->place() : scene.source.at("hinges").place(), rate->why);
  }
  const Value* rtol = integrator.find("rtol");
  const std::string why =
      unattainable(prepared.model(), *prepared.equations, scene.initial, rtol != nullptr ? rtol->number() : 1.0);
  if (why.empty()) return;
  if (rtol == nullptr) refuse(chosen, why);
  const bool given = prepared.values.find("integrator.rtol") != nullptr;
  refuse(rtol->place(), fmt::format("{} {}, an accuracy that cannot be had: {}", given ? "got" : "the default is",
                                    brief(rtol->number()), why));
}

CertifiedRun run(const Prepared& prepared, Registry& registry, const RunSettings& settings) {
  try {
    return prepared.escalates() ? run_by_plan(prepared, registry, settings)
                                : run_in_one_formulation(prepared, registry, settings);
  } catch (const IntegratorError& e) {
    refuse_integrator(prepared, e.deed());
  }
}

std::string outcome_text(const RunSummary& summary) {
  if (summary.status == RunStatus::completed)
    return summary.ended_by_event ? fmt::format("completed by an event at {:.4g} s", summary.reached) : "completed";
  return fmt::format("{} at {:.4g} s", name(summary.status), summary.reached);
}

RunSummary simulate(const Prepared& prepared, Registry& registry, const std::function<void(const State&)>& output,
                    const Control& control) try {
  RunSettings settings;
  settings.control = control;
  settings.output = [&](const State& state, std::size_t) {
    if (output) output(state);
  };
  if (prepared.escalates()) {
    RungPlan plan = plan_rungs(prepared, registry, asked_accuracy(prepared.scene), settings.control);
    return settings.control.stop() ? not_begun(prepared) : run_planned(prepared, registry, settings, plan);
  }
  return run_plainly(prepared, settings, nullptr);
} catch (const IntegratorError& e) {
  refuse_integrator(prepared, e.deed());
}

}  // namespace withy::study
