#include "withy/core/model/columns.hpp"

#include <algorithm>
#include <array>
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

/// Behind the name of a body: what tables tell of its tip.
constexpr std::array<const char*, 6> tip_columns = {
    "tip.x", "tip.y", "tip.z", "tip.deflection_x", "tip.deflection_y", "tip.deflection_z"};

/// All that tables tell of a hinge, of its motion too if it has one.
std::vector<std::string> column_names_of(const HingeNode& hinge) {
  std::vector<std::string> names;
  for (const Column& c : coordinate_columns(hinge)) names.push_back(c.name);
  for (const Column& c : rate_columns(hinge)) names.push_back(c.name);
  for (const Column& c : motion_effort_columns(hinge)) names.push_back(c.name);
  return names;
}

}  // namespace

std::string spelled_in_tables(const std::string& name) {
  std::string text = name;
  std::erase(text, ']');
  std::replace(text.begin(), text.end(), '[', '.');
  return text;
}

std::string mode_name_fault(const Model& model, std::size_t body) {
  const BodyNode& node = model.bodies()[body];
  const bool has_tip = !node.segment && node.frame("tip") >= 0;  // a whole in segments has another name
  const int hinge = model.hinge(node.name);
  std::vector<std::string> of_hinge;
  if (hinge >= 0) of_hinge = column_names_of(model.hinges()[static_cast<std::size_t>(hinge)]);
  for (const std::string& mode : node.body->shape().mode_names) {
    const std::string spelled = spelled_in_tables(mode);
    for (const std::string& name : {spelled, spelled + ".rate"}) {
      if (has_tip && std::find(tip_columns.begin(), tip_columns.end(), name) != tip_columns.end())
        return "a mode is named '" + mode + "', and tables of results have the column '" + node.name + '.' + name +
               "' of the body's tip";
      if (std::find(of_hinge.begin(), of_hinge.end(), node.name + '.' + name) != of_hinge.end())
        return "a mode is named '" + mode + "', and tables of results have the column '" + node.name + '.' + name +
               "' of the hinge '" + node.name + "'";
    }
  }
  return {};
}

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

std::vector<Column> motion_effort_columns(const HingeNode& hinge) {
  std::vector<Column> c;
  for (const HingeRate& rate : hinge_rates(*hinge.hinge))
    c.push_back({numbered(hinge.name + ".motion_effort", c.size(), hinge.hinge->speeds()), rate.angular ? "N m" : "N"});
  return c;
}

std::string unit_of_effort(const Model& model, std::size_t speed) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    if (speed >= slot.speed && speed < slot.speed + slot.speeds)
      return hinge_rates(*model.hinges()[h].hinge)[speed - slot.speed].angular ? "N m" : "N";
  }
  return {};
}

}  // namespace withy
