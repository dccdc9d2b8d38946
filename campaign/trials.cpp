#include "withy/campaign/trials.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

/// Makes a scene for what it is made from. \throws SceneError
void add_sources(const SceneValues& values, Registry& registry, SceneSources& sources) {
  const Scene scene = make_scene(values, registry);
  for (const FileUsed& file : scene.sources.files) sources.add(file);
  for (const PluginUsed& plugin : scene.sources.plugins) sources.add(plugin);
}

/// Makes a scene for its problems; false where there are any.
bool make(const SceneValues& values, Registry& registry, Problems& problems, SceneSources& sources) {
  try {
    add_sources(values, registry, sources);
    return true;
  } catch (const SceneError& e) {
    problems.add(e, values);
    return false;
  }
}

void try_row(SceneValues values, const TrialRow& row, const std::string& plan, Registry& registry,
             SceneSources& sources) try {
  for (const auto& [path, value] : row) set_or_take(values, path, value, plan);
  add_sources(values, registry, sources);
} catch (const SceneError&) {
  // Its cases say what is wrong with them.
}

}  // namespace

void set_or_take(SceneValues& scene, const std::string& path, const Value& value, const std::string& origin) {
  if (value.kind() != Value::Kind::null || scene.find(path) != nullptr) scene.set(path, value, origin);
}

std::string origin_of(const std::string& file, const Place& place) {
  return fmt::format("{}:{}:{}", file, place.line, place.column);
}

void Problems::add(const SceneError& error, const SceneValues& values) {
  for (Diagnostic d : error.problems()) {
    const int line = d.place.line;
    std::string origin = line < 0   ? values.origins()[static_cast<std::size_t>(-line) - 1]
                         : line > 0 ? origin_of(values.file(), d.place)
                                    : values.file();
    auto at = std::find(origins_.begin(), origins_.end(), origin);
    if (at == origins_.end()) at = origins_.insert(origins_.end(), std::move(origin));
    d.place.line = -1 - static_cast<int>(at - origins_.begin());
    d.place.column = 0;
    of_scene_.push_back(std::move(d));
  }
}

void Problems::raise() const {
  if (none()) return;
  std::vector<Diagnostic> all = of_plan_.errors();
  all.insert(all.end(), of_scene_.begin(), of_scene_.end());
  throw SceneError(plan_, std::move(all), origins_);
}

SceneSources try_values(const SceneValues& base, const std::vector<Trial>& trials, const std::vector<TrialRow>& rows,
                        const std::string& plan, Registry& registry, Problems& problems) {
  SceneSources sources;
  if (!make(base, registry, problems, sources)) return sources;
  const auto put = [&](SceneValues& values, const Trial& trial) {
    set_or_take(values, trial.path, trial.value, origin_of(plan, trial.value.place()));
  };
  SceneValues first = base;
  std::vector<const Trial*> others;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (i == 0 || trials[i].axis != trials[i - 1].axis)
      put(first, trials[i]);
    else
      others.push_back(&trials[i]);
  }
  if (!make(first, registry, problems, sources)) return sources;
  for (const Trial* trial : others) {
    SceneValues values = first;
    put(values, *trial);
    make(values, registry, problems, sources);
  }
  for (const TrialRow& row : rows) try_row(first, row, plan, registry, sources);
  return sources;
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
