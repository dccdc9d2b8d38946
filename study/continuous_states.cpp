#include "withy/study/continuous_states.hpp"

#include <fmt/format.h>

#include "withy/study/input_error.hpp"

namespace withy::study {

void refuse_continuous_states(const Prepared& prepared, const char* analysis) {
  const Layout& layout = prepared.model().layout();
  for (const LoadSlot& slot : layout.continuous_slots) {
    if (slot.count == 0) continue;
    throw InputError(
        fmt::format("{}: load '{}' has differential equations of its own ({}), which {} knows nothing of: "
                    "leave it out, or ask 'withy linearize' for the matrix A of the whole",
                    prepared.scene.file, prepared.model().loads()[slot.load].name,
                    layout.continuous_names[slot.first - layout.positions - layout.speeds], analysis));
  }
}

}  // namespace withy::study
