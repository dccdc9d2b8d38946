#include "withy/study/stability.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {

std::optional<Stability> stability_of(const Configuration& steady) {
  Stability found;
  const std::size_t free = free_speeds(steady.held()).size();
  if (free == 0 && steady.layout().continuous == 0 && !steady.sampled()) return {};
  // Eigenvalues cost the cube of their number.
  if (free > largest_examined) {
    found.unknown = fmt::format("there are {} free coordinates, and beyond {} modes are not looked at here", free,
                                largest_examined);
    return found;
  }
  try {
    const ModesAt at = modes_at(steady, true);
    if (!at.problem.empty()) {
      found.unknown = at.problem;
    } else if (at.turn && !at.turn->shaking.empty()) {
      found.unknown = shaking_text(at.turn->shaking) +
                      ", and modes of one instant tell nothing; --floquet with --period looks at a period after which "
                      "everything repeats";
    } else if (at.frozen()) {
      found.unknown = "the equations of small motions change as the hinges turn, and modes at one angle tell nothing";
    }
    if (!found.unknown.empty()) return found;
    for (const Mode& mode : at.modes) {
      if (mode.rigid) ++found.unheld;
      if (!unstable(at, mode)) continue;
      ++found.growing;
      if (mode.growth() <= found.growth) continue;
      found.growth = mode.growth();
      found.most = dominating(at, mode);
      found.vibrates = mode.eigenvalue.imag() != 0;
    }
  } catch (const InputError& e) {
    found.unknown = e.what();
  }
  return found;
}

std::string stability_text(const std::optional<Stability>& stability) {
  if (!stability) return {};
  const Stability& s = *stability;
  if (!s.unknown.empty()) return fmt::format("Whether it is stable is not known: {}. See withy modes.", s.unknown);
  if (s.growing > 0)
    return fmt::format(
        "It is unstable: {} by {:.3g}/s{}, most in {}. Nothing stays there by itself: for a state that is stable start "
        "nearer to one (--at).",
        s.growing > 1 ? fmt::format("{} small motions about it grow, the fastest", s.growing)
                      : "a small motion about it grows",
        s.growth, s.vibrates ? ", vibrating" : "", s.most);
  return s.unheld > 0 ? fmt::format("No small motion about it grows; nothing holds {} of them.", s.unheld)
                      : "It is stable: no small motion about it grows.";
}

}  // namespace withy::study
