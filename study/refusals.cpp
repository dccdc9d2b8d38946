#include "withy/study/refusals.hpp"

#include <fmt/format.h>

#include "withy/core/model/closing.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {

void refuse_loops(const Prepared& prepared, const char* analysis) {
  const auto loops = loops_of(prepared.model());
  if (loops.empty()) return;
  throw InputError(fmt::format(
      "{}: constraint '{}' closes a loop, and {} knows trees alone: leave the constraints out, or simulate with "
      "'withy run'",
      prepared.scene.file, loops.front()->name(), analysis));
}

void refuse_states_of_loads(const Prepared& prepared, const char* analysis) {
  const Layout& layout = prepared.model().layout();
  for (const LoadSlot& slot : layout.continuous_slots) {
    if (slot.count == 0) continue;
    throw InputError(
        fmt::format("{}: load '{}' has differential equations of its own ({}), which {} knows nothing of: "
                    "leave it out, or ask 'withy linearize' for the matrix A of the whole",
                    prepared.scene.file, prepared.model().loads()[slot.load].name,
                    layout.continuous_names[slot.first - layout.positions - layout.speeds], analysis));
  }
  for (const LoadSlot& slot : sampled_slots(prepared.model()))
    throw InputError(fmt::format("{}: load '{}' is sampled, which {} knows nothing of: leave it out, or its 'sample'",
                                 prepared.scene.file, prepared.model().loads()[slot.load].name, analysis));
}

}  // namespace withy::study
