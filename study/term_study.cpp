#include "withy/study/term_study.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/check_loads.hpp"
#include "withy/study/refusals.hpp"

namespace withy::study {
namespace {

double rms_of(const std::vector<double>& sizes) {
  double sum = 0;
  for (const double s : sizes) sum += s * s;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(sizes.size(), 1)));
}

double peak_of(const std::vector<double>& sizes) {
  double most = 0;
  for (const double s : sizes) most = std::max(most, s);
  return most;
}

bool same(const Terms& a, const Terms& b) {
  return a.strain == b.strain && a.truncation == b.truncation && a.products_of_speeds == b.products_of_speeds;
}

/// \throws InputError, SceneError where no terms are to be found of the scene
const Prepared& fit_for_terms(const Prepared& prepared) {
  refuse_loops(prepared, "'withy terms'");
  check_loads(prepared);
  return prepared;
}

}  // namespace

double LeftOutBy::rms(std::size_t group) const { return rms_of(sizes[group]); }
double LeftOutBy::peak(std::size_t group) const { return peak_of(sizes[group]); }

double TermSizes::rms(std::size_t group, std::size_t term) const { return rms_of(sizes[group][term]); }
double TermSizes::peak(std::size_t group, std::size_t term) const { return peak_of(sizes[group][term]); }

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
    : prepared_(fit_for_terms(prepared)), terms_(prepared, registry) {
  sizes_.groups = coordinate_groups(prepared.model().layout());
  sizes_.sizes.resize(sizes_.groups.size());
  compile_all(registry);
}

void TermStudy::compile_all(Registry& registry) {
  std::vector<Terms> met;
  const std::vector<RankedFormulation> all = formulations_by_rank(registry);
  for (auto f = all.rbegin(); f != all.rend(); ++f) {  // of those that mean the same, plugins may be the finer
    const Terms terms = f->formulation->terms();
    if (std::any_of(met.begin(), met.end(), [&](const Terms& other) { return same(terms, other); })) continue;
    try {
      others_.insert(others_.begin(), compile_throughout(prepared_, registry, f->id));
      met.push_back(terms);
    } catch (const std::exception&) {
      continue;  // it cannot treat the model: it leaves out nothing of it
    }
  }
  sizes_.richest = others_.back().formulation;
  for (std::size_t i = 0; i + 1 < others_.size(); ++i)
    sizes_.left_out.push_back({others_[i].formulation, std::vector<std::vector<double>>(sizes_.groups.size())});
}

void TermStudy::enter_left_out(const State& state, std::span<const double> accelerations) {
  const std::vector<double> whole = force_balance(*others_.back().equations, state, accelerations);
  for (std::size_t i = 0; i < sizes_.left_out.size(); ++i) {
    std::vector<double> missing = force_balance(*others_[i].equations, state, accelerations);
    for (std::size_t k = 0; k < missing.size(); ++k) missing[k] -= whole[k];
    for (std::size_t g = 0; g < sizes_.groups.size(); ++g)
      sizes_.left_out[i].sizes[g].push_back(size_of(missing, sizes_.groups[g], terms_.inertias()));
  }
}

void TermStudy::enter(const State& state) {
  const auto accelerations = terms_.accelerations(state);
  if (!accelerations) return;
  const TermForces forces = terms_.forces(state, *accelerations);
  enter_left_out(state, *accelerations);
  sizes_.times.push_back(state.time);
  for (std::size_t g = 0; g < sizes_.groups.size(); ++g) {
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      sizes_.sizes[g][k].push_back(size_of(forces[k], sizes_.groups[g], terms_.inertias()));
  }
}

}  // namespace withy::study
