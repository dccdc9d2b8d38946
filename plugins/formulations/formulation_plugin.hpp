/// \file
/// What the formulation plugins of this folder share: a formulation is the choice of its terms.
#pragma once

#include <utility>

#include "withy/core/equations/compile_equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// What studies do with a formulation: take it where none are named; runs of `auto` go through it besides; neither.
enum class InStudies { taken, rung, aside };

/// A formulation whose sweeps are the core's.
class SweptFormulation final : public Formulation {
 public:
  SweptFormulation(Terms kept, InStudies place) : kept_(std::move(kept)), place_(place) {}
  Terms terms() const override { return kept_; }
  Standing standing() const override {
    return {.rank = rank_of(kept_), .rung = place_ == InStudies::rung, .studied = place_ != InStudies::aside};
  }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const override {
    return compile_equations(std::move(model), kept_);
  }

 private:
  Terms kept_;
  InStudies place_;
};

/// A name for a choice of terms, without options.
template <StrainOrder strain, Truncation truncation, InStudies place = InStudies::taken, bool products_of_speeds = true>
void enroll_terms(Enrollment& enrollment, const char* id, const char* summary) {
  enrollment.add<Formulation>(
      {.id = id,
       .summary = summary,
       .parameters = {},
       .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<Formulation> {
         return std::make_unique<SweptFormulation>(Terms{strain, truncation, products_of_speeds}, place);
       }});
}

}  // namespace withy
