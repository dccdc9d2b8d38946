#include "withy/study/dropped_terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "withy/core/analysis/term_ledger.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/study/scene_terms.hpp"

namespace withy::study {
namespace {

/// Those of the ledger that a formulation of the whole tree drops; none where it keeps parts of groups.
std::vector<Term> dropped_groups(const Prepared& prepared) {
  for (const BodyNode& body : prepared.model().bodies())
    if (body.terms) return {};
  const Terms terms = prepared.scene.formulation->terms();
  if (terms.truncation == Truncation::ruthless)
    return {Term::inertia_linear,     Term::inertia_quadratic, Term::inertia_higher,  Term::velocity_linear,
            Term::velocity_quadratic, Term::velocity_higher,   Term::weight_linear,   Term::weight_quadratic,
            Term::weight_higher,      Term::loads_linear,      Term::loads_quadratic, Term::loads_higher};
  if (terms.truncation != Truncation::strict || !terms.products_of_speeds) return {};
  if (terms.strain == StrainOrder::linear)
    return {Term::inertia_quadratic, Term::inertia_higher, Term::velocity_quadratic, Term::velocity_higher,
            Term::weight_quadratic,  Term::weight_higher,  Term::loads_quadratic,    Term::loads_higher};
  if (terms.strain == StrainOrder::quadratic)
    return {Term::inertia_higher, Term::velocity_higher, Term::weight_higher, Term::loads_higher};
  return {};
}

/// Squares of the sizes of forces on a group of coordinates.
struct Squares {
  double all = 0;  ///< of all that is dropped
  std::array<double, terms_of_motion> terms = {};
};

/// Those at one state.
struct Look {
  double time;
  std::vector<Squares> groups;
};

class Looks {
 public:
  Looks(const Prepared& prepared, const Beyond& beyond, const std::vector<CoordinateGroup>& groups, Registry& registry)
      : prepared_(prepared), beyond_(beyond), groups_(groups), terms_(prepared, registry) {}
  /// Nothing where the equations have no accelerations.
  std::optional<Look> at(const State& state) {
    const auto a = terms_.accelerations(state);
    if (!a) return {};
    std::vector<double> missing = force_balance(*beyond_.equations, state, *a);
    const std::vector<double> ours = force_balance(*prepared_.equations, state, *a);
    for (std::size_t i = 0; i < missing.size(); ++i) missing[i] -= ours[i];
    const TermForces forces = terms_.forces(state, *a);
    Look look{state.time, {}};
    for (const CoordinateGroup& group : groups_) {
      Squares& squares = look.groups.emplace_back();
      squares.all = std::pow(size_of(missing, group, terms_.inertias()), 2);
      for (std::size_t k = 0; k < terms_of_motion; ++k)
        squares.terms.at(k) = std::pow(size_of(forces.at(k), group, terms_.inertias()), 2);
    }
    return look;
  }

 private:
  const Prepared& prepared_;
  const Beyond& beyond_;
  const std::vector<CoordinateGroup>& groups_;
  SceneTerms terms_;
};

/// The integral over time by the trapezoidal rule, and which term is the greatest.
struct Sum {
  Squares squares;
  std::size_t greatest = 0;  ///< index of the term
  double most = 0;           ///< what one look has of it
  double moment = 0;         ///< when [s]

  [[nodiscard]] double of_greatest() const { return squares.terms.at(greatest); }
  [[nodiscard]] double share(double square) const { return std::sqrt(square / of_greatest()); }
};

/// Over every `step`-th look.
Sum sum_of(std::span<const Look> looks, std::size_t group, std::size_t step) {
  const auto weight = [&](std::size_t i) {
    const double before = looks[i >= step ? i - step : 0].time;
    const double after = looks[i + step < looks.size() ? i + step : i].time;
    return after > before ? after - before : 1;
  };
  Sum sum;
  for (std::size_t i = 0; i < looks.size(); i += step) {
    const Squares& s = looks[i].groups[group];
    sum.squares.all += weight(i) * s.all;
    for (std::size_t k = 0; k < terms_of_motion; ++k) sum.squares.terms.at(k) += weight(i) * s.terms.at(k);
  }
  const auto& terms = sum.squares.terms;
  sum.greatest = static_cast<std::size_t>(std::max_element(terms.begin(), terms.end()) - terms.begin());
  for (std::size_t i = 0; i < looks.size(); i += step) {
    const double part = weight(i) * looks[i].groups[group].terms.at(sum.greatest);
    if (part <= sum.most) continue;
    sum.most = part;
    sum.moment = looks[i].time;
  }
  return sum;
}

DroppedForces dropped_on(const std::string& group, const Sum& all, const Sum& half, const std::vector<Term>& dropped) {
  DroppedForces of{.group = group, .share = all.share(all.squares.all)};
  if (half.of_greatest() > 0) of.spread = std::abs(of.share - half.share(half.squares.all));
  if (all.most > all.of_greatest() / 2) of.moment = all.moment;
  for (const Term t : dropped)
    of.terms.push_back({std::string(name(t)), all.share(all.squares.terms.at(static_cast<std::size_t>(t)))});
  std::stable_sort(of.terms.begin(), of.terms.end(),
                   [](const DroppedTerm& a, const DroppedTerm& b) { return a.share > b.share; });
  return of;
}

}  // namespace

std::vector<DroppedForces> dropped_terms(const Prepared& prepared, const Beyond& beyond, std::span<const State> along,
                                         Registry& registry) {
  const Model& model = prepared.model();
  if (along.empty() || !loops_of(model).empty()) return {};
  const std::vector<CoordinateGroup> groups = coordinate_groups(model.layout());
  Looks looking(prepared, beyond, groups, registry);
  std::vector<Look> looks;
  for (const State& state : along)
    if (std::optional<Look> look = looking.at(state)) looks.push_back(std::move(*look));
  std::vector<DroppedForces> all;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (const Sum sum = sum_of(looks, g, 1); sum.of_greatest() > 0)
      all.push_back(dropped_on(groups[g].name, sum, sum_of(looks, g, 2), dropped_groups(prepared)));
  return all;
}

}  // namespace withy::study
