/// \file
/// What the formulation plugins of this folder share: a formulation is the choice of its terms.
#pragma once

#include "withy/core/equations/compile_equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// A rung of `auto`.
template <Terms kept>
inline constexpr Standing rung{.rank = rank_of(kept), .rung = true, .studied = true};
/// Left out of studies that do not name it.
template <Terms kept>
inline constexpr Standing aside{.rank = rank_of(kept), .rung = false, .studied = false};

/// A formulation whose sweeps are the core's.
template <Terms kept, Standing place>
class SweptFormulation final : public Formulation {
 public:
  Terms terms() const override { return kept; }
  Standing standing() const override { return place; }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const override {
    return compile_equations(std::move(model), kept);
  }
};

template <Terms kept, Standing place = Standing{.rank = rank_of(kept)}>
void enroll_terms(Enrollment& enrollment, const char* id, const char* summary) {
  enrollment.add<Formulation>(
      {.id = id,
       .summary = summary,
       .parameters = {},
       .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<Formulation> {
         return std::make_unique<SweptFormulation<kept, place>>();
       }});
}

}  // namespace withy
