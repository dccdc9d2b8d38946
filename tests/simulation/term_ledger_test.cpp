#include "withy/core/analysis/term_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "withy/tests/dynamics/random_scene.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

struct Formulations {
  explicit Formulations(Made& m)
      : ruthless(m.in("ruthless")),
        inconsistent(m.in("inconsistent")),
        consistent(m.in("consistent")),
        quadratic(m.in("quadratic")) {}
  [[nodiscard]] TermLedger ledger(const Model& model) const {
    return {model, {ruthless.get(), inconsistent.get(), consistent.get(), quadratic.get()}};
  }
  std::unique_ptr<EquationsOfMotion> ruthless, inconsistent, consistent, quadratic;
};

double at(const TermForces& forces, Term term, std::size_t i) { return forces[static_cast<std::size_t>(term)][i]; }

/// Rows of the equations of motion with the terms up to a formulation's; zero where they balance.
double imbalance(const TermForces& f, std::size_t i, const std::vector<Term>& inertia,
                 const std::vector<Term>& velocity) {
  double left = at(f, Term::stiffness, i) + at(f, Term::damping, i), size = std::abs(left);
  double right = 0;
  for (const Term zero : {Term::weight, Term::loads})
    for (std::size_t order = 0; order < 4; ++order)
      right += at(f, static_cast<Term>(static_cast<std::size_t>(zero) + order), i);
  for (const Term t : inertia) {
    left += at(f, t, i);
    size += std::abs(at(f, t, i));
  }
  for (const Term t : velocity) right += at(f, t, i);
  return std::abs(left - right) / (1 + size + std::abs(right));
}

// The groups with the accelerations of `quadratic` add up to its equations, as the sweeps solve them.
TEST(TermLedger, groups_add_up_to_the_equations_of_random_trees) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    RandomScene random(seed, {});
    Made m(random.text(), "quadratic");
    const Formulations all(m);
    const Layout& layout = m.scene.model->layout();
    const State s = random.state(*m.scene.model, m.scene.initial);
    const std::vector<double> rates = m.rates(s);
    const TermForces f =
        all.ledger(*m.scene.model).evaluate(s, std::span<const double>(rates).subspan(layout.positions, layout.speeds));
    for (std::size_t i = 0; i < layout.speeds; ++i) {
      EXPECT_LT(
          imbalance(f, i, {Term::inertia, Term::inertia_linear, Term::inertia_quadratic, Term::inertia_higher},
                    {Term::velocity_rigid, Term::velocity_linear, Term::velocity_quadratic, Term::velocity_higher}),
          1e-9)
          << "seed " << seed << ' ' << layout.speed_names[i];
    }
  }
}

// [Padilla & von Flotow, eq. 4.1] for a beam on an axis at its root, phi normalized to the integral L of its square:
// the elastic row has the centrifugal force +Omega^2 m q from linear relations and -1.193 Omega^2 m q from
// foreshortening; of order zero it has none, and the hinge row has none of first order.
TEST(TermLedger, of_a_rotating_beam_has_the_terms_of_the_paper) {
  Made m(R"(
format: withy/1
time: {end: 1}
bodies:
  beam: {type: beam, length: 2, mass_per_length: 0.5, bending_y: {stiffness: 10, modes: 1}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}
initial:
  hinges: {axle: {rate: [3]}}
  bodies: {beam: {modes: [0.01]}}
)");
  const Formulations all(m);
  const std::vector<double> u_dot = {2, 5};
  const TermForces f = all.ledger(*m.scene.model).evaluate(m.scene.initial, u_dot);
  const double mass = 1, first_moment = 0.5689 * 4;  // integral of x phi over L^2 for the first mode, times L^2
  EXPECT_NEAR(at(f, Term::velocity_linear, 1), 9 * mass * 0.01, 1e-9);
  EXPECT_NEAR(at(f, Term::velocity_quadratic, 1), -1.193 * 9 * mass * 0.01, 5e-4 * 0.1);  // four digits are printed
  EXPECT_NEAR(at(f, Term::velocity_rigid, 1), 0, 1e-12);
  EXPECT_NEAR(at(f, Term::velocity_linear, 0), 0, 1e-12);
  EXPECT_NEAR(at(f, Term::inertia, 1), 2 * 0.5 * first_moment + 5 * mass, 1e-3);
  EXPECT_NEAR(at(f, Term::inertia, 0), 2 * mass * 4 / 3 + 5 * 0.5 * first_moment, 1e-3);
  EXPECT_NEAR(at(f, Term::stiffness, 1), std::pow(1.87510, 4) * 10 / 8 * 0.01 * 1, 1e-4);
}

TEST(TermLedger, coordinates_are_grouped_by_what_they_are) {
  const Made m(R"(
format: withy/1
time: {end: 1}
bodies:
  beam:
    type: beam
    length: 1
    mass_per_length: 1
    bending_y: {stiffness: 10, modes: 2}
    torsion: {stiffness: 10, inertia: 0.01, modes: 1}
hinges:
  ball: {type: spherical, parent: world, child: beam}
)");
  const auto groups = coordinate_groups(m.scene.model->layout());
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].speeds, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(groups[1].speeds, (std::vector<std::size_t>{3, 4}));
  EXPECT_EQ(groups[2].name, "torsion");
  EXPECT_EQ(groups[2].speeds, (std::vector<std::size_t>{5}));
  EXPECT_DOUBLE_EQ(size_of({3, 0, 4}, {"", {0, 2}}, {9, 1, 4}), std::sqrt(5.0));
}

}  // namespace
}  // namespace withy::test
