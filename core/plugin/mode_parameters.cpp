#include "withy/core/plugin/mode_parameters.hpp"

#include <limits>

namespace withy {
namespace {

/// Of bending, or where there is none what names a family of modes: other strains have no role that studies vary.
const ParameterSpec* family_in(const std::vector<ParameterSpec>& specs) {
  const ParameterSpec* named = nullptr;
  for (const ParameterSpec& spec : specs) {
    if (spec.role == ParameterSpec::Role::bending_family) return &spec;
    if (named == nullptr && spec.refers == ParameterSpec::Refers::mode_family) named = &spec;
  }
  return named;
}

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
    if (const ParameterSpec* family = family_in(specs)) {
      if (family->role == ParameterSpec::Role::bending_family) count.family_path = prefix + family->key;
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
