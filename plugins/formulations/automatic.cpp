/// \file
/// The formulation that a run chooses and changes as the accuracy asked of its outputs needs (study/rung_plan.hpp).
/// Where nothing runs it is `quadratic`.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_automatic(Enrollment& enrollment) {
  enrollment.add<Formulation>(
      {.id = "auto",
       .summary = "The cheapest formulations that together hold an accuracy, changed along a run and estimated against "
                  "the highest; quadratic where nothing runs",
       .parameters = {number("accuracy", "1",
                             "greatest error of each output that formulations may make, of its own range")
                          .above(0)
                          .most(1)
                          .otherwise(0.01)},
       .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<Formulation> {
         return std::make_unique<SweptFormulation>(Terms{}, InStudies::aside);
       }});
}

}  // namespace withy
