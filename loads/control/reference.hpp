/// \file
/// What a controller is to follow: a number, a table over time, or a motion.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/trajectory.hpp"

namespace withy {

/// `reference` and `motion`.
inline std::vector<ParameterSpec> reference_parameters(const char* unit) {
  return {
      number("reference", unit, "what the signal is to be; a table: time and value, a smooth curve through the rows")
          .or_table("s")
          .optional(),
      text("motion", "in its place a motion plugin with its options").naming(ParameterSpec::Refers::motion).optional()};
}

/// Zero where the scene gives none; nothing after a reported error.
inline std::optional<Trajectory> read_reference(const Value& p, const MakeContext& context) {
  const Value* given = p.find("reference");
  const Value* motion = p.find("motion");
  const auto error = [&](const char* message) {
    context.diagnostics.error(motion->place(), message);
    return std::optional<Trajectory>{};
  };
  if (motion != nullptr) {
    if (given != nullptr) return error("there is a 'reference' too; need one of the two");
    const auto* plugin = context.registry.find<Motion>(motion->text_at("type"));
    std::shared_ptr<const Motion> made = plugin != nullptr ? plugin->make(*motion, context) : nullptr;
    if (made == nullptr) return {};
    if (made->locks()) return error("holds a hinge where it is; it is nothing to follow");
    return PluginMotion{std::move(made), 1};
  }
  if (given == nullptr) return Hold{};
  if (given->kind() == Value::Kind::number) return Hold{given->number()};
  std::vector<double> times, values;
  for (const Value& row : given->items()) {
    times.push_back(row.items()[0].number());
    values.push_back(row.items()[1].number());
  }
  return Spline(std::move(times), std::move(values));
}

inline std::vector<double> jumps_of(const Trajectory& trajectory) {
  return std::visit([](const auto& motion) { return motion.jumps(); }, trajectory);
}
inline double end_of(const Trajectory& trajectory) {
  return std::visit([](const auto& motion) { return motion.end(); }, trajectory);
}

}  // namespace withy
