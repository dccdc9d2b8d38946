#include "withy/core/equations/compile_equations.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "withy/core/equations/closed_equations.hpp"
#include "withy/core/equations/configured_equations.hpp"
#include "withy/core/equations/sweep_equations.hpp"
#include "withy/core/sweep/first_order/first_order_sweep.hpp"
#include "withy/core/sweep/strict/strict_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy {

namespace {

/// Of one configuration of the model.
std::unique_ptr<EquationsOfMotion> compile_configuration(std::shared_ptr<const Model> model, Terms terms) {
  model = Model::in_kinematics(std::move(model), terms);
  PlacedTree tree = compile_placed_tree(*model);
  std::vector<Terms> node_terms;
  // A body of each truncation, none where there is none.
  std::array<const std::string*, 4> of{};
  for (const NodeSpec& node : tree.nodes) {
    const BodyNode& body = model->bodies()[static_cast<std::size_t>(node.body)];
    node_terms.push_back(body.terms.value_or(terms));
    if (node.modes > 0) of.at(static_cast<std::size_t>(node_terms.back().truncation)) = &body.name;
  }
  const std::string* strict = of.at(static_cast<std::size_t>(Truncation::strict));
  const std::string* symmetric = of.at(static_cast<std::size_t>(Truncation::symmetric));
  const std::string* full = of.at(static_cast<std::size_t>(Truncation::none));
  if (!terms.products_of_speeds && (strict != nullptr || symmetric != nullptr || terms.truncation != Truncation::none))
    throw std::invalid_argument("products of speeds can be dropped only where nothing is truncated");
  const auto refuse = [](const std::string* a, const char* how, const std::string* b, const char* other) {
    if (a == nullptr || b == nullptr) return;
    throw std::invalid_argument("body '" + *a + "' is " + how + " and body '" + *b + "' is " + other +
                                "; equations of one order cannot hold both");
  };
  refuse(strict, "truncated to strict first order", full, "not truncated");
  refuse(symmetric, "truncated to first order of the kinetic energy", full, "not truncated");
  refuse(symmetric, "truncated to first order of the kinetic energy", strict, "truncated to strict first order");
  const bool planar = tree.planar;
  const auto build = [&]<class Sweep>(std::type_identity<Sweep>) -> std::unique_ptr<EquationsOfMotion> {
    auto of_tree = std::make_unique<equations::SweepEquations<Sweep>>(model, terms, std::move(tree), node_terms);
    if (loops_of(*model).empty()) return of_tree;
    return std::make_unique<equations::ClosedEquations>(model, terms, std::move(of_tree));
  };
  if (strict != nullptr) {
    return planar ? build(std::type_identity<sweep::StrictSweep<Planar>>{})
                  : build(std::type_identity<sweep::StrictSweep<Spatial>>{});
  }
  if (symmetric != nullptr) {
    return planar ? build(std::type_identity<sweep::FirstOrderSweep<Planar>>{})
                  : build(std::type_identity<sweep::FirstOrderSweep<Spatial>>{});
  }
  return planar ? build(std::type_identity<sweep::SymmetricSweep<Planar>>{})
                : build(std::type_identity<sweep::SymmetricSweep<Spatial>>{});
}

}  // namespace

std::unique_ptr<EquationsOfMotion> compile_equations(std::shared_ptr<const Model> model, Terms terms) {
  if (!equations::has_configurations(*model)) return compile_configuration(std::move(model), terms);
  return equations::make_configured(*model, [&](std::shared_ptr<const Model> configured) {
    return compile_configuration(std::move(configured), terms);
  });
}

}  // namespace withy
