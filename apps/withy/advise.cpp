#include <nlohmann/json.hpp>

#include "withy/apps/withy/advice_text.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/scene_edit.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/scene/document.hpp"
#include "withy/study/left_out.hpp"

namespace withy::app {
namespace {

void write_scene(const AdviseArguments& arguments, Registry& registry, const std::vector<std::string>& changes) {
  const std::string text = edited(read_bytes(arguments.scene), changes);
  // Read as it will be read: an edit that went wrong leaves no file.
  static_cast<void>(parse_scene(text, arguments.write, registry));
  write_file(arguments.write, text);
}

std::vector<std::string> texts_of(const std::vector<study::Change>& changes) {
  std::vector<std::string> texts;
  for (const study::Change& change : changes) texts.push_back(change.text());
  return texts;
}

}  // namespace

ExitStatus advise(const AdviseArguments& arguments) {
  if (!arguments.write.empty() && !arguments.options.overrides.empty())
    throw InputError("--write takes the scene as its file has it: put what --set changes into the file first");
  const Engine engine(arguments);
  const study::Accuracy accuracy = study::Accuracy::parse(arguments.accuracy);
  const study::Outputs outputs(engine.model(), arguments.outputs);
  const study::Candidates candidates = study::candidates_for(engine.prepared(), engine.registry(), arguments.axes);
  study::Evaluator evaluator(engine.prepared(), engine.registry(), outputs, study_control("advise"));
  const study::Advice advice = study::advise(evaluator, candidates, accuracy);
  const AdviceQuestion question{engine.prepared(), outputs, accuracy};
  if (advice.interrupted) return ExitStatus::interrupted;
  if (!advice.choice) {
    const std::string why = no_advice_text(advice, accuracy);
    if (arguments.json) print(json_text(search_json(question, advice, why)));
    complain(why);
    return ExitStatus::stopped;
  }
  const std::string left_out = study::left_out(evaluator.model(advice.choice->point));
  const std::vector<std::string> changes = texts_of(study::new_changes(engine.scene(), advice.choice->point));
  if (!arguments.write.empty()) write_scene(arguments, engine.registry(), changes);
  std::string text = arguments.json ? json_text(advice_json(question, advice, left_out, changes, scene_lines(changes)))
                                    : advice_text({question, candidates, advice, left_out, changes});
  if (!arguments.json && !arguments.write.empty()) text += "\nwritten to " + arguments.write + '\n';
  print(text);
  return ExitStatus::done;
}

}  // namespace withy::app
