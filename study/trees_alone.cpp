#include "withy/study/trees_alone.hpp"

#include <fmt/format.h>

#include "withy/core/model/closing.hpp"
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

}  // namespace withy::study
