#include "withy/results/report/report_table.hpp"

#include <algorithm>

#include "withy/core/simulation/validity_limits.hpp"

namespace withy {
namespace {

/// Whether the rates of some body are held against a limit: where its formulation is not of second order, and where a
/// run may choose one that is not.
bool has_limits_of_rates(const study::Prepared& prepared) {
  const auto& bodies = prepared.model().bodies();
  return std::any_of(bodies.begin(), bodies.end(), [&](const BodyNode& node) {
    if (node.body->shape().modes() == 0) return false;
    return prepared.escalates() || !second_order(node.terms ? *node.terms : prepared.scene.formulation->terms());
  });
}

/// An observation costs a pass over the tree a row: null where nobody asks.
std::unique_ptr<Observation> observation_of_rates(const study::Prepared& prepared) {
  if (!has_limits_of_rates(prepared)) return nullptr;
  const EquationsOfMotion& equations = prepared.escalates() ? *prepared.rungs.front().equations : *prepared.equations;
  return equations.make_observation();
}

}  // namespace

void ReportTable::begin(const std::vector<Column>& columns) {
  recorded_ = columns;
  if (!derived_) derived_.emplace(columns, prepared_.model(), observation_of_rates(prepared_));
  std::vector<Column> all = columns;
  all.insert(all.end(), derived_->columns().begin(), derived_->columns().end());
  kept_.begin(all);
}

void ReportTable::row(std::span<const double> numbers) {
  row_.assign(numbers.begin(), numbers.end());
  derived_->append(numbers, row_);
  kept_.row(row_);
}

}  // namespace withy
