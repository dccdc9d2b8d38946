#include "withy/campaign/cases.hpp"

#include <algorithm>
#include <utility>

#include "withy/campaign/derived.hpp"
#include "withy/campaign/overlaps.hpp"
#include "withy/campaign/trials.hpp"

namespace withy::campaign {
namespace {

// Shares of a distribution that one at a time takes where an axis has no levels: one deviation of a normal value.
constexpr double low_share = 0.15865525393145705, high_share = 0.8413447460685429;

/// Whether no path leads to what another leads to, or to a part of it.
bool apart(const std::vector<std::string>& paths) {
  for (const std::string& path : paths)
    for (const std::string& other : paths)
      if (&path != &other && (path == other || is_within(path, other))) return false;
  return true;
}

std::size_t levels_alone(const Axis& axis) { return axis.drawn() ? 2 : axis.levels.size(); }

}  // namespace

Cases::Cases(const Plan& plan) : plan_(plan), paths_(varied_paths(plan)), apart_(apart(paths_)) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    if (plan.axes[a].sampling == Sampling::sobol) sobol_.push_back(a);
  switch (plan.design) {
    case Design::product:
      size_ = plan.cases;
      for (const std::size_t n : plan.grids) size_ *= n;
      break;
    case Design::one_at_a_time:
      size_ = 1;
      for (const Axis& axis : plan.axes) size_ += levels_alone(axis);
      break;
    case Design::morris:
      size_ = plan.cases * (plan.axes.size() + 1);
      break;
    case Design::saltelli:
      size_ = plan.cases * (plan.axes.size() + 2);
      break;
  }
}

CaseValues Cases::values(std::uint64_t index) const {
  CaseValues values = of_axes(index);
  for (const Derived& d : plan_.derived)
    values.emplace_back(Value(value_of(d, plan_.base->scene.source, values).value()));
  return values;
}

CaseValues Cases::of_axes(std::uint64_t index) const {
  switch (plan_.design) {
    case Design::one_at_a_time:
      return alone(index);
    case Design::morris:
      return on_trajectory(index);
    case Design::saltelli:
      return of_samples(index);
    case Design::product:
      break;
  }
  return of_product(index);
}

void Cases::set(SceneValues& scene, const CaseValues& values, const std::string& origin) const {
  for (std::size_t a = 0; a < values.size(); ++a)
    if (values[a]) set_or_take(scene, paths_[a], *values[a], origin);
}

SceneValues Cases::scene(const CaseValues& values, const std::string& origin) const {
  SceneValues scene = plan_.base->values;
  set(scene, values, origin);
  return scene;
}

SceneValues Cases::scene(const CaseValues& values, const std::string& origin, std::vector<SceneValues>& spare) const {
  if (spare.empty() || !spares(values)) return scene(values, origin);
  SceneValues scene = std::move(spare.back());
  spare.pop_back();
  scene.set_again(plan_.base->values);
  set(scene, values, origin);
  return scene;
}

bool Cases::spares(const CaseValues& values) const {
  return apart_ && std::all_of(values.begin(), values.end(), [](const std::optional<Value>& value) {
           return value && value->kind() == Value::Kind::number;
         });
}

CaseValues Cases::of_product(std::uint64_t index) const {
  const std::uint64_t draw = index % plan_.cases, point = index / plan_.cases;
  std::vector<std::size_t> at(plan_.grids.size());
  std::uint64_t rest = point;
  for (std::size_t g = at.size(); g-- > 0; rest /= plan_.grids[g]) at[g] = rest % plan_.grids[g];
  const std::vector<double> numbers = drawn(Key(plan_.seed)[point], draw);
  CaseValues values;
  for (std::size_t a = 0; a < plan_.axes.size(); ++a) {
    const Axis& axis = plan_.axes[a];
    values.emplace_back(axis.drawn() ? Value(axis.distribution.quantile(numbers[a])) : axis.levels.at(at[axis.grid]));
  }
  return values;
}

/// Shares of the axes that are drawn, between 0 and 1.
std::vector<double> Cases::drawn(const Key& key, std::uint64_t draw) const {
  std::vector<double> shares(plan_.axes.size());
  const std::vector<double> point =
      sobol_.empty() ? std::vector<double>() : sobol_point(key["sobol"], draw, sobol_.size());
  for (std::size_t i = 0; i < sobol_.size(); ++i) shares[sobol_[i]] = point[i];
  for (std::size_t a = 0; a < plan_.axes.size(); ++a) {
    const Axis& axis = plan_.axes[a];
    const Key own = key[axis.path];
    if (axis.drawn() && axis.sampling == Sampling::plain) shares[a] = own[draw].uniform();
    if (axis.sampling == Sampling::latin)
      shares[a] = (static_cast<double>(permuted(own["order"], draw, plan_.cases)) + own[draw].uniform()) /
                  static_cast<double>(plan_.cases);
  }
  // Correlated by a Gaussian copula: z = L ζ with ζ independent.
  const std::size_t n = plan_.correlated.size();
  std::vector<double> independent(n);
  for (std::size_t i = 0; i < n; ++i) independent[i] = normal_quantile(shares[plan_.correlated[i]]);
  for (std::size_t i = 0; i < n; ++i) {
    double z = 0;
    for (std::size_t j = 0; j <= i; ++j) z += plan_.cholesky[i * n + j] * independent[j];
    shares[plan_.correlated[i]] = normal_share(z);
  }
  return shares;
}

CaseValues Cases::alone(std::uint64_t index) const {
  CaseValues values(plan_.axes.size());
  if (index-- == 0) return values;
  std::size_t a = 0;
  for (; index >= levels_alone(plan_.axes[a]); ++a) index -= levels_alone(plan_.axes[a]);
  const Axis& axis = plan_.axes[a];
  values[a] =
      axis.drawn() ? Value(axis.distribution.quantile(index == 0 ? low_share : high_share)) : axis.levels.at(index);
  return values;
}

MorrisTrajectory morris_trajectory(const Plan& plan, std::uint64_t number) {
  const Key key = Key(plan.seed)["morris"][number];
  const auto levels = static_cast<std::uint64_t>(plan.levels);
  const std::size_t n = plan.axes.size();
  MorrisTrajectory trajectory;
  // Levels are the middles of equal shares, so that distributions without ends have finite values; a step goes over
  // half of them, up from the lower half and down from the upper.
  std::vector<double> step(n);
  for (std::size_t a = 0; a < n; ++a) {
    const std::uint64_t level = key[plan.axes[a].path].bits() % levels;
    trajectory.begin.push_back((static_cast<double>(level) + 0.5) / static_cast<double>(levels));
    step[a] = level < levels / 2 ? 0.5 : -0.5;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto a = static_cast<std::size_t>(permuted(key["order"], k, n));
    trajectory.steps.push_back({a, step[a]});
  }
  return trajectory;
}

CaseValues Cases::on_trajectory(std::uint64_t index) const {
  const std::size_t n = plan_.axes.size();
  MorrisTrajectory trajectory = morris_trajectory(plan_, index / (n + 1));
  for (std::size_t k = 0; k < index % (n + 1); ++k)
    trajectory.begin[trajectory.steps[k].axis] += trajectory.steps[k].step;
  CaseValues values;
  for (std::size_t a = 0; a < n; ++a)
    values.emplace_back(Value(plan_.axes[a].distribution.quantile(trajectory.begin[a])));
  return values;
}

/// Cases of a sample: its first point, that with each column of the second in turn, the second.
CaseValues Cases::of_samples(std::uint64_t index) const {
  const std::size_t n = plan_.axes.size();
  const std::uint64_t place = index % (n + 2);
  const std::vector<double> both = sobol_point(Key(plan_.seed)["saltelli"], index / (n + 2), 2 * n);
  CaseValues values;
  for (std::size_t a = 0; a < n; ++a) {
    const bool second = place == n + 1 || place == a + 1;
    values.emplace_back(Value(plan_.axes[a].distribution.quantile(both[second ? n + a : a])));
  }
  return values;
}

}  // namespace withy::campaign
