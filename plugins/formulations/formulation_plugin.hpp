/// \file
/// What the formulation plugins of this folder share: a formulation is the choice of its terms.
#pragma once

#include "withy/core/equations/compile_equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// A formulation whose sweeps are the core's.
template <Terms kept>
class SweptFormulation final : public Formulation {
 public:
  Terms terms() const override { return kept; }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const override {
    return compile_equations(std::move(model), kept);
  }
};

template <Terms kept>
void enroll_terms(Enrollment& enrollment, const char* id, const char* summary) {
  enrollment.add<Formulation>(
      {.id = id,
       .summary = summary,
       .parameters = {},
       .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<Formulation> {
         return std::make_unique<SweptFormulation<kept>>();
       }});
}

}  // namespace withy
