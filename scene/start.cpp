#include "withy/scene/start.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/plugin_call.hpp"
#include "withy/scene/constraints.hpp"
#include "withy/scene/state.hpp"

namespace withy {
namespace {

// What integration may have left between a driven hinge and its motion, for states that a run has written.
constexpr double driven_tolerance = 1e-6;

/// Reports what `initial` says of driven hinges against their motions.
void check_driven(const Model& model, const Scene& scene, const Checker& checker) {
  State moved = scene.initial;
  model.prescribe(moved);
  for (const MotionNode& node : model.motions()) {
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(node.hinge)];
    const auto compare = [&](std::size_t first, std::size_t count, const char* key) {
      for (std::size_t i = first; i < first + count; ++i) {
        const double given = scene.initial.y[i], needed = moved.y[i];
        if (!std::isfinite(needed) || std::abs(given - needed) <= driven_tolerance * (1 + std::abs(needed))) continue;
        checker.key_error(fmt::format("/initial/hinges/{}/{}", slot.name, key),
                          fmt::format("got {}, but motion '{}' has the hinge at {} at {} s; leave it out", given,
                                      node.name, needed, moved.time));
      }
    };
    compare(slot.position, slot.positions, "position");
    compare(model.layout().positions + slot.speed, slot.speeds, "rate");
  }
}

/// Has a load begin. \throws std::invalid_argument where it cannot, or changes more of the state than its numbers; the
/// state is then as it was.
void begin_load(const LoadNode& load, State& state) {
  State begun = state;
  plugin_call("load '" + load.name + "' does not begin", [&] { load.load->begin(begun); });
  std::string why;
  if (begun.y.size() != state.y.size())
    why = fmt::format("leaves {} numbers in the state where there are {}", begun.y.size(), state.y.size());
  else if (begun.time != state.time)
    why = fmt::format("sets the time to {} s, which the scene says ('initial')", begun.time);
  if (!why.empty()) throw std::invalid_argument(fmt::format("load '{}' does not begin: it {}", load.name, why));
  state = std::move(begun);
}

/// Where loads have the simulation begin; reports those that leave no number there.
void begin_loads(const Model& model, const Checker& checker, State& state) {
  for (const LoadNode& load : model.loads()) {
    try {
      begin_load(load, state);
    } catch (const std::invalid_argument& e) {
      checker.key_error("/loads/" + load.name, e.what());
      continue;
    }
    for (std::size_t i = 0; i < model.layout().positions + model.layout().speeds; ++i) {
      if (std::isfinite(state.y[i])) continue;
      checker.key_error("/loads/" + load.name,
                        fmt::format("load '{}' has the simulation begin where a {} is {}", load.name,
                                    i < model.layout().positions ? "coordinate" : "rate", state.y[i]));
      state.y[i] = 0;
    }
  }
}

/// Reports the states of loads' own that begin where there is no number.
void check_continuous(const Model& model, const Checker& checker, const State& state) {
  for (const LoadSlot& slot : model.layout().continuous_slots)
    for (std::size_t i = 0; i < slot.count; ++i)
      if (const double number = state.y[slot.first + i]; !std::isfinite(number))
        checker.key_error("/loads/" + model.loads()[slot.load].name,
                          fmt::format("its state '{}' begins {}", model.loads()[slot.load].continuous->name(i),
                                      std::isnan(number) ? "with no number" : "beyond the range of numbers"));
}

/// The time at which the scene begins; 0 where it says none that is right, which is reported where all is read.
double time_of(const Document& document, const Value* initial, const Model& model) {
  State state = model.reference_state();
  if (initial == nullptr || initial->kind() != Value::Kind::map || !initial->has("time")) return state.time;
  Diagnostics aside;
  Registry none;
  set_state(Value::map({{"time", initial->at("time")}}, initial->place()), model, Checker(document, none, aside),
            state);
  return aside.ok() ? state.time : 0;
}

}  // namespace

void set_start(const Model& model, const Document& document, const Checker& checker, Scene& scene) {
  const Value* initial = document.root.find("initial");
  scene.initial = model.reference_state();
  scene.initial.time = time_of(document, initial, model);
  begin_loads(model, checker, scene.initial);
  if (const EventBook book(model); book.any()) book.begin(scene.initial.y);
  const Value stated = initial != nullptr ? without_guess(*initial, model, checker, scene.initial) : Value();
  const Value* given = initial != nullptr ? &stated : nullptr;
  if (given != nullptr) {
    set_state(*given, model, checker, scene.initial);
    scene.source.set("initial", *initial);
    check_driven(model, scene, checker);
  }
  model.prescribe(scene.initial);
  for (const MotionNode& node : model.motions()) {
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(node.hinge)];
    const double at = scene.initial.y[slot.position], rate = scene.initial.y[model.layout().positions + slot.speed];
    if (std::isfinite(at) && std::isfinite(rate)) continue;
    checker.key_error(
        "/motions/" + node.name,
        fmt::format("has no finite coordinate and rate at {} s, where the simulation begins", scene.initial.time));
  }
  if (checker.diagnostics().ok() && !loops_of(model).empty()) {
    const Value remark = close_loops(model, scene, given, checker, scene.initial);
    if (remark.kind() == Value::Kind::text) scene.source.set("closing", remark);
  }
  if (model.layout().continuous == 0) return;
  // Where the loads' own states begin depends on all else; what the scene says of them goes first.
  model.begin_continuous(scene.initial);
  const Value* loads = given == nullptr ? nullptr : given->find("loads");
  if (loads != nullptr && checker.diagnostics().ok())
    set_state(Value::map({{"loads", *loads}}, given->place()), model, checker, scene.initial);
  if (checker.diagnostics().ok()) check_continuous(model, checker, scene.initial);
}

}  // namespace withy
