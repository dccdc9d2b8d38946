#include "withy/scene/span.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

constexpr double most_outputs = 1e8;
/// Of steps: a run of more does not come to its end, in hours.
constexpr double most_in_a_run = 1e9;

/// Reports a step of fixed size, or a greatest one, so short that no run comes to its end.
void check_step(const Scene& scene, const Checker& checker) {
  const double span = scene.end.value_or(scene.initial.time) - scene.initial.time;
  for (const char* key : {"step", "max_step"}) {
    const Value* step = scene.source.at("integrator").find(key);
    if (step == nullptr || step->kind() != Value::Kind::number || !(span / step->number() > most_in_a_run)) continue;
    checker.diagnostics().error(
        step->place(), fmt::format("got {} s, which makes {:.3g} steps in a run; need at most {:g}", step->number(),
                                   span / step->number(), most_in_a_run));
  }
}

/// Reports loads whose samples come so often that the last ones of the run are no times of their own, or that no run
/// comes to its end: a step ends at each.
void check_samples(const Model& model, const Scene& scene, const Document& document, const Checker& checker) {
  constexpr double most_samples = 0x1p53;  // beyond, the number of a sample and the next are the same
  const double latest = std::max(std::abs(scene.initial.time), std::abs(scene.end.value_or(0)));
  const double span = scene.end.value_or(scene.initial.time) - scene.initial.time;
  for (const LoadNode& node : model.loads()) {
    const double period = node.load->discrete() == nullptr ? 0 : node.load->discrete()->period();
    const bool apart = !(period > 0) || latest / period < most_samples;
    const bool ends = !(period > 0) || span / period <= most_in_a_run;
    if (apart && ends) continue;
    const Value* load = scene.source.at("loads").find(node.name);
    const Value* sample = load == nullptr ? nullptr : load->find("sample");
    const Place place = sample != nullptr ? sample->place() : document.key_place("/loads/" + node.name);
    checker.diagnostics().error(
        place, !ends ? fmt::format("got a period of {:g} s, which makes {:.3g} samples in a run, with a step at each; "
                                   "need at most {:g}",
                                   period, span / period, most_in_a_run)
                     : fmt::format("got a period of {:g} s, too short to tell samples apart at t = {:g} s; need more "
                                   "than {:.3g} s",
                                   period, latest, latest / most_samples));
  }
}

}  // namespace

void set_span(const Model& model, const Document& document, const Checker& checker, Scene& scene) {
  for (const LoadNode& l : model.loads()) {
    if (const double end = l.load->end(); end > scene.end.value_or(0)) scene.end = end;
  }
  for (const MotionNode& m : model.motions()) {
    if (const double end = m.motion->end(); end > scene.end.value_or(0)) scene.end = end;
  }
  if (const Value* end = scene.source.at("time").find("end")) scene.end = end->number();
  check_samples(model, scene, document, checker);
  check_step(scene, checker);
  if (!scene.end) return;
  const double span = *scene.end - scene.initial.time;
  if (span < 0) {
    checker.key_error("/time/end",
                      fmt::format("got {}; need at least the initial time, {} s", *scene.end, scene.initial.time));
  }
  if (span / scene.output > most_outputs) {
    checker.key_error("/time/output", fmt::format("got {} s, which makes {:.3g} outputs; need at most {:g}",
                                                  scene.output, span / scene.output, most_outputs));
  }
}

double span_of(const Scene& scene) { return scene.end ? *scene.end - scene.initial.time : 0; }

double end_of_run(const Scene& scene) {
  if (scene.end) return *scene.end;
  const Place& time = scene.source.at("time").place();
  throw SceneError(scene.file, {{{time.line, time.column, "/time/end"},
                                 "missing, and no load or motion has an end of its own; need finite >= 0 [s]"}});
}

}  // namespace withy
