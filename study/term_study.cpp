#include "withy/study/term_study.hpp"

#include <algorithm>
#include <cmath>

namespace withy::study {

double TermSizes::rms(std::size_t group, std::size_t term) const {
  double sum = 0;
  for (const double s : sizes[group][term]) sum += s * s;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(times.size(), 1)));
}

double TermSizes::peak(std::size_t group, std::size_t term) const {
  double most = 0;
  for (const double s : sizes[group][term]) most = std::max(most, s);
  return most;
}

bool TermSizes::absent(std::size_t term) const {
  constexpr double rounding = 1e-12;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (peak(g, term) > rounding * greatest_peak(g)) return false;
  }
  return true;
}

double TermSizes::greatest_rms(std::size_t group) const {
  double most = 0;
  for (std::size_t k = 0; k < terms_of_motion; ++k) most = std::max(most, rms(group, k));
  return most;
}

double TermSizes::greatest_peak(std::size_t group) const {
  double most = 0;
  for (std::size_t k = 0; k < terms_of_motion; ++k) most = std::max(most, peak(group, k));
  return most;
}

TermStudy::TermStudy(const Prepared& prepared, Registry& registry)
    : prepared_(prepared), rates_(prepared.equations->size()), work_(prepared.equations->make_work()) {
  for (const char* id : {"ruthless", "inconsistent", "consistent", "quadratic"})
    compiled_.push_back(compile_throughout(prepared, registry, id));
  const State& start = prepared.scene.initial;
  const DenseSystem s = compiled_[0].equations->system(start.time, start.y);
  for (std::size_t i = 0; i < s.size; ++i) inertias_.push_back(s.mass[i * (s.size + 1)]);
  sizes_.groups = coordinate_groups(prepared.model().layout());
  sizes_.sizes.resize(sizes_.groups.size());
}

void TermStudy::enter(const State& state) {
  const Layout& layout = prepared_.model().layout();
  if (!prepared_.equations->derivatives(state.time, state.y, rates_, work_).ok()) return;
  const TermLedger ledger(*compiled_[0].model, {compiled_[0].equations.get(), compiled_[1].equations.get(),
                                                compiled_[2].equations.get(), compiled_[3].equations.get()});
  const TermForces forces =
      ledger.evaluate(state, std::span<const double>(rates_).subspan(layout.positions, layout.speeds));
  sizes_.times.push_back(state.time);
  for (std::size_t g = 0; g < sizes_.groups.size(); ++g) {
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      sizes_.sizes[g][k].push_back(size_of(forces[k], sizes_.groups[g], inertias_));
  }
}

}  // namespace withy::study
