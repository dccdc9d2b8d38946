#include "withy/study/timed_loads.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/analysis/turn.hpp"

namespace withy::study {
namespace {

/// Times after a state [s] at which a load is looked at: near ones, for what is fast, and ones all over the rest of the
/// run, in no ratio to each other, for what begins late or is the same after a period.
std::vector<double> times_after(const Configuration& c, const State& state) {
  constexpr int octaves = 20, intervals = 16;
  constexpr double without_end = 100;
  const double left = c.prepared().scene.end.value_or(state.time) - state.time, span = left > 0 ? left : without_end;
  std::vector<double> times;
  for (int k = 1; k <= octaves; ++k) times.push_back(std::ldexp(span, -k));
  for (int k = 0; k < intervals; ++k)
    for (const double share : in_no_ratio) times.push_back(span * (k + share) / intervals);
  return times;
}

}  // namespace

std::vector<std::string> timed_loads(const Configuration& c, const State& state) {
  constexpr double rounding = 1e-9;  // of the load's greatest effort
  const Model& model = c.prepared().model();
  const std::vector<double> times = times_after(c, state);
  const EquationsOfMotion& equations = *c.prepared().equations;
  Work work = equations.make_work();
  std::vector<double> now(model.layout().speeds), later(now.size());
  std::vector<std::string> names;
  for (std::size_t load = 0; load < model.loads().size(); ++load) {
    equations.load_efforts(state.time, state.y, static_cast<int>(load), now, work);
    double greatest = 0, change = 0;
    for (const double after : times) {
      equations.load_efforts(state.time + after, state.y, static_cast<int>(load), later, work);
      for (std::size_t s = 0; s < now.size(); ++s) {
        greatest = std::max({greatest, std::abs(now[s]), std::abs(later[s])});
        // What holds a hinge bears what acts on it.
        if (!c.held()[s]) change = std::max(change, std::abs(later[s] - now[s]));
      }
    }
    if (change > rounding * greatest) names.push_back(model.loads()[load].name);
  }
  return names;
}

bool small_motions_change(const Configuration& c, const State& state, const Tangents& now) {
  constexpr double differenced = 1e-6;  // of the greatest element: derivatives of some loads are differences
  // Soon after: far from where a law is by then, a controller is at its limit.
  constexpr int first = 8, last = 20, every = 3;
  const double span = times_after(c, state).front() * 2;
  const auto differs = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.size() > 0 && (a - b).cwiseAbs().maxCoeff() > differenced * a.cwiseAbs().maxCoeff();
  };
  for (int k = first; k <= last; k += every) {
    const double t = state.time + std::ldexp(span, -k);
    const Tangents then = c.dynamics().tangents(t, state.y, c.dynamics().steady_accelerations(t));
    if (differs(now.by_position, then.by_position) || differs(now.by_speed, then.by_speed) ||
        differs(now.by_state, then.by_state) || differs(now.rate_by_position, then.rate_by_position) ||
        differs(now.rate_by_speed, then.rate_by_speed) || differs(now.rate_by_state, then.rate_by_state))
      return true;
  }
  return false;
}

}  // namespace withy::study
