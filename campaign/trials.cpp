#include "withy/campaign/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "withy/campaign/derived.hpp"
#include "withy/campaign/overlaps.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

/// A quantity as the number that cases have in its place.
Value in_si(const Value& value) {
  if (value.kind() != Value::Kind::text) return value;
  const AnyQuantity read = read_any_quantity(value.text());
  return read.value ? Value(*read.value) : value;
}

bool is_quantity(const Value& value) {
  return value.kind() == Value::Kind::text && in_si(value).kind() == Value::Kind::number;
}

/// Values of a plan, tried together.
class Trials {
 public:
  Trials(const Plan& plan, const SceneValues& base, const std::vector<Trial>& trials, Registry& registry, Tried& tried)
      : plan_(plan), base_(base), trials_(trials), registry_(registry), tried_(tried), own_(plan.axes.size()) {
    tried_.source = made(base_).source;
    tried_.beside.resize(plan.axes.size());
    first_ = own_;
    if (plan.design == Design::one_at_a_time) return;
    for (const Trial& trial : trials)
      if (!trial.end && !first_[trial.axis]) first_[trial.axis] = trial.value;
  }

  void try_value(const Trial& trial, Problems& problems) {
    if (is_taken(trial)) return;
    CaseValues values = first_;
    values[trial.axis] = trial.value;
    const SceneValues scene = with(std::move(values), true, trial.axis);
    try {
      static_cast<void>(made(scene));
    } catch (const SceneError& e) {
      problems.add(e, scene);
    }
  }

  void try_row(const TrialRow& row) {
    CaseValues values = tried_.beside[row.front().first];
    if (values.empty()) values = first_;
    for (const auto& [axis, value] : row) values[axis] = value;
    static_cast<void>(takes(values));
  }

 private:
  SceneValues with(CaseValues values, bool derive, std::optional<std::size_t> last = {}) const {
    SceneValues scene = base_;
    set_values(plan_, tried_.source, std::move(values), derive, scene, last);
    return scene;
  }

  Scene made(const SceneValues& values) {
    Scene scene = make_scene(values, registry_);
    for (const FileUsed& file : scene.sources.files) tried_.sources.add(file);
    for (const PluginUsed& plugin : scene.sources.plugins) tried_.sources.add(plugin);
    return scene;
  }

  bool takes(const CaseValues& values, bool derive = true) try {
    static_cast<void>(made(with(values, derive)));
    return true;
  } catch (const SceneError&) {
    return false;
  }

  bool is_taken(const Trial& trial) {
    const auto beside = [&](CaseValues values, bool derive = true) {
      values[trial.axis] = trial.value;
      if (!takes(values, derive)) return false;
      last_ = values;
      CaseValues& kept = tried_.beside[trial.axis];
      if (kept.empty() || (is_quantity(trial.value) && !is_quantity(*kept[trial.axis]))) kept = std::move(values);
      return true;
    };
    if (beside(first_) || beside(own_)) return true;
    if (trial.end && !plan_.derived.empty() && beside(first_, false)) return true;
    if (plan_.design == Design::one_at_a_time) return false;
    if (!last_.empty() && beside(last_)) return true;
    for (const Trial& other : trials_) {
      if (other.axis == trial.axis) continue;
      if (left_ == 0) return true;
      --left_;
      CaseValues values = first_;
      values[other.axis] = other.value;
      if (beside(std::move(values))) return true;
    }
    return false;
  }

  const Plan& plan_;
  const SceneValues& base_;
  const std::vector<Trial>& trials_;
  Registry& registry_;
  Tried& tried_;
  CaseValues own_, first_;  ///< nothing of any axis; the first of each
  CaseValues last_;         ///< taken last
  int left_ = 4096;         ///< scenes to find company in; beyond them cases say what is wrong with them
};

}  // namespace

void set_or_take(SceneValues& scene, const std::string& path, const Value& value, const std::string& origin) {
  if (value.kind() != Value::Kind::null || scene.find(path) != nullptr) scene.set(path, value, origin);
}

std::string origin_of(const std::string& file, const Place& place) {
  return fmt::format("{}:{}:{}", file, place.line, place.column);
}

void Problems::add(const SceneError& error, const SceneValues& values) {
  const auto before = static_cast<std::ptrdiff_t>(of_scene_.size());
  for (Diagnostic d : error.problems()) {
    const int line = d.place.line;
    std::string origin = line < 0   ? values.origins()[static_cast<std::size_t>(-line) - 1]
                         : line > 0 ? origin_of(values.file(), d.place)
                                    : values.file();
    auto at = std::find(origins_.begin(), origins_.end(), origin);
    if (at == origins_.end()) at = origins_.insert(origins_.end(), std::move(origin));
    d.place.line = -1 - static_cast<int>(at - origins_.begin());
    d.place.column = 0;
    const bool told = std::any_of(of_scene_.begin(), of_scene_.begin() + before, [&](const Diagnostic& other) {
      return other.place.line == d.place.line && other.place.path == d.place.path;
    });
    if (!told) of_scene_.push_back(std::move(d));
  }
}

void Problems::raise() const {
  if (none()) return;
  std::vector<Diagnostic> all = of_plan_.errors();
  all.insert(all.end(), of_scene_.begin(), of_scene_.end());
  throw SceneError(plan_, std::move(all), origins_);
}

void set_values(const Plan& plan, const Value& source, CaseValues values, bool derive, SceneValues& scene,
                std::optional<std::size_t> last) {
  const auto set = [&](std::size_t a) {
    if (values[a]) set_or_take(scene, plan.axes[a].path, *values[a], origin_of(plan.file, values[a]->place()));
  };
  for (std::size_t a = 0; a < values.size(); ++a) set(a);
  const auto is_part = [&](const Axis& axis) { return is_within(axis.path, plan.axes[*last].path); };
  if (last && std::none_of(plan.axes.begin(), plan.axes.end(), is_part)) set(*last);
  if (!derive) return;
  for (std::optional<Value>& value : values)
    if (value) value = in_si(*value);
  for (const Derived& d : plan.derived) {
    const std::optional<double> number = value_of(d, source, values);
    if (number) scene.set(d.path, Value(*number), origin_of(plan.file, d.place));
    values.emplace_back(number ? Value(*number) : Value());
  }
}

Tried try_values(const Plan& plan, const SceneValues& base, const std::vector<Trial>& trials,
                 const std::vector<TrialRow>& rows, Registry& registry, Problems& problems) {
  Tried tried;
  try {
    Trials all(plan, base, trials, registry, tried);
    for (const Trial& trial : trials) all.try_value(trial, problems);
    for (const TrialRow& row : rows) all.try_row(row);
  } catch (const SceneError& e) {
    problems.add(e, base);
  }
  return tried;
}

std::shared_ptr<study::Prepared> prepared_base(SceneValues base, Registry& registry, const Problems& problems) {
  try {
    return std::make_shared<study::Prepared>(study::prepare(std::move(base), registry));
  } catch (const SceneError&) {
    if (problems.none()) throw;
  } catch (const study::InputError&) {
    if (problems.none()) throw;
  }
  return nullptr;
}

}  // namespace withy::campaign
