/// \file
/// What linearly implicit integrators ask of the sweeps, against the dense equations of random trees.
#include <algorithm>
#include <cmath>

#include "random_case.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

class LinearlyImplicitTrees : public testing::TestWithParam<std::string> {
 protected:
  /// As of the sweeps, see RandomTrees; beams bend more here.
  static double tolerance() { return GetParam() == "exact" ? 1e-7 : 1e-11; }
};

/// Rows of an equation: what is left of each, and the size of its terms.
struct Rows {
  std::vector<double> residual, scale;
  explicit Rows(std::size_t n) : residual(n), scale(n, 1e-12) {}
  void add(std::size_t i, double term) {
    residual[i] += term;
    scale[i] += std::abs(term);
  }
};

/// W z = r with W = 1 − δ A: (M + δD + δ²K) z_u = M r_u − δ K r_q on the modes, z_q = r_q + δ z_u.
TEST_P(LinearlyImplicitTrees, solutions_satisfy_their_equations) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 6), .planar = seed % 3 == 0, .any_root = seed % 2 == 0};
    const Case c(seed, wish, GetParam());
    const LinearlyImplicit* linear = c.equations->linearly_implicit();
    if (linear == nullptr) {
      EXPECT_TRUE(GetParam() == "consistent" || GetParam() == "inconsistent");
      return;
    }
    const Layout& layout = c.equations->layout();
    const DenseSystem s = c.equations->system(0, c.state.y);
    const double delta = 0.03;
    std::vector<double> r(c.equations->size());
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = std::sin(0.3 + 1.7 * static_cast<double>(i * seed));
    std::vector<double> z = r;
    Work factors = linear->make_factors();
    factors.poison();
    ASSERT_TRUE(linear->factorize(c.state.y, delta, factors).ok());
    const std::size_t before = allocations();
    linear->solve(z, factors);
    EXPECT_EQ(allocations() - before, 0U);
    Rows rows(s.size);
    for (std::size_t i = 0; i < s.size; ++i) {
      for (std::size_t j = 0; j < s.size; ++j)
        rows.add(i, s.mass[i * s.size + j] * (z[layout.positions + j] - r[layout.positions + j]));
    }
    std::size_t flexible = 0;
    for (const BodyNode& body : c.scene.model->bodies()) {
      const ModalShape& shape = body.body->shape();
      if (shape.modes() == 0) continue;
      const Slot& slot = layout.bodies[flexible++];
      for (Eigen::Index i = 0; i < shape.modes(); ++i) {
        const auto row = static_cast<std::size_t>(i);
        EXPECT_NEAR(z[slot.position + row], r[slot.position + row] + delta * z[layout.positions + slot.speed + row],
                    1e-12);
        for (Eigen::Index j = 0; j < shape.modes(); ++j) {
          const auto column = static_cast<std::size_t>(j);
          rows.add(slot.speed + row, delta * shape.damping(i, j) * z[layout.positions + slot.speed + column]);
          rows.add(slot.speed + row, delta * shape.stiffness(i, j) * z[slot.position + column]);
        }
      }
    }
    for (std::size_t i = 0; i < s.size; ++i)
      EXPECT_LT(std::abs(rows.residual[i]), tolerance() * rows.scale[i])
          << "seed " << seed << ", row " << layout.speed_names[i];
  }
}

/// All kinds of hinges and beams, damped, with a load and a hinge that is driven.
struct Pushed : Case {
  static std::string text(unsigned seed, bool planar) {
    const std::string z = planar ? "0" : "1";
    return R"(
format: withy/1
gravity: [1, -9, 0]
time: {end: 1}
bodies:
  hub: {type: rigid, mass: 2, inertia: [0.3, 0.4, 0.5, 0, 0, 0], frames: {out: {position: [0.2, 0.1, 0]}}}
  boom: {type: beam, length: 1.5, mass_per_length: 0.6, damping_ratio: 0.03,
         bending_y: {stiffness: 4, modes: 3}, )" +
           std::string(
               planar ? ""
                      : "bending_z: {stiffness: 7, modes: 1}, torsion: {stiffness: 3, inertia: 0.002, modes: 1}, ") +
           R"(frames: {mid: {at: 0.5}}}
  arm: {type: beam, length: 1, mass_per_length: 0.3, damping_ratio: 0.01, bending_y: {stiffness: 2, modes: 2}}
  load: {type: rigid, mass: 1, inertia: [0.1, 0.2, 0.1, 0, 0, 0]}
hinges:
  base: {type: )" +
           std::string(planar ? "planar" : "free") +
           R"(, parent: world, child: hub}
  root: {type: revolute, axis: [0, 0, 1], parent: hub.out, child: boom}
  elbow: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: arm}
  wrist: {type: )" +
           std::string(planar ? "weld" : "spherical") +
           R"(, parent: arm.tip, child: load}
loads:
  push: {type: force, frame: arm.tip, law: constant, value: [1, 2, )" +
           z + R"(]}
  brake: {type: hinge-spring, hinge: root, stiffness: 3, damping: 0.4}
motions:
  drive: {hinge: elbow, type: sine, amplitude: 0.3, period: 0.7, phase: )" +
           std::to_string(0.1 * seed) + "}\n";
  }
  Pushed(unsigned seed, bool planar, const std::string& formulation) : Case(text(seed, planar), formulation) {
    for (std::size_t i = 0; i < state.y.size(); ++i)
      state.y[i] += 0.1 * std::sin(1.0 + 1.3 * static_cast<double>(i + seed));
    state.time = 0.37;
    equations->normalize(state.y);
    scene.model->prescribe(state);
  }
};

/// M u̇ − f − τ + K (q_z − q) + D (u_z − u), and the power of damping at z.
std::pair<Rows, double> rows_of(const Pushed& c, const std::vector<double>& z, const std::vector<double>& y_dot) {
  const Layout& layout = c.equations->layout();
  const std::size_t n = layout.speeds, first = layout.positions;
  const DenseSystem s = c.equations->system(c.state.time, c.state.y);
  Rows rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) rows.add(i, s.mass[i * n + j] * y_dot[first + j]);
    rows.add(i, -s.force[i]);
    rows.add(i, -s.applied[i]);
  }
  double power = 0;
  for (const BodyNode& body : c.scene.model->bodies()) {
    const Slot* slot = layout.body(body.name);
    if (slot == nullptr) continue;
    const ModalShape& shape = body.body->shape();
    for (Eigen::Index i = 0; i < shape.modes(); ++i) {
      const std::size_t row = slot->speed + static_cast<std::size_t>(i);
      for (Eigen::Index j = 0; j < shape.modes(); ++j) {
        const std::size_t q = slot->position + static_cast<std::size_t>(j);
        const std::size_t u = first + slot->speed + static_cast<std::size_t>(j);
        rows.add(row, shape.stiffness(i, j) * (z[q] - c.state.y[q]));
        rows.add(row, shape.damping(i, j) * (z[u] - c.state.y[u]));
        power -= z[first + row] * shape.damping(i, j) * z[u];
      }
    }
  }
  return {rows, power};
}

/// M u̇ = f + τ − K (q_z − q) − D (u_z − u) in the rows that are not driven, ẋ = N(x) u_z, and the power of loads,
/// motions and damping, with z = base + δ ẏ.
TEST_P(LinearlyImplicitTrees, implicit_derivatives_satisfy_their_equations) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Pushed c(seed, seed % 2 == 0, GetParam());
    const LinearlyImplicit* linear = c.equations->linearly_implicit();
    if (linear == nullptr) {
      EXPECT_TRUE(GetParam() == "consistent" || GetParam() == "inconsistent");
      return;
    }
    const Layout& layout = c.equations->layout();
    const std::size_t n = layout.speeds, first = layout.positions;
    const double delta = seed < 5 ? 0.02 : 3;
    std::vector<double> base = c.state.y, y_dot(c.equations->size());
    for (std::size_t i = 0; i < base.size(); ++i) base[i] += 0.05 * std::cos(0.7 * static_cast<double>(i * seed));
    Work work = c.equations->make_work();
    work.poison();
    const std::size_t before = allocations();
    ASSERT_TRUE(linear->implicit_derivatives(c.state.time, c.state.y, base, delta, y_dot, work).ok());
    EXPECT_EQ(allocations() - before, 0U);

    std::vector<double> z = base;
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += delta * y_dot[i];
    std::vector<double> moved = c.state.y, rates(c.equations->size());
    std::copy_n(z.begin() + static_cast<std::ptrdiff_t>(first), n, moved.begin() + static_cast<std::ptrdiff_t>(first));
    ASSERT_TRUE(c.equations->position_rates(c.state.time, moved, rates, work).ok());
    for (std::size_t i = 0; i < first; ++i) EXPECT_NEAR(y_dot[i], rates[i], 1e-13 * (1 + std::abs(rates[i])));

    const auto [rows, damping] = rows_of(c, z, y_dot);
    std::vector<double> efforts(n);
    c.equations->load_efforts(c.state.time, c.state.y, EquationsOfMotion::all_loads, efforts, work);
    double power = damping, size = 1e-12;
    for (std::size_t i = 0; i < n; ++i) {
      const bool driven = layout.speed_names[i] == "elbow.0";
      // What is left in a driven row is the effort of its motion.
      const double effort = efforts[i] + (driven ? rows.residual[i] : 0);
      power += effort * z[first + i];
      size += std::abs(effort * z[first + i]);
      if (driven) {
        std::vector<double> asked(n);
        c.scene.model->prescribe_accelerations(c.state.time, asked);
        EXPECT_EQ(y_dot[first + i], asked[i]);
      } else {
        EXPECT_LT(std::abs(rows.residual[i]), tolerance() * rows.scale[i])
            << "seed " << seed << ", row " << layout.speed_names[i];
      }
    }
    EXPECT_NEAR(y_dot.back(), power, 100 * tolerance() * size);
  }
}

/// Where δ → 0 and base = y nothing is implicit.
TEST_P(LinearlyImplicitTrees, implicit_derivatives_are_the_explicit_ones_where_nothing_is_implicit) {
  const Pushed c(3, false, GetParam());
  const LinearlyImplicit* linear = c.equations->linearly_implicit();
  if (linear == nullptr) return;
  std::vector<double> implicit(c.equations->size()), explicitly(c.equations->size());
  Work work = c.equations->make_work();
  ASSERT_TRUE(linear->implicit_derivatives(c.state.time, c.state.y, c.state.y, 1e-300, implicit, work).ok());
  ASSERT_TRUE(c.equations->derivatives(c.state.time, c.state.y, explicitly, work).ok());
  for (std::size_t i = 0; i < implicit.size(); ++i)
    EXPECT_NEAR(implicit[i], explicitly[i], 1e-11 * (1 + std::abs(explicitly[i]))) << i;
}

INSTANTIATE_TEST_SUITE_P(Formulations, LinearlyImplicitTrees, testing::ValuesIn(formulations), formulation_name);

}  // namespace
}  // namespace withy::test
