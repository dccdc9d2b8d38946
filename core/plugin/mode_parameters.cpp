#include "withy/core/plugin/mode_parameters.hpp"

#include <algorithm>
#include <limits>

namespace withy {
namespace {

void collect(const Value& map, const std::vector<ParameterSpec>& specs, const std::string& prefix,
             std::vector<ModeCount>& counts) {
  for (const ParameterSpec& spec : specs) {
    const Value* given = map.find(spec.key);
    if (given == nullptr) continue;
    if (spec.kind == ParameterSpec::Kind::map) collect(*given, spec.members, prefix + spec.key + ".", counts);
    if (spec.role != ParameterSpec::Role::modes) continue;
    ModeCount count;
    count.path = prefix + spec.key;
    count.strain = prefix.substr(0, prefix.empty() ? 0 : prefix.size() - 1);
    count.modes = static_cast<std::size_t>(given->number());
    count.least = static_cast<std::size_t>(spec.minimum.value_or(0));
    count.most = spec.maximum ? static_cast<std::size_t>(*spec.maximum) : std::numeric_limits<std::size_t>::max();
    const auto family = std::find_if(specs.begin(), specs.end(), [](const ParameterSpec& s) {
      return s.role == ParameterSpec::Role::bending_family;
    });
    if (family != specs.end()) {
      count.family_path = prefix + family->key;
      if (const Value* chosen = map.find(family->key)) count.family = *chosen;
    }
    counts.push_back(std::move(count));
  }
}

}  // namespace

std::string ModeCount::family_id() const {
  if (family.kind() == Value::Kind::text) return family.text();
  return family.kind() == Value::Kind::map ? family.text_at("name") : "";
}

std::vector<ModeCount> mode_counts(const Value& body, const std::vector<ParameterSpec>& specs) {
  std::vector<ModeCount> counts;
  collect(body, specs, "", counts);
  return counts;
}

}  // namespace withy
