#include "withy/study/scene_terms.hpp"

namespace withy::study {
namespace {

std::vector<Beyond> compiled_for_terms(const Prepared& prepared, Registry& registry) {
  std::vector<Beyond> all;
  for (const char* id : {"ruthless", "inconsistent", "consistent", "quadratic"})
    all.push_back(compile_throughout(prepared, registry, id));
  return all;
}

}  // namespace

SceneTerms::SceneTerms(const Prepared& prepared, Registry& registry)
    : prepared_(prepared),
      compiled_(compiled_for_terms(prepared, registry)),
      ledger_(*compiled_[0].model, {compiled_[0].equations.get(), compiled_[1].equations.get(),
                                    compiled_[2].equations.get(), compiled_[3].equations.get()}),
      rates_(prepared.equations->size()),
      work_(prepared.equations->make_work()) {
  const State& start = prepared.scene.initial;
  const DenseSystem s = compiled_[0].equations->system(start.time, start.y);
  for (std::size_t i = 0; i < s.size; ++i) inertias_.push_back(s.mass[i * (s.size + 1)]);
}

std::optional<std::span<const double>> SceneTerms::accelerations(const State& state) {
  const Layout& layout = prepared_.model().layout();
  if (!prepared_.equations->derivatives(state.time, state.y, rates_, work_).ok()) return {};
  return std::span<const double>(rates_).subspan(layout.positions, layout.speeds);
}

}  // namespace withy::study
