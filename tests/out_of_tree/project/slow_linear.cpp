// Linear kinematics without truncation and without forces that are products of speeds: for motions so slow that
// Coriolis and centrifugal forces do not count. Studies find it by its rank, below `linear`.
#include <withy/core/equations/compile_equations.hpp>
#include <withy/core/plugin/formulation.hpp>

#include "laws.hpp"

namespace example {
namespace {

class SlowLinear final : public withy::Formulation {
 public:
  withy::Terms terms() const override { return {withy::StrainOrder::linear, withy::Truncation::none, false}; }
  std::unique_ptr<withy::EquationsOfMotion> compile(std::shared_ptr<const withy::Model> model) const override {
    return withy::compile_equations(std::move(model), terms());
  }
};

}  // namespace

withy::Plugin<withy::Formulation> slow_linear() {
  return {.id = "slow-linear",
          .summary = "Linear kinematics, nothing truncated, no forces that are products of speeds",
          .parameters = {},
          .make = [](const withy::Value&, const withy::MakeContext&) -> std::unique_ptr<withy::Formulation> {
            return std::make_unique<SlowLinear>();
          }};
}

}  // namespace example
