/// \file
/// What a run watches, against closed forms and differences of poses.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "withy/core/simulation/carried_frequency.hpp"
#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/core/simulation/tree_motion.hpp"
#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/dynamics/random_scene.hpp"
#include "withy/tests/simulation/cantilever.hpp"

namespace withy::test {
namespace {

/// By the dense mass matrix: the lowest vibration of all elastic coordinates with every hinge held.
double held_frequency(const Made& m) {
  const DenseSystem dense = m.equations->system(0, m.scene.initial.y);
  const auto n = static_cast<Eigen::Index>(dense.size);
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> M(dense.mass.data(), n,
                                                                                                   n);
  const Eigen::MatrixXd K = stiffness_of_modes(*m.scene.model);
  std::vector<Eigen::Index> elastic;
  for (Eigen::Index i = 0; i < n; ++i)
    if (K(i, i) > 0) elastic.push_back(i);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K(elastic, elastic), M(elastic, elastic));
  return std::sqrt(solver.eigenvalues()[0]);
}

/// Two links with masses at their ends: nothing of it is as slow as the whole is.
TEST(CarriedFrequency, is_that_of_the_loaded_structure_with_its_hinges_held) {
  const std::string beam = "{type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 20, modes: 2}}";
  const std::string text =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  one: " + beam + "\n  two: " + beam + "\n  aside: " + beam +
      "\n  load: {type: rigid, mass: 3, inertia: [.1, .1, .1, 0, 0, 0]}\nhinges:\n  a: {type: revolute, axis: [0, 0, "
      "1], parent: world, child: one}\n  b: {type: revolute, axis: [0, 0, 1], parent: one.tip, child: two}\n  c: "
      "{type: "
      "weld, parent: two.tip, child: load}\n  d: {type: weld, parent: world, child: aside}\n";
  for (const char* formulation : {"ruthless", "quadratic", "exact", "consistent"}) {
    Made m(text, formulation);
    std::vector<double>& y = m.scene.initial.y;
    CarriedFrequency frequency(*m.scene.model, *m.equations);
    Work work = m.equations->make_work();
    const auto index = [&](const char* name) { return static_cast<std::size_t>(m.scene.model->body(name)); };
    frequency.update(y, work);
    EXPECT_NEAR(frequency.of(index("aside")), 3.51602 * std::sqrt(20.0), 1e-3);
    EXPECT_NEAR(frequency.of(index("two")), held_frequency(m), 1e-6) << formulation;
    EXPECT_EQ(frequency.of(index("one")), frequency.of(index("two")));
    if (m.equations->linearly_implicit() == nullptr) continue;
    const double stretched = frequency.of(index("two"));
    for (int i = 0; i < 50; ++i) {  // the elbow bends, a little each time
      y[m.scene.model->layout().hinges[index("two")].position] += 0.04;
      frequency.update(y, work);
    }
    EXPECT_GT(frequency.of(index("two")), 1.2 * stretched) << "the mass has come nearer";
    EXPECT_NEAR(frequency.of(index("two")), held_frequency(m), 1e-3 * stretched) << formulation;
  }
}

/// The state a time h later, by one Runge–Kutta step of order 4.
State later(const Made& m, const State& s, double h) {
  const auto slope = [&](const State& at) { return m.rates(at); };
  const auto step = [&](const std::vector<double>& k, double a) {
    State r = s;
    for (std::size_t i = 0; i < k.size(); ++i) r.y[i] += a * k[i];
    return r;
  };
  const auto k1 = slope(s), k2 = slope(step(k1, h / 2)), k3 = slope(step(k2, h / 2)), k4 = slope(step(k3, h));
  State r = s;
  for (std::size_t i = 0; i < r.y.size(); ++i) r.y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  return r;
}

// From the undeformed state the first order in elastic coordinates is all there is. Second differences of poses and
// first ones of the momentum at 1e-4 s: modes of up to 1e3 rad/s leave (h omega)^2/12 = 1e-3 of what they accelerate.
TEST(TreeMotion, accelerations_and_forces_are_those_of_the_moving_tree) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SceneWish wish;
    wish.any_root = seed % 2 == 0;
    RandomScene random(seed, wish);
    const Made m(random.text(), "quadratic");
    const Model& model = *m.scene.model;
    const Layout& layout = model.layout();
    State s = random.state(model, m.scene.initial);
    for (const Slot& b : layout.bodies) {
      for (std::size_t i = 0; i < b.speeds; ++i) s.y[b.position + i] = s.y[layout.positions + b.speed + i] = 0;
    }
    TreeMotion motion(model);
    motion.update(s.y, std::span<const double>(m.rates(s)).subspan(layout.positions, layout.speeds));
    const double h = 1e-4;
    const State after = later(m, s, h), before = later(m, s, -h);
    Vector3 root_force = Vector3::Zero();
    double mass = 0;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const auto at = [&](const State& state) {
        const auto p = m.equations->frame_pose(state.y, static_cast<int>(b), 0).position;
        return Vector3(p[0], p[1], p[2]);
      };
      // The root of a beam held at its root is its body frame.
      const BodyMotion& B = motion.bodies()[b];
      const Vector3 second = (at(after) - 2 * at(s) + at(before)) / (h * h) - model.gravity();
      EXPECT_LT((second - B.acceleration).norm(), 1e-3 * (10 + second.norm())) << "seed " << seed << " body " << b;
      EXPECT_LT((at(s) - B.p).norm(), 1e-12);
      if (model.hinges()[b].parent < 0) {
        root_force += B.force;
        mass += B.mass;
      }
    }
    const auto p = m.equations->energies(after.y).linear_momentum, q = m.equations->energies(before.y).linear_momentum;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double force = (p[k] - q[k]) / (2 * h) - mass * model.gravity()[i];
      EXPECT_NEAR(root_force[i], force, 1e-3 * (10 + std::abs(force))) << "seed " << seed;
    }
  }
}

const char* const arm = R"(
format: withy/1
time: {end: 1}
formulation: ruthless
bodies:
  link: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 30, modes: 2}, bending_z: {stiffness: 40, modes: 2}}
  load: {type: rigid, mass: 2, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: link}
  tip: {type: weld, parent: link.tip, child: load}
initial:
  hinges: {shoulder: {rate: [1.5]}}
  bodies: {link: {modes: [0.02, 0, 0.01, 0.001]}}
)";

TEST(Validity, watching_allocates_nothing_after_construction) {
  Made m(arm);
  const auto beyond = m.in("quadratic");
  Validity validity;
  ValidityWatch watch(*m.scene.model, *m.equations, beyond.get(), validity);
  watch.observe(m.scene.initial, 0, m.scene.initial.time, nullptr);
  const auto seen = m.equations->make_observation();
  seen->observe(m.scene.initial.y);
  const std::size_t before = allocations();
  for (std::size_t i = 1; i <= 20; ++i) watch.observe(m.scene.initial, i * 1'000'000, m.scene.initial.time, seen.get());
  watch.settle();
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(validity.samples, 21U);
}

// Steps of 1 ms: 10,000 of them need a stride of 256, so that 40 states are kept, and the end.
TEST(Validity, states_along_a_run_are_evenly_spread_over_its_steps_and_survive_a_checkpoint) {
  StatesAlong whole(1, 64), resumed(1, 64);
  for (int i = 0; i < 10'000; ++i) {
    const State state{1e-3 * i, {1.0 * i}};
    whole.observe(state);
    if (i == 5'000) {
      Memory written;
      whole.remember(written);
      Memory read(written.numbers());
      resumed.remember(read);
    } else if (i > 5'000) {
      resumed.observe(state);
    }
  }
  const State end{10, {10'000}};
  const std::vector<State> states = whole.until(end, true), again = resumed.until(end, true);
  ASSERT_EQ(states.size(), 41U);
  for (std::size_t i = 0; i + 1 < states.size(); ++i) EXPECT_EQ(states[i].y[0], 256.0 * static_cast<double>(i));
  EXPECT_EQ(states.back().time, 10);
  ASSERT_EQ(again.size(), states.size());
  for (std::size_t i = 0; i < states.size(); ++i) EXPECT_EQ(again[i].y, states[i].y);
  EXPECT_EQ(whole.until({5, {5'000}}, false).back().y[0], 4'864);
  EXPECT_TRUE(StatesAlong(0, 64).until(end, false).empty());
}

// At one state: rate over the lowest frequency of the loaded arm, energies of modes with K = omega^2 G, and what the
// accelerations lack from the dense systems of both formulations.
TEST(Validity, indicators_of_one_state_are_its_closed_forms) {
  Made m(arm);
  const auto beyond = m.in("quadratic");
  Validity validity;
  ValidityWatch watch(*m.scene.model, *m.equations, beyond.get(), validity);
  watch.finish(m.scene.initial, true);
  ASSERT_EQ(validity.bodies.size(), 1U);
  const BodyValidity& b = validity.bodies[0];
  EXPECT_NEAR(b.rate_ratio, 1.5 / held_frequency(m), 1e-5);
  EXPECT_GT(b.rate_ratio, 2 * 1.5 / (3.51602 * std::sqrt(30.0))) << "the bare beam vibrates faster";
  ASSERT_EQ(b.highest.size(), 2U);
  EXPECT_NEAR(b.highest[0].share, 0, 1e-20);
  const double low = std::pow(3.51602, 4),
               high = std::pow(22.0345, 4);  // K of clamped-free modes goes with these roots
  const double share =
      0.001 * 0.001 * std::sqrt(high) / (0.01 * 0.01 * std::sqrt(low) + 0.001 * 0.001 * std::sqrt(high));
  EXPECT_NEAR(b.highest[1].share, share, 1e-5);

  const DenseSystem up = beyond->system(0, m.scene.initial.y);
  const auto a = solve(m.equations->system(0, m.scene.initial.y)), c = solve(up);
  double difference = 0, used = 0;
  for (std::size_t i = 0; i < up.size; ++i) {
    for (std::size_t j = 0; j < up.size; ++j) {
      difference += (c[i] - a[i]) * up.mass[i * up.size + j] * (c[j] - a[j]);
      used += a[i] * up.mass[i * up.size + j] * a[j];
    }
  }
  EXPECT_NEAR(validity.neglected.rms, std::sqrt(difference / used), 1e-8);
  EXPECT_GT(validity.neglected.rms, 1e-3);
}

TEST(Validity, a_run_repeated_gives_the_same_bits) {
  Made m(arm);
  const auto beyond = m.in("quadratic");
  RunOptions options;
  options.end = 1;
  options.beyond = beyond.get();
  const RunSummary one = simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {});
  const RunSummary two = simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {});
  EXPECT_GE(one.validity.samples, 2U);
  EXPECT_EQ(one.validity.samples, two.validity.samples);
  EXPECT_EQ(one.validity.neglected.rms, two.validity.neglected.rms);
  EXPECT_EQ(one.validity.bodies[0].load.size(), two.validity.bodies[0].load.size());
  options.beyond = nullptr;
  const RunSummary unwatched =
      simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {});
  EXPECT_EQ(unwatched.final.y, one.final.y) << "watching changes nothing";
}

// What rests in axes that turn at 2 rad/s turns with them; what turns back as fast in them does not turn.
TEST(Validity, the_rate_of_a_body_is_that_in_axes_that_do_not_turn) {
  const auto watched = [](const std::string& hinge, const std::string& initial) {
    Made m(
        "format: withy/1\ntime: {end: 1}\ngravity: [0, 0, 0]\nformulation: ruthless\nbodies:\n  arm: {type: beam, "
        "length: 1, mass_per_length: 1, bending_y: {stiffness: 10, modes: 1}}\nhinges:\n  h: {type: " +
        hinge + ", parent: world, child: arm}\nloads: {axes: {type: rotating-frame, axis: [0, 0, 1], rate: 2}}\n" +
        initial);
    Validity validity;
    ValidityWatch watch(*m.scene.model, *m.equations, nullptr, validity);
    watch.finish(m.scene.initial, true);
    return validity.bodies.at(0).rate_ratio;
  };
  EXPECT_NEAR(watched("weld", ""), 2 / (3.51602 * std::sqrt(10.0)), 1e-5);
  EXPECT_NEAR(watched("revolute, axis: [0, 0, 1]", "initial: {hinges: {h: {rate: [-2]}}}\n"), 0, 1e-12);
}

// A cantilever without damping, at y = a cos w1 t and z = a sin w2 t: neither component is ever more than a, of which
// each is seen in the first quarter of a turn; both together come to a sqrt(2) as they beat.
TEST(Peaks, of_a_beam_that_bends_in_two_planes_are_those_of_the_whole) {
  const std::string text =
      cantilever("[0, 0, 0]", 1, 1e-9, "bending_y: {stiffness: 10, modes: 1}, bending_z: {stiffness: 14, modes: 1}") +
      "formulation: linear\nintegrator: {name: dopri5, rtol: 1e-10, atol: 1e-13}\n"
      "initial: {bodies: {beam: {modes: [0.01, 0], rates: [0, 0.01]}}}\n";
  Made m(text);
  const std::size_t q = m.scene.model->layout().modes(0)->position;
  State& start = m.scene.initial;
  const std::vector<double> rates = m.rates(start);
  const double w1 = std::sqrt(-rates[2] / start.y[q]);
  State other = start;
  std::swap(other.y[q], other.y[q + 1]);
  const double w2 = std::sqrt(-m.rates(other)[3] / start.y[q]);
  start.y[q + 3] = start.y[q] * w2;
  RunOptions options;
  options.end = 30;
  const RunSummary s = simulate(*m.scene.model, *m.equations, *m.scene.integrator, start, options, {});
  const auto& components = s.peak_deflection.at("beam");
  EXPECT_GT(std::abs(w1 - w2) * options.end, 6) << "a whole beat at least";
  EXPECT_NEAR(components[1], components[2], 1e-3 * components[1]) << "between steps by cubics";
  EXPECT_NEAR(s.peak_deflection_ratio.at("beam"), std::hypot(components[1], components[2]), 2e-3 * components[1]);
}

// A pendulum of one stiff beam is fastest when it hangs, once in a run of many samples between: the rate of the run is
// that of energy, not that of the sample next to it.
TEST(Validity, the_greatest_rate_is_that_of_all_steps_and_loads_are_looked_at_there) {
  const std::string text =
      "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 0]\nformulation: quadratic\n"
      "integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}\nbodies:\n  rod: {type: beam, length: 1, "
      "mass_per_length: 1, bending_y: {stiffness: 1e5, modes: 1}}\nhinges:\n  h: {type: revolute, axis: [0, 0, 1], "
      "parent: world, child: rod}\ninitial: {hinges: {h: {position: [\"89.9 deg\"]}}}\n";
  Made m(text);
  RunOptions options;
  options.end = 6;
  const RunSummary s = simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {});
  const BodyValidity& rod = s.validity.bodies[0];
  // Half m g L (1 + sin) = m L^2 / 6 rate^2 from upright to hanging.
  const double rate = std::sqrt(3 * 9.81 * (1 + std::sin(std::numbers::pi * 89.9 / 180)));
  EXPECT_NEAR(rod.rate_ratio * rod.fundamental, rate, 2e-3 * rate);
  // There it carries its weight and three times that, of which a share stiffens; at the sample before it was less.
  Made hanging(text);
  State& y = hanging.scene.initial;
  y.y[0] = -std::numbers::pi / 2;
  y.y[2] = rate;
  const double load = load_of(hanging, "rod", {0, 0}).size();
  EXPECT_NEAR(rod.load.size(), load, 0.05 * load);
}

TEST(Validity, the_fastest_mode_of_an_unloaded_beam_is_its_last) {
  const Made m(cantilever("[0, 0, 0]", 2, 1e-12, "bending_y: {stiffness: 10, modes: 2}"));
  // The carried body's inertia of 1 kg m2 about z slows rotations of the tip; without the body the root is 22.0345.
  const Made bare(
      "format: withy/1\ntime: {end: 1}\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 2, "
      "bending_y: {stiffness: 10, modes: 2}}\nhinges:\n  h: {type: weld, parent: world, child: beam}\n");
  RunOptions options;
  options.end = 0.01;
  const auto fastest = [&](const Made& made) {
    return simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options, {})
        .fastest_mode;
  };
  EXPECT_NEAR(fastest(bare), 22.0345 * std::sqrt(5.0), 1e-3);
  EXPECT_LT(fastest(m), fastest(bare));
}

}  // namespace
}  // namespace withy::test
