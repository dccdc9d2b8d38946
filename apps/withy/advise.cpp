#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/advice_report.hpp"
#include "withy/apps/withy/beyond.hpp"
#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/apps/withy/scene_edit.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/scene/document.hpp"

namespace withy::app {
namespace {

/// What the scene does not say already.
std::vector<std::string> new_overrides(const Engine& engine, const AdviseArguments& arguments,
                                       const TradePoint& point) {
  SceneArguments plain = arguments;
  plain.options.overrides.clear();
  std::vector<std::string> all{"formulation=" + point.formulation};
  for (const std::string& o : overrides_at(plain, engine.scene(), point)) {
    const std::size_t equals = o.find('=');
    const Value* at = &engine.scene().source;
    for (std::size_t begin = 0; at != nullptr && begin < equals;) {
      const std::size_t end = std::min(o.find('.', begin), equals);
      at = at->find(o.substr(begin, end - begin));
      begin = end + 1;
    }
    const std::string value = o.substr(equals + 1);
    const bool known =
        at != nullptr && ((at->kind() == Value::Kind::number && fmt::format("{:g}", at->number()) == value) ||
                          (at->kind() == Value::Kind::text && at->text() == value));
    if (!known) all.push_back(o);
  }
  // The integrator beside the formulation.
  std::stable_partition(all.begin(), all.end(), [](const std::string& o) {
    return o.starts_with("formulation=") || o.starts_with("integrator=");
  });
  return all;
}

/// The choice, run as `withy run` does: a deflection past the scene's limit shows there alone.
RunSummary confirm(const Engine& engine, const ProbedModel& model, const TradePoint& point) {
  RunOptions options;
  options.end = end_of_run(model.scene);
  options.output = model.scene.output;
  options.deflection_limit = model.scene.deflection_limit;
  options.interrupted = interrupted;
  return simulate(*model.scene.model, *model.equations, *integrator_at(engine.registry(), point), model.scene.initial,
                  options, {});
}

void write_scene(const AdviseArguments& arguments, const Engine& engine, const std::vector<std::string>& overrides) {
  const std::string text = edited(read_bytes(arguments.scene), overrides);
  // Read as it will be read: an edit that went wrong leaves no file.
  static_cast<void>(parse_scene(text, arguments.write, engine.registry()));
  write_file(arguments.write, text);
}

}  // namespace

ExitStatus advise(const AdviseArguments& arguments) {
  if (!arguments.write.empty() && !arguments.options.overrides.empty())
    throw InputError("--write takes the scene as its file has it: put what --set changes into the file first");
  watch_for_interrupt();
  const Engine engine(arguments);
  Advisor advisor(engine, arguments);
  bool found = advisor.search();
  RunSummary confirmed;
  while (found && !advisor.interrupted()) {
    confirmed = confirm(engine, advisor.model_of(advisor.choice()->point), advisor.choice()->point);
    if (confirmed.status == RunStatus::completed || confirmed.status == RunStatus::interrupted) break;
    found = advisor.reject_choice();
  }
  if (advisor.interrupted() || interrupted()) return ExitStatus::interrupted;
  if (!found) {
    if (arguments.json) print(json_text(search_json(engine, advisor)));
    complain(no_advice_text(advisor));
    return ExitStatus::stopped;
  }
  advisor.look_up();
  const TradePoint point = advisor.choice()->point;
  const StepLimit steps = step_limit(*integrator_at(engine.registry(), point), engine.scene().initial.time, confirmed);
  Advice advice{advisor, engine, confirmed, steps, new_overrides(engine, arguments, point)};
  if (!arguments.write.empty()) write_scene(arguments, engine, advice.overrides);
  std::string text = arguments.json ? json_text(advice_json(advice)) : advice_text(advice);
  if (!arguments.json && !arguments.write.empty()) text += "\nwritten to " + arguments.write + '\n';
  print(text);
  return ExitStatus::done;
}

}  // namespace withy::app
