#include "withy/campaign/case_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "withy/core/equations/lane_equations.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/step_watch.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"
#include "withy/study/step_limit.hpp"

namespace withy::campaign {

template <class Action>
void CaseRun::refusing(Action&& action) {
  const auto refuse = [this](const char* why) {
    result_.status = "refused";
    result_.message = why;
    kept_.reset();
    prepared_.reset();
  };
  try {
    action();
  } catch (const SceneError& e) {
    refuse(e.what());
  } catch (const study::InputError& e) {
    refuse(e.what());
  } catch (const std::invalid_argument& e) {
    refuse(e.what());
  } catch (const IntegratorError& e) {  // no case can be trusted
    throw e.named(prepared_->scene.integrator_name);
  }
}

CaseRun::CaseRun(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry, CaseParts& parts)
    : plan_(plan), cases_(cases), registry_(registry), parts_(parts) {
  result_.index = index;
  result_.values = cases.values(index);
  refusing([&] {
    SceneValues scene = cases.scene(result_.values, fmt::format("case {}", index), parts.values);
    prepared_.emplace(study::prepare(std::move(scene), registry, parts.scene));
    kept_.emplace(plan, *prepared_, parts.kept);
  });
}

CaseRun::~CaseRun() {
  if (prepared_ && cases_.spares(result_.values) && parts_.values.size() < parts_.values.capacity())
    parts_.values.push_back(std::move(prepared_->values));
}

std::string CaseRun::alone_because() const {
  if (!plan_.lanes) return "the plan says so";
  if (prepared_->escalates()) return "the formulation changes along a run";
  if (!kept_->watched().empty()) return "what outputs have been over the run is kept";
  constexpr std::array<std::string_view, 3> explicit_ones = {"rk4", "dopri5", "dop853"};
  const std::string& integrator = prepared_->scene.integrator_name;
  if (std::find(explicit_ones.begin(), explicit_ones.end(), integrator) == explicit_ones.end())
    return "the integrator is " + integrator + "; need rk4, dopri5 or dop853";
  return lane_refusal(*prepared_->equations);
}

RunSummary CaseRun::simulate(const EquationsOfMotion& equations, const study::Control& control) {
  const Scene& scene = prepared_->scene;
  if (prepared_->escalates()) {
    study::RunSettings settings;
    settings.look_beyond = false;
    settings.output = [this](const State& state, std::size_t rung) { kept_->see_output(state, rung); };
    settings.control.interrupted = control.interrupted;  // progress is that of many cases
    settings.watched = kept_->watched();
    settings.statistics = &statistics_;
    return study::run(*prepared_, registry_, settings).summary;
  }
  RunOptions options = study::run_options(scene);
  options.interrupted = control.interrupted;
  study::watch_poles(*prepared_, options);
  if (kept_->watches_steps()) {
    // A checkpoint after every step has its state, and changes nothing in a run.
    options.checkpoint_due = [] { return true; };
    options.checkpoint = [this](const Checkpoint& checkpoint) { kept_->see(checkpoint.state, 0); };
  }
  std::optional<StatisticsWatch> watch;
  if (!kept_->watched().empty())
    watch.emplace(scene.outputs, kept_->watched(), equations, discontinuities(*scene.model),
                  StepParts(*scene.model, scene.initial.time, options.end));
  RunSummary summary = withy::simulate(
      *scene.model, equations, *scene.integrator, scene.initial, options,
      [this](const State& state) { kept_->see_output(state, 0); }, watch ? &*watch : nullptr, Attention::outcome);
  if (watch) statistics_ = watch->results();
  return summary;
}

void CaseRun::run(const EquationsOfMotion& equations, const study::Control& control) {
  refusing([&] {
    const RunSummary summary = simulate(equations, control);
    result_.status = name(summary.status);
    if (result_.completed()) {
      result_.numbers = kept_->numbers(summary, statistics_);
      // Times that an event has left out have no numbers.
      const std::vector<double> histories = kept_->histories();
      result_.numbers.insert(result_.numbers.end(), histories.begin(), histories.end());
    } else {
      result_.message = summary.message;
    }
  });
}

}  // namespace withy::campaign
