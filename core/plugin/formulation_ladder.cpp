#include "withy/core/plugin/formulation_ladder.hpp"

#include <algorithm>
#include <stdexcept>

namespace withy {
namespace {

/// Null where the plugin needs options or cannot be used.
std::shared_ptr<const Formulation> made(Registry& registry, const Plugin<Formulation>& plugin) {
  Value options = Value::map({});
  for (const ParameterSpec& spec : plugin.parameters) {
    if (spec.fallback) options.set(spec.key, *spec.fallback);
    if (spec.required && !spec.fallback) return nullptr;
  }
  Diagnostics diagnostics;
  try {
    return plugin.make(options, {registry, diagnostics});
  } catch (const std::exception&) {
    return nullptr;
  }
}

}  // namespace

std::vector<RankedFormulation> formulations_by_rank(Registry& registry) {
  std::vector<RankedFormulation> all;
  for (const std::string& id : registry.ids<Formulation>()) {
    const Plugin<Formulation>* plugin = nullptr;
    try {
      plugin = registry.find<Formulation>(id);
    } catch (const PluginError&) {
      continue;
    }
    if (plugin == nullptr) continue;
    if (auto formulation = made(registry, *plugin)) {
      const Standing standing = formulation->standing();
      all.push_back({id, plugin->summary, standing, std::move(formulation)});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.standing.rank < b.standing.rank; });
  return all;
}

std::vector<std::string> studied_formulations(Registry& registry) {
  std::vector<std::string> ids;
  for (const RankedFormulation& f : formulations_by_rank(registry))
    if (f.standing.studied) ids.push_back(f.id);
  return ids;
}

std::vector<RankedFormulation> formulation_rungs(Registry& registry) {
  std::vector<RankedFormulation> rungs = formulations_by_rank(registry);
  std::erase_if(rungs, [](const RankedFormulation& f) { return !f.standing.rung; });
  if (rungs.empty()) throw std::invalid_argument("no formulation is a rung of 'auto'; its plugins are not found");
  return rungs;
}

}  // namespace withy
