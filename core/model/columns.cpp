#include "withy/core/model/columns.hpp"

#include <initializer_list>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

using HingeKind = HingeKernel::Kind;

void add(std::vector<Column>& columns, const std::string& name, std::initializer_list<const char*> suffixes,
         const std::string& unit) {
  for (const char* suffix : suffixes) columns.push_back({name + suffix, unit});
}

/// "name", or "name.0", "name.1", … where there are several.
std::string numbered(const std::string& name, std::size_t index, std::size_t count) {
  return count == 1 ? name : name + '.' + std::to_string(index);
}

}  // namespace

std::vector<Column> coordinate_columns(const HingeNode& hinge) {
  const auto kernel = hinge.hinge->kernel();
  std::vector<Column> c;
  if (!kernel) {
    const std::size_t count = hinge.hinge->coordinates();
    for (std::size_t i = 0; i < count; ++i) c.push_back({numbered(hinge.name, i, count), ""});
    for (const HingeRate& rate : hinge_rates(*hinge.hinge)) {
      if (rate.coordinate) c[*rate.coordinate].unit = rate.angular ? "rad" : "m";
    }
    return c;
  }
  if (kernel->kind == HingeKind::revolute) add(c, hinge.name, {""}, "rad");
  if (kernel->kind == HingeKind::prismatic) add(c, hinge.name, {""}, "m");
  if (kernel->kind == HingeKind::spherical || kernel->kind == HingeKind::free)
    add(c, hinge.name, {".qw", ".qx", ".qy", ".qz"}, "1");
  if (kernel->kind == HingeKind::free) add(c, hinge.name, {".x", ".y", ".z"}, "m");
  return c;
}

std::vector<Column> columns_of(const SensorNode& sensor) {
  std::vector<Column> columns;
  for (const SensorColumn& c : sensor.sensor->columns())
    columns.push_back({c.component.empty() ? sensor.name : sensor.name + '.' + c.component, c.unit});
  return columns;
}

std::vector<Column> rate_columns(const HingeNode& hinge) {
  const auto kernel = hinge.hinge->kernel();
  std::vector<Column> c;
  if (!kernel) {
    for (const HingeRate& rate : hinge_rates(*hinge.hinge))
      c.push_back({numbered(hinge.name + ".rate", c.size(), hinge.hinge->speeds()), rate.angular ? "rad/s" : "m/s"});
    return c;
  }
  if (kernel->kind == HingeKind::revolute) add(c, hinge.name, {".rate"}, "rad/s");
  if (kernel->kind == HingeKind::prismatic) add(c, hinge.name, {".rate"}, "m/s");
  if (kernel->kind == HingeKind::spherical || kernel->kind == HingeKind::free)
    add(c, hinge.name, {".wx", ".wy", ".wz"}, "rad/s");
  if (kernel->kind == HingeKind::free) add(c, hinge.name, {".vx", ".vy", ".vz"}, "m/s");
  return c;
}

}  // namespace withy
