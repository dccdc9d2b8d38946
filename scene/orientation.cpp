#include "withy/scene/orientation.hpp"

#include <Eigen/Geometry>

#include "withy/core/plugin/parameters.hpp"

namespace withy {
namespace {

Value quaternion(const Eigen::Quaterniond& q, const Place& place) {
  std::vector<Value> items;
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) items.emplace_back(x, place);
  return Value::list(std::move(items), place);
}

Eigen::Vector3d vector_at(const Value& map, const char* key) {
  const std::vector<double> x = map.at(key).numbers();
  return {x[0], x[1], x[2]};
}

}  // namespace

bool is_orientation(const ParameterSpec& spec) {
  return spec.key == "orientation" && spec.kind == ParameterSpec::Kind::vector && spec.count == 4;
}

std::optional<Value> orientation_of(const Value& map, const Checker& checker) {
  using Turn = Eigen::AngleAxisd;
  if (map.has("xyz")) {
    const auto turns = checker.check_members(map, {vector("xyz", 3, "rad", "turns about x, y and z, in this order")});
    if (!turns) return {};
    const Eigen::Vector3d a = vector_at(*turns, "xyz");
    return quaternion(Turn(a.x(), Eigen::Vector3d::UnitX()) * Turn(a.y(), Eigen::Vector3d::UnitY()) *
                          Turn(a.z(), Eigen::Vector3d::UnitZ()),
                      map.place());
  }
  const auto turn = checker.check_members(
      map, {vector("axis", 3, "1", "axis of the turn; or xyz: [angle, angle, angle], turns about x, y and z"),
            number("angle", "rad", "angle of the turn")});
  if (!turn) return {};
  const Eigen::Vector3d axis = vector_at(*turn, "axis");
  if (!(axis.stableNorm() > 0)) {
    checker.diagnostics().error(turn->at("axis").place(), "got an axis of length 0; need a direction");
    return {};
  }
  return quaternion(Eigen::Quaterniond(Turn(turn->number_at("angle"), axis.stableNormalized())), map.place());
}

}  // namespace withy
