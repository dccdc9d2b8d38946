#include <algorithm>
#include <cmath>

#include "withy/core/plugin/mode_parameters.hpp"
#include "withy/scene/tree.hpp"

namespace withy {
namespace {

/// What makes a body large.
struct Extent {
  double modes = 0;     ///< sum over its numbers of modes
  double greatest = 0;  ///< of them
  double rows = 0;      ///< of all tables
  double segments = 1;  ///< it is cut into
  double turned = 0;    ///< sum over the pieces of its tables of angles over x, as of `twist` [rad]
};

/// Of a value and what is below it.
void measure(const Value& value, Extent& extent) {
  if (value.kind() == Value::Kind::list && !value.items().empty() &&
      value.items().front().kind() == Value::Kind::list) {
    extent.rows += static_cast<double>(value.items().size());
  }
  for (const auto& [key, member] : value.members()) {
    if (key == "segments" && member.kind() == Value::Kind::number) extent.segments = member.number();
    measure(member, extent);
  }
}

double turned_by_tables(const Value& body, const std::vector<ParameterSpec>& specs) {
  double sum = 0;
  for (const ParameterSpec& spec : specs) {
    const bool over_x = spec.unit == "rad" && spec.columns.size() == 2 && spec.columns[0] == "m";
    const Value* given = over_x ? body.find(spec.key) : nullptr;
    if (given == nullptr || given->kind() != Value::Kind::list) continue;
    for (std::size_t i = 1; i < given->items().size(); ++i)
      sum += std::abs(given->items()[i].numbers().back() - given->items()[i - 1].numbers().back());
  }
  return sum;
}

}  // namespace

double predicted_bytes(const Value& body, const std::vector<ParameterSpec>& specs) {
  Extent extent;
  measure(body, extent);
  extent.turned = turned_by_tables(body, specs);
  for (const ModeCount& count : mode_counts(body, specs)) {
    extent.modes += static_cast<double>(count.modes);
    extent.greatest = std::max(extent.greatest, static_cast<double>(count.modes));
  }
  const double n = extent.modes;
  // Shape functions up to number m need about 25 m points of quadrature (20 for each 2.5 rad of phase, of which turning
  // sections make as much as they turn), and 20 between the rows of a table; a point keeps where it is, Φ, Ψ and Γ, Θ;
  // a body four times that: particles, sections, and running integrals.
  const double points =
      25 * extent.greatest * extent.segments + 20 * (extent.segments + extent.rows) + 8 * extent.turned;
  return 4 * points * 6 * (n * (n + 1) + 1) * static_cast<double>(sizeof(double));
}

}  // namespace withy
