#include "withy/scene/start.hpp"

#include <fmt/format.h>

#include <cmath>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
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

}  // namespace

void set_start(const Model& model, const Document& document, const Checker& checker, Scene& scene) {
  scene.initial = model.reference_state();
  for (const LoadNode& l : model.loads()) l.load->begin(scene.initial);
  if (const EventBook book(model); book.any()) book.begin(scene.initial.y);
  const Value* initial = document.root.find("initial");
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
}

}  // namespace withy
