#include "withy/study/check_loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/addition_fault.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/tangents/load_derivatives.hpp"

namespace withy::study {
namespace {

bool has_foreign_laws(const Model& model) {
  return std::any_of(model.loads().begin(), model.loads().end(),
                     [](const LoadNode& node) { return dynamic_cast<const ForeignLaw*>(node.load.get()) != nullptr; });
}

/// With the discrete states of a run. \throws SceneError where there is no run: a clock is too fast for the time
State state_of_start(const Prepared& prepared) {
  const Scene& scene = prepared.scene;
  try {
    return begun(prepared.model(), *prepared.equations, scene.initial);
  } catch (const std::invalid_argument& e) {
    const Value* loads = scene.source.find("loads");
    throw SceneError(scene.file, {{loads != nullptr ? loads->place() : Place{}, e.what()}}, prepared.values.origins());
  }
}

[[noreturn]] void refuse_load(const Prepared& prepared, const std::string& name, std::string why) {
  const Scene& scene = prepared.scene;
  Place place;
  // Constraints and some motions are loads of the model too.
  for (const char* key : {"loads", "constraints", "motions"})
    if (const Value* parts = scene.source.find(key); parts != nullptr)
      if (const Value* part = parts->find(name); part != nullptr && place.path.empty()) place = part->place();
  throw SceneError(scene.file, {{place, std::move(why)}}, prepared.values.origins());
}

/// Why the discrete part of a load is none at a state; empty where it is one.
std::string discrete_fault(const LoadNode& node, const Layout& layout, const State& state) {
  const std::span<const double> y(state.y), held = node.discrete(y);
  if (std::any_of(held.begin(), held.end(), [](double d) { return std::isnan(d); }))
    return fmt::format("load '{}' begins with no number in its discrete states", node.name);
  const DiscretePart& part = *node.load->discrete();
  if (part.switches() == 0) return {};
  std::vector<double> values(part.switches());
  part.switching(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), held, values);
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  if (bad == values.end()) return {};
  return fmt::format("load '{}' switches where functions are zero, and number {} of them has no value at {} s",
                     node.name, bad - values.begin(), state.time);
}

}  // namespace

void check_load_derivatives(const Prepared& prepared, const State& state) {
  const Model& model = prepared.model();
  if (model.loads().empty() || has_foreign_laws(model)) return;
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (std::string why = addition_fault(model, l, state); !why.empty())
      refuse_load(prepared, model.loads()[l].name, std::move(why));
  if (const auto wrong = false_derivative(model, state))
    refuse_load(prepared, model.loads()[wrong->load].name, wrong->what);
}

void check_loads(const Prepared& prepared) {
  const Model& model = prepared.model();
  if (model.loads().empty() || has_foreign_laws(model)) return;
  const State state = state_of_start(prepared);
  for (const LoadSlot& slot : model.layout().discrete_slots)
    if (const std::string why = discrete_fault(model.loads()[slot.load], model.layout(), state); !why.empty())
      refuse_load(prepared, model.loads()[slot.load].name, why);
  check_load_derivatives(prepared, state);
}

}  // namespace withy::study
