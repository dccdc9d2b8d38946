#include "withy/core/plugin/direction.hpp"

#include "withy/core/spatial/direction.hpp"

namespace withy {

std::optional<Vector3> direction_at(const Value& parameters, std::string_view key, const MakeContext& context) {
  const std::vector<double> v = parameters.at(key).numbers();
  std::optional<Vector3> unit = unit_along(Vector3(v[0], v[1], v[2]));
  if (!unit) context.diagnostics.error(parameters.at(key).place(), "has no length; need a direction");
  return unit;
}

}  // namespace withy
