#include "withy/core/equations/compile_equations.hpp"

#include <stdexcept>
#include <type_traits>

#include "withy/core/equations/sweep_equations.hpp"
#include "withy/core/sweep/strict/strict_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy {

std::unique_ptr<EquationsOfMotion> compile_equations(std::shared_ptr<const Model> model, Terms terms) {
  ReferenceDynamics::check(*model, terms);
  const NodeTree tree = compile_tree(*model);
  std::vector<Terms> node_terms;
  const std::string* strict = nullptr;
  const std::string* full = nullptr;
  for (const NodeSpec& node : tree.nodes) {
    const BodyNode& body = model->bodies()[static_cast<std::size_t>(node.body)];
    node_terms.push_back(body.terms.value_or(terms));
    if (node.modes == 0) continue;
    if (node_terms.back().truncation == Truncation::strict) strict = &body.name;
    if (node_terms.back().truncation == Truncation::none) full = &body.name;
  }
  if (!terms.products_of_speeds && (strict != nullptr || terms.truncation != Truncation::none))
    throw std::invalid_argument("products of speeds can be dropped only where nothing is truncated");
  if (strict != nullptr && full != nullptr) {
    throw std::invalid_argument("body '" + *strict + "' is truncated to strict first order and body '" + *full +
                                "' is not truncated; equations of one order cannot hold both");
  }
  const bool planar = tree.planar;
  const auto build = [&]<class Sweep>(std::type_identity<Sweep>) -> std::unique_ptr<EquationsOfMotion> {
    return std::make_unique<equations::SweepEquations<Sweep>>(std::move(model), terms, tree, node_terms);
  };
  if (strict != nullptr) {
    return planar ? build(std::type_identity<sweep::StrictSweep<Planar>>{})
                  : build(std::type_identity<sweep::StrictSweep<Spatial>>{});
  }
  return planar ? build(std::type_identity<sweep::SymmetricSweep<Planar>>{})
                : build(std::type_identity<sweep::SymmetricSweep<Spatial>>{});
}

}  // namespace withy
