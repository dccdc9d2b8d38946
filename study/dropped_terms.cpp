#include "withy/study/dropped_terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "withy/core/analysis/term_ledger.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/formulation.hpp"

namespace withy::study {
namespace {

/// The inertias that forces are weighed by are taken from an assembled M.
constexpr std::size_t most_speeds = 300;

/// Those of the ledger that a formulation of the whole tree drops; none where it keeps parts of groups.
std::vector<Term> dropped_groups(const Prepared& prepared) {
  for (const BodyNode& body : prepared.model().bodies())
    if (body.terms) return {};
  const Terms terms = prepared.scene.formulation->terms();
  if (terms.truncation == Truncation::ruthless)
    return {Term::inertia_linear,  Term::inertia_quadratic,  Term::inertia_higher,
            Term::velocity_linear, Term::velocity_quadratic, Term::velocity_higher};
  if (terms.truncation != Truncation::strict || !terms.products_of_speeds) return {};
  if (terms.strain == StrainOrder::linear)
    return {Term::inertia_quadratic, Term::inertia_higher, Term::velocity_quadratic, Term::velocity_higher};
  if (terms.strain == StrainOrder::quadratic) return {Term::inertia_higher, Term::velocity_higher};
  return {};
}

/// Squares of the sizes on each group of coordinates, summed over the states.
struct Squares {
  std::vector<double> all;
  std::vector<std::array<double, terms_of_motion>> terms;
};

class Sizes {
 public:
  Sizes(const Prepared& prepared, const Beyond& beyond, Registry& registry)
      : prepared_(prepared),
        beyond_(beyond),
        groups_(coordinate_groups(prepared.model().layout())),
        rates_(prepared.equations->size()),
        work_(prepared.equations->make_work()),
        beyond_work_(beyond.equations->make_work()) {
    for (const char* id : {"ruthless", "inconsistent", "consistent", "quadratic"})
      compiled_.push_back(compile_throughout(prepared, registry, id));
    const State& start = prepared.scene.initial;
    const DenseSystem s = compiled_[0].equations->system(start.time, start.y);
    for (std::size_t i = 0; i < s.size; ++i) inertias_.push_back(s.mass[i * (s.size + 1)]);
    squares_.all.resize(groups_.size());
    squares_.terms.resize(groups_.size());
  }
  /// \param weight the part of the time that the state stands for
  void enter(const State& state, double weight) {
    const Layout& layout = prepared_.model().layout();
    if (!prepared_.equations->derivatives(state.time, state.y, rates_, work_).ok()) return;
    const auto a = std::span<const double>(rates_).subspan(layout.positions, layout.speeds);
    std::vector<double> missing(layout.speeds), ours(layout.speeds);
    beyond_.equations->inverse_dynamics(state.y, a, missing, beyond_work_);
    prepared_.equations->inverse_dynamics(state.y, a, ours, work_);
    for (std::size_t i = 0; i < missing.size(); ++i) missing[i] -= ours[i];
    const TermLedger ledger(*compiled_[0].model, {compiled_[0].equations.get(), compiled_[1].equations.get(),
                                                  compiled_[2].equations.get(), compiled_[3].equations.get()});
    const TermForces forces = ledger.evaluate(state, a);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      squares_.all[g] += weight * std::pow(size_of(missing, groups_[g], inertias_), 2);
      for (std::size_t k = 0; k < terms_of_motion; ++k)
        squares_.terms[g].at(k) += weight * std::pow(size_of(forces.at(k), groups_[g], inertias_), 2);
    }
  }
  [[nodiscard]] std::vector<DroppedForces> shares() const {
    std::vector<DroppedForces> all;
    const std::vector<Term> dropped = dropped_groups(prepared_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto& terms = squares_.terms[g];
      const double greatest = *std::max_element(terms.begin(), terms.end());
      if (!(greatest > 0)) continue;
      DroppedForces of{groups_[g].name, std::sqrt(squares_.all[g] / greatest), {}};
      for (const Term term : dropped)
        of.terms.push_back({std::string(name(term)), std::sqrt(terms.at(static_cast<std::size_t>(term)) / greatest)});
      std::stable_sort(of.terms.begin(), of.terms.end(),
                       [](const DroppedTerm& a, const DroppedTerm& b) { return a.share > b.share; });
      all.push_back(std::move(of));
    }
    return all;
  }

 private:
  const Prepared& prepared_;
  const Beyond& beyond_;
  std::vector<CoordinateGroup> groups_;
  std::vector<Beyond> compiled_;  ///< what terms are the differences of
  std::vector<double> inertias_, rates_;
  Work work_, beyond_work_;
  Squares squares_;
};

}  // namespace

std::vector<DroppedForces> dropped_terms(const Prepared& prepared, const Beyond& beyond, std::span<const State> along,
                                         Registry& registry) {
  const Model& model = prepared.model();
  if (along.empty() || model.layout().speeds > most_speeds || !loops_of(model).empty()) return {};
  Sizes sizes(prepared, beyond, registry);
  // The trapezoidal rule: states are not equally far apart.
  const std::size_t n = along.size();
  for (std::size_t i = 0; i < n; ++i)
    sizes.enter(along[i], n > 1 ? (along[std::min(i + 1, n - 1)].time - along[i > 0 ? i - 1 : 0].time) / 2 : 1);
  return sizes.shares();
}

}  // namespace withy::study
