#include "withy/scene/orientation.hpp"

#include <Eigen/Geometry>
#include <optional>

#include "withy/core/spatial/direction.hpp"

namespace withy {
namespace {

using Quaternion = Eigen::Quaterniond;

Quaternion about(const Eigen::Vector3d& unit, double angle) { return Quaternion(Eigen::AngleAxisd(angle, unit)); }

Value value_of(const Quaternion& q, const Place& place) {
  std::vector<Value> numbers;
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) numbers.emplace_back(x, place);
  return Value::list(std::move(numbers), place);
}

std::vector<ParameterSpec> axis_and_angle() {
  return {vector("axis", 3, "1", "axis of the rotation, of any length but zero"),
          number("angle", "rad", "angle of the rotation about its axis, right-handed")};
}

std::vector<ParameterSpec> three_angles() {
  return {vector("xyz", 3, "rad", "angles of the rotations about x, the new y and the new z")};
}

}  // namespace

bool is_orientation(const ParameterSpec& spec) {
  return spec.kind == ParameterSpec::Kind::vector && spec.count == 4 && spec.key == "orientation" && spec.unit == "1";
}

std::vector<std::vector<ParameterSpec>> orientation_forms() { return {axis_and_angle(), three_angles()}; }

std::optional<Value> read_orientation(const Value& map, const Checker& checker) {
  if (map.has("xyz")) {
    const auto checked = checker.check_members(map, three_angles());
    if (!checked) return {};
    const std::vector<double> a = checked->at("xyz").numbers();
    using Eigen::Vector3d;
    return value_of(about(Vector3d::UnitX(), a[0]) * about(Vector3d::UnitY(), a[1]) * about(Vector3d::UnitZ(), a[2]),
                    map.place());
  }
  const auto checked = checker.check_members(map, axis_and_angle());
  if (!checked) return {};
  const std::vector<double> a = checked->at("axis").numbers();
  const std::optional<Vector3> axis = unit_along(Vector3(a[0], a[1], a[2]));
  if (!axis) {
    checker.diagnostics().error(map.at("axis").place(), "got an axis of length 0; need a direction");
    return {};
  }
  return value_of(about(*axis, checked->number_at("angle")), map.place());
}

}  // namespace withy
