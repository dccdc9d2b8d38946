#include "withy/study/own_equations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "withy/core/equations/compile_equations.hpp"
#include "withy/core/model/compiled_model.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// Rates of a state, or nothing where there are none.
std::vector<double> rates_at(const EquationsOfMotion& equations, const State& state) {
  Work work = equations.make_work();
  std::vector<double> rates(state.y.size());
  if (!equations.derivatives(state.time, state.y, rates, work).ok()) rates.clear();
  return rates;
}

/// Another number for each index, of either sign, between a half and one.
double varied(std::size_t i) {
  const double part = std::fmod(0.618 * static_cast<double>(i + 1), 1.0);
  return (i % 2 == 0 ? 1 : -1) * (0.5 + 0.5 * part);
}

/// The state of a tree of flexible bodies bent by a hundredth of their lengths, at rest. \returns the least of these
double bend(const Model& tree, State& state) {
  constexpr double share = 0.01;
  double least = 1;
  for (std::size_t b = 0; b < tree.bodies().size(); ++b) {
    const Slot* slot = tree.layout().modes(b);
    if (slot == nullptr) continue;
    const double length = tree.bodies()[b].body->shape().length, bent = share * (length > 0 ? length : 1);
    for (std::size_t i = 0; i < slot->positions; ++i) state.y[slot->position + i] = bent * varied(i);
    least = std::min(least, bent);
  }
  return least;
}

/// Speeds that make forces of inertia as large as those of stiffness and weight, beside which they would be rounding.
void set_in_motion(const Model& tree, const std::vector<double>& rates_at_rest, double bent, State& state) {
  const Layout& layout = tree.layout();
  double greatest = 0;
  for (std::size_t s = 0; s < layout.speeds; ++s)
    greatest = std::max(greatest, std::abs(rates_at_rest[layout.positions + s]));
  const double rate = std::sqrt(std::max(1.0, greatest / bent));
  for (std::size_t s = 0; s < layout.speeds; ++s) state.y[layout.positions + s] = rate * varied(s);
  for (const Slot& slot : layout.bodies)
    for (std::size_t i = 0; i < slot.speeds; ++i) state.y[layout.positions + slot.speed + i] *= bent;
}

}  // namespace

void check_own_equations(const Prepared& prepared, const State& state) {
  const Scene& scene = prepared.scene;
  const Model& model = prepared.model();
  std::shared_ptr<const Model> tree;
  std::unique_ptr<EquationsOfMotion> own, of_terms;
  try {
    tree = std::make_shared<const Model>(model.bodies(), model.hinges(), model.gravity());
    own = compile_model(*scene.formulation, tree);
    of_terms = compile_equations(tree, scene.formulation->terms());
  } catch (const std::invalid_argument&) {
    return;
  }
  const Layout& layout = tree->layout();
  State trial = tree->reference_state();
  std::copy_n(state.y.begin(), layout.positions, trial.y.begin());
  const double bent = bend(*tree, trial);
  const std::vector<double> at_rest = rates_at(*of_terms, trial);
  if (at_rest.empty()) return;
  set_in_motion(*tree, at_rest, bent, trial);
  const std::vector<double> mine = rates_at(*own, trial), theirs = rates_at(*of_terms, trial);
  if (mine.empty() || theirs.empty()) return;
  constexpr double rounding = 1e-6;
  double greatest = 0, off = 0;
  std::size_t worst = 0;
  for (std::size_t s = 0; s < layout.speeds; ++s) {
    const std::size_t i = layout.positions + s;
    greatest = std::max({greatest, std::abs(mine[i]), std::abs(theirs[i])});
    if (std::abs(mine[i] - theirs[i]) <= off) continue;
    off = std::abs(mine[i] - theirs[i]);
    worst = s;
  }
  if (!(off > rounding * greatest)) return;
  throw InputError(fmt::format(
      "{}: analyses of small motions and steady states go by the terms of a formulation, and those of '{}' are not its "
      "equations: where all moves, the acceleration of {} is {:.4g} by these and {:.4g} by its terms",
      scene.file, scene.formulation_name, layout.speed_names[worst], mine[layout.positions + worst],
      theirs[layout.positions + worst]));
}

}  // namespace withy::study
