/// \file
/// Sweeps of short runs into stores.
#pragma once

#include <string>

#include "withy/campaign/collect.hpp"
#include "withy/campaign/sweep_run.hpp"
#include "withy/tests/campaign/plan_fixture.hpp"

namespace withy::campaign {

/// A result that no run has made, another for each index.
inline CaseResult made(std::uint64_t index) {
  CaseResult r;
  r.index = index;
  r.status = index % 5 == 0 ? "diverged" : "completed";
  r.message = index % 5 == 0 ? std::string("its \"tip\",\nfar") : "";
  r.values = {Value(0.1 * static_cast<double>(index)), Value(std::string("quadratic")), Value(), std::nullopt};
  r.numbers = {1.0 / (1.0 + static_cast<double>(index)), -0.0};
  r.seconds = 0.5;
  return r;
}

/// Twelve cases, some of them refused for a tolerance below zero.
inline constexpr const char* twelve = R"(vary:
  bodies.rod.mass: {grid: [1, 2]}
  integrator.rtol: {normal: {mean: 1e-6, deviation: 3e-6}}
  initial.hinges.pivot.rate.0: {sobol: {from: 0, to: 3}}
cases: 6
seed: 3
keep: {final: [pivot], peak: [pivot.rate, rod.tip]}
)";

/// The table of all cases in a store of that folder.
inline std::string table_of(const test::PlanFolder& folder, const std::string& store) {
  collect(folder / store);
  return folder.read(store + "/table.csv");
}

/// Runs what a store of that folder lacks of a plan.
inline SweepOutcome run(const test::PlanFolder& folder, const Plan& plan, const std::string& store,
                        SweepSettings settings) {
  return run_sweep(plan, test::plugins(), Store(folder / store, plan, false), settings);
}

}  // namespace withy::campaign
