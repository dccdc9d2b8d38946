#include "withy/study/sampled_growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/small_motions.hpp"

namespace withy::study {
namespace {

std::string names_of_sampled(const Model& model) {
  std::vector<std::string> names;
  for (const LoadSlot& slot : sampled_slots(model)) {
    const std::string& name = model.loads()[slot.load].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

/// The greatest growth about a steady state where sampled loads hold what they hold there [1/s].
double growth_as_held(Configuration at, const State& steady) {
  at.set_state(steady);
  const Eigen::MatrixXd A = SmallMotions(at, {}).A();
  if (A.rows() == 0) return 0;
  return poles({A, Eigen::MatrixXd::Zero(A.rows(), 0), Eigen::MatrixXd::Zero(0, A.rows()), Eigen::MatrixXd()})
      .real()
      .maxCoeff();
}

}  // namespace

std::string sampled_growth_text(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const bool may_grow = summary.status == RunStatus::diverged || summary.status == RunStatus::step_underflow;
  if (!may_grow || sampled_slots(model).empty() || model.layout().speeds > largest_examined || !loops_of(model).empty())
    return {};
  try {
    const Configuration c(prepared, prepared.scene.initial, {});
    const ModesAt at = modes_at(c, false);
    if (!at.problem.empty() || at.modes.empty()) return {};
    const Mode& fastest = *std::max_element(at.modes.begin(), at.modes.end(),
                                            [](const Mode& a, const Mode& b) { return a.growth() < b.growth(); });
    const double lasted = summary.reached - prepared.scene.initial.time;
    if (!unstable(at, fastest) || !(fastest.growth() * lasted > 1)) return {};
    const double held = growth_as_held(c, at.steady->steady.state);
    const double vibrates = std::abs(fastest.eigenvalue.imag());
    return fmt::format(
        " About the steady state near the start the loop of what is sampled, {}, every {:.4g} s, is unstable: small "
        "motions grow by {:.3g}/s{}, most of them {}; with what is held kept as it is there {}. What to do: smaller "
        "gains, or a shorter 'sample': withy modes tells where nothing grows any more.",
        names_of_sampled(model), at.period, fastest.growth(),
        vibrates > 0 ? fmt::format(", vibrating at {:.3g} rad/s", vibrates) : "", dominating(at, fastest),
        held > 1e-3 * fastest.growth() ? fmt::format("they grow by {:.3g}/s", held) : "nothing grows");
  } catch (const InputError&) {  // a load switches, or there is no common period
    return {};
  } catch (const std::domain_error&) {  // there are no derivatives
    return {};
  }
}

}  // namespace withy::study
