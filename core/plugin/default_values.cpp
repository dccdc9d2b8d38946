#include "withy/core/plugin/default_values.hpp"

namespace withy {

Value default_values(const std::vector<ParameterSpec>& specs, const Place& place) {
  Value map = Value::map({}, place);
  for (const ParameterSpec& spec : specs)
    if (spec.fallback) map.set(spec.key, *spec.fallback);
  return map;
}

}  // namespace withy
