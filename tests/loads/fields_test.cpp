/// \file
/// Fields on distributed mass against closed forms: orbits, libration, booms, shaken bases.
#include <cmath>
#include <numbers>

#include "scene_run.hpp"
#include "shown_outputs.hpp"
#include "withy/core/analysis/modes.hpp"
#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy::test {
namespace {

/// Frequencies [rad/s] of small motions about the initial state, nothing held, in increasing order.
std::vector<double> frequencies(const LoadedScene& c) {
  const TangentDynamics dynamics(c.scene.model, c.scene.formulation->terms());
  const std::size_t n = c.scene.model->layout().speeds;
  const Tangents t = dynamics.tangents(0, c.scene.initial.y, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n)));
  EXPECT_LT(t.residual.cwiseAbs().maxCoeff(), 1e-9) << "not in equilibrium";
  EXPECT_TRUE(t.differenced.empty());
  std::vector<double> all;
  for (const Mode& mode : natural_modes(t, Held(n, false))) all.push_back(mode.frequency());
  std::sort(all.begin(), all.end());
  return all;
}

/// Moments 2 (up), 5 (along the orbit), 6 (normal): pitch n √3 √((5 − 2)/6), roll and yaw by
/// s⁴ + (1 + 3 k₁ + k₁k₃) n² s² + 4 k₁k₃ n⁴ = 0, k₁ = (6 − 2)/5, k₃ = (6 − 5)/2 (Hughes 1986, section 9.2).
TEST(GravityGradient, librates_a_satellite_as_the_closed_form_says) {
  constexpr double n = 0.3;
  const LoadedScene c(R"(format: withy/1
time: {end: 1}
bodies: {bus: {type: rigid, mass: 3, inertia: [2, 5, 6, 0, 0, 0]}}
hinges: {attitude: {type: spherical, parent: world, child: bus}}
loads: {earth: {type: gravity-gradient, rate: 0.3, axes: orbit}}
)");
  constexpr double k1 = (6.0 - 2) / 5, k3 = (6.0 - 5) / 2;
  constexpr double b = 1 + 3 * k1 + k1 * k3;
  const double root = std::sqrt(b * b - 16 * k1 * k3);
  const std::vector<double> found = frequencies(c);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0], n * std::sqrt((b - root) / 2), 1e-12);
  EXPECT_NEAR(found[1], n * std::sqrt(3.0 * (5 - 2) / 6), 1e-12);
  EXPECT_NEAR(found[2], n * std::sqrt((b + root) / 2), 1e-12);
}

/// A boom held across axes that do not turn, stretched by the field as by a spin of √2 n, and pulled back across by n²:
/// ω² = ω_flap²(η = √2 n) + n², with the flap frequencies of a rotating cantilever (Wright et al. 1982).
TEST(GravityGradient, stretches_a_boom_as_the_textbook_says_of_a_rotating_one) {
  for (const auto& [eta, flap] : {std::pair(2.0, 4.13732), std::pair(6.0, 7.36037)}) {
    const double n = eta / std::numbers::sqrt2;
    const LoadedScene c(R"(format: withy/1
time: {end: 1}
formulation: consistent
bodies: {boom: {type: beam, length: 1, mass_per_length: 1, bending_z: {stiffness: 1, modes: 7}}}
hinges: {root: {type: weld, parent: world, child: boom}}
loads: {earth: {type: gravity-gradient, rate: )" +
                        std::to_string(n) + "}}\n");
    EXPECT_NEAR(frequencies(c)[0], std::sqrt(flap * flap + n * n), 2e-4) << eta;
  }
}

/// A hub with a boom that stands up, flexible or as a chain of rigid links with springs at their joints. What the links
/// leave falls with the square of their length: two chains, extrapolated.
TEST(GravityGradient, librates_a_flexible_boom_as_a_chain_of_rigid_links) {
  constexpr double length = 8, rho = 0.4, stiffness = 6;
  const std::string head =
      "format: withy/1\ntime: {end: 1}\nloads:\n  earth: {type: gravity-gradient, rate: 0.05, axes: orbit}\n";
  const std::string hub = "  hub: {type: rigid, mass: 20, inertia: [200, 200, 200, 0, 0, 0]}\n";
  const std::string axle = "  pitch: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n";
  const auto chain = [&](int links) {
    const double h = length / links, m = rho * h, I = m * h * h / 12;
    std::ostringstream loads, bodies, hinges;
    loads.precision(17), bodies.precision(17);
    for (int i = 0; i < links; ++i) {
      const std::string before = i == 0 ? "hub" : "l" + std::to_string(i - 1) + ".end";
      bodies << "  l" << i << ": {type: rigid, mass: " << m << ", center_of_mass: [" << h / 2
             << ", 0, 0], inertia: [0, " << I << ", " << I << ", 0, 0, 0], frames: {end: {position: [" << h
             << ", 0, 0]}}}\n";
      hinges << "  j" << i << ": {type: revolute, axis: [0, 0, 1], parent: " << before << ", child: l" << i << "}\n";
      loads << "  s" << i << ": {type: hinge-spring, hinge: j" << i
            << ", stiffness: " << stiffness / h * (i == 0 ? 2 : 1) << "}\n";
    }
    const LoadedScene c(head + loads.str() + "bodies:\n" + hub + bodies.str() + "hinges:\n" + axle + hinges.str());
    return frequencies(c);
  };
  const LoadedScene boom(head + "bodies:\n" + hub +
                         "  boom: {type: beam, length: 8, mass_per_length: 0.4, bending_y: {stiffness: 6, modes: 5}}\n"
                         "hinges:\n" +
                         axle + "  root: {type: weld, parent: hub, child: boom}\n");
  const std::vector<double> mine = frequencies(boom), coarse = chain(20), fine = chain(40);
  const double inertia = rho * length * length * length / 3, rigid = 0.05 * std::sqrt(3 * inertia / (200 + inertia));
  for (std::size_t i = 0; i < 2; ++i) {
    const double theirs = fine[i] + (fine[i] - coarse[i]) / 3;
    EXPECT_NEAR(mine[i], theirs, 2e-5 * theirs) << i;
  }
  EXPECT_GT(std::abs(mine[0] - rigid), 1e-3 * rigid) << "the boom is to be flexible enough to be seen";
}

/// Acceleration of a point of 2 kg at 0.5 m along x from a centre that is 10 m away, at rest.
Vector3 acceleration_beside_a_centre(const std::string& field, double t) {
  const LoadedScene c(
      "format: withy/1\ntime: {end: 1}\nbodies: {p: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {float: {type: free, parent: world, child: p}}\nloads: {field: {" +
      field + ", center: [10, 0, 0]}}\n");
  std::vector<double> y = c.scene.initial.y, y_dot(c.equations->size());
  y[4] = 10.5;
  Work work = c.equations->make_work();
  EXPECT_TRUE(c.equations->derivatives(t, y, y_dot, work).ok());
  return {y_dot[7 + 3], y_dot[7 + 4], y_dot[7 + 5]};
}

/// n² (3 e eᵀ − 1) p with e an eighth of an orbit on; in axes of the orbit 2 n² along e and n² of turning.
TEST(GravityGradient, goes_round_with_the_orbit_about_the_centre_given) {
  constexpr double n = 0.4;
  const std::string orbit = "type: gravity-gradient, rate: 0.4";
  EXPECT_LT((acceleration_beside_a_centre(orbit, std::numbers::pi / 4 / n) - n * n * Vector3(0.25, 0.75, 0)).norm(),
            1e-14);
  EXPECT_LT((acceleration_beside_a_centre(orbit + ", axes: orbit", 1) - n * n * Vector3(1.5, 0, 0)).norm(), 1e-14);
}

/// Ω² p outwards and, while the rate Ω = 0.4 + 0.3 t grows, 0.3 p backwards.
TEST(RotatingFrame, turns_about_the_centre_given_ever_faster) {
  const Vector3 found = acceleration_beside_a_centre("type: rotating-frame, rate: 0.4, acceleration: 0.3", 2);
  EXPECT_LT((found - Vector3(0.5, -0.15, 0)).norm(), 1e-14);
}

TEST(BaseExcitation, ends_where_its_law_does) {
  const LoadedScene c(
      "format: withy/1\nbodies: {p: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\nhinges: {float: {type: free, "
      "parent: world, child: p}}\nloads: {base: {type: base-excitation, law: table, table: [[0, 0, 0, 0], [0.3, 1, 0, "
      "0], [0.7, 0, 0, 0]]}}\n");
  EXPECT_EQ(c.scene.model->loads()[0].load->end(), 0.7);
}

/// Of eccentricity 0.3; a sphere, which is attracted as a point, is where it began, and a dumbbell that tumbles keeps
/// its energy as well.
TEST(PointGravity, keeps_the_energy_of_a_hundred_orbits) {
  // μ = 1, half axis 1: period 2π, perigee 0.7, speed √(1.3/0.7) there.
  for (const bool sphere : {true, false}) {
    const std::string inertia = sphere ? "[0.002, 0.002, 0.002, 0, 0, 0]" : "[0.001, 0.002, 0.002, 0, 0, 0]";
    const LoadedScene made(
        "format: withy/1\ntime: {end: 1, output: 1}\n"
        "integrator: {name: dopri5, rtol: 1e-12, atol: 1e-14}\n"
        "bodies: {a: {type: rigid, mass: 1, inertia: " +
        inertia +
        "}}\nhinges: {orbit: {type: free, parent: world, child: a}}\n"
        "loads: {sun: {type: point-gravity, parameter: 1}}\n");
    const Layout& layout = made.scene.model->layout();
    State start = made.scene.initial;
    const Slot& slot = *layout.hinge("orbit");
    start.y[slot.position + 4] = 0.7;
    start.y[layout.positions + slot.speed + 4] = std::sqrt(1.3 / 0.7);
    start.y[layout.positions + slot.speed + 2] = 0.8;
    RunOptions options;
    options.end = 200 * std::numbers::pi;
    options.output = options.end / 100;
    const RunSummary run =
        simulate(*made.scene.model, *made.equations, *made.scene.integrator, start, options, [](const State&) {});
    ASSERT_EQ(run.status, RunStatus::completed) << run.message;
    EXPECT_LT(run.energy_drift, 1e-9);
    if (!sphere) continue;
    const Eigen::Map<const Vector3> p(run.final.y.data() + slot.position + 4);
    const Eigen::Map<const Vector3> v(run.final.y.data() + layout.positions + slot.speed + 3);
    EXPECT_LT((p - Vector3(0.7, 0, 0)).norm(), 1e-6);
    EXPECT_NEAR(0.5 * v.squaredNorm() - 1 / p.norm(), -0.5, 1e-9);
  }
}

/// What a point mass at `sun` gives a body in a thousandth of a second from rest: momentum and, about `middle`, angular
/// momentum.
std::pair<Vector3, Vector3> pull_at(const std::string& body, const Vector3& middle, const Vector3& sun) {
  const Shown s(
      "format: withy/1\ntime: {end: 0.001, output: 0.001}\n"
      "integrator: {name: dopri5, rtol: 1e-10, atol: 1e-14}\n"
      "bodies: {body: " +
      body +
      "}\nhinges: {float: {type: free, parent: world, child: body}}\n"
      "outputs: {given: {type: momentum}}\nloads: {sun: {type: point-gravity, parameter: 100, center: [" +
      std::to_string(sun.x()) + ", " + std::to_string(sun.y()) + ", " + std::to_string(sun.z()) + "]}}\n");
  const auto last = [&](const char* name) { return s[name].back(); };
  const Vector3 momentum(last("given.x"), last("given.y"), last("given.z"));
  const Vector3 angular(last("given.angular_x"), last("given.angular_y"), last("given.angular_z"));
  return {momentum, angular - middle.cross(momentum)};
}

/// A plate of 1.2 m by 0.7 m and 2.7 kg/m².
std::pair<Vector3, Vector3> pull_at_plate(int modes, const Vector3& sun) {
  return pull_at("{type: plate, length: 1.2, width: 0.7, mass_per_area: 2.7, stiffness: 1000, modes: " +
                     std::to_string(modes) + "}",
                 Vector3(0.6, 0, 0), sun);
}

/// The moment about the middle is of second order in size over distance; its error is of fourth, for the plate is
/// symmetric. Modes are at rest: how many there are does not matter.
TEST(PointGravity, pulls_at_a_plate_as_at_its_mass_and_at_its_mirror_image_alike) {
  const Vector3 sun(15, 15.5, 11.5);
  Vector3 force = Vector3::Zero(), moment = Vector3::Zero();
  const int cells = 200;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const Vector3 arm(1.2 * ((i + 0.5) / cells - 0.5), 0.7 * ((j + 0.5) / cells - 0.5), 0);
      const Vector3 away = sun - Vector3(0.6, 0, 0) - arm;
      const Vector3 pull = 100 * 2.7 * 1.2 * 0.7 / (cells * cells) * away / std::pow(away.norm(), 3);
      force += pull;
      moment += arm.cross(pull);
    }
  }
  for (const int modes : {0, 1, 3, 6}) {
    const auto [given, turned] = pull_at_plate(modes, sun);
    EXPECT_LT((given / 0.001 - force).norm(), 1e-5 * force.norm()) << modes << " modes";
    EXPECT_LT((turned / 0.001 - moment).norm(), 1e-2 * moment.norm()) << modes << " modes";
    const auto [mirrored, back] = pull_at_plate(modes, Vector3(sun.x(), -sun.y(), sun.z()));
    EXPECT_LT((mirrored - Vector3(given.x(), -given.y(), given.z())).norm(), 1e-9 * given.norm()) << modes << " modes";
    EXPECT_LT((back - Vector3(-turned.x(), turned.y(), -turned.z())).norm(), 1e-6 * turned.norm()) << modes << " modes";
  }
}

/// A boom of 1 m by 20 mm by 10 mm from a file, which is its own mirror image across two planes. The moment of a
/// slender boom, of which a body without third moments is known.
TEST(PointGravity, pulls_at_a_body_of_a_file_and_at_its_mirror_image_alike) {
  const std::string boom = "{type: modal, file: " + std::string(WITHY_SOURCE_DIRECTORY) + "/scenes/cantilever.SID_FEM}";
  const Vector3 middle(0.5, 0, 0), sun(15, 15.5, 11.5);
  Vector3 moment = Vector3::Zero();
  const int cells = 10000;
  for (int i = 0; i < cells; ++i) {
    const Vector3 arm((i + 0.5) / cells - 0.5, 0, 0), away = sun - middle - arm;
    moment += arm.cross(Vector3(100 * 1.57 / cells * away / std::pow(away.norm(), 3)));
  }
  const auto [given, turned] = pull_at(boom, middle, sun);
  EXPECT_LT((turned / 0.001 - moment).norm(), 5e-3 * moment.norm());
  for (const int axis : {1, 2}) {
    Vector3 across = Vector3::Ones();
    across[axis] = -1;
    const auto [mirrored, back] = pull_at(boom, middle, sun.cwiseProduct(across));
    EXPECT_LT((mirrored - given.cwiseProduct(across)).norm(), 1e-9 * given.norm()) << axis;
    EXPECT_LT((back + turned.cwiseProduct(across)).norm(), 1e-6 * turned.norm()) << axis;
  }
}

/// A boom on a slide that is driven, or on a base that is shaken as the slide would be: motion relative to it is one.
TEST(BaseExcitation, moves_a_tree_as_a_driven_slide_does) {
  const std::string head = R"(format: withy/1
time: {end: 1.5, output: 0.05}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
gravity: [0, -9.81, 0]
bodies:
  boom: {type: beam, length: 1.5, mass_per_length: 0.7, bending_y: {stiffness: 9, modes: 2}}
)";
  const double w = 2 * std::numbers::pi * 2;
  std::ostringstream law;
  law.precision(17);
  law << -0.05 * w * w << "*sin(2*pi*2*t)";
  LoadedScene shaken(head + "hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}\n" +
                     "loads: {base: {type: base-excitation, formula: [\"" + law.str() + "\", \"0\", \"0\"]}}\n");
  LoadedScene driven(head + "  cart: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n" +
                     "  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}\n"
                     "  pin: {type: revolute, axis: [0, 0, 1], parent: cart, child: boom}\n"
                     "motions: {shake: {hinge: slide, type: sine, amplitude: 0.05, period: 0.5}}\n");
  const std::vector<State> a = shaken.run(), b = driven.run();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(shaken.position(a[i], "pin"), driven.position(b[i], "pin"), 1e-8);
  EXPECT_GT(std::abs(shaken.position(a[5], "pin")), 0.1);
}

/// In free fall an accelerometer at the centre of mass shows nothing; 10 m further up it is held back by 3 n² · 10 m.
TEST(Fields, are_not_felt_by_an_accelerometer) {
  const LoadedScene c(R"(format: withy/1
time: {end: 1}
bodies: {bus: {type: rigid, mass: 3, inertia: [2, 5, 6, 0, 0, 0], frames: {up: {position: [10, 0, 0]}}}}
hinges: {orbit: {type: free, parent: world, child: bus}}
loads: {earth: {type: gravity-gradient, rate: 0.3, axes: orbit}}
outputs: {here: {type: accelerometer, of: bus}, up: {type: accelerometer, of: bus.up}}
)");
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> values(reader.columns().size());
  ASSERT_TRUE(reader.read(c.scene.initial, values));
  const std::vector<double> expected{0, 0, 0, -0.27 * 10, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(values[i], expected[i], 1e-13) << i;
}

/// What is wrong is said with its place, and is no exception from deeper down.
/// What the motion of a scene's start does to the stiffness of its beam, and what its bodies feel.
struct Felt {
  explicit Felt(const std::string& text) : c(text), motion(*c.scene.model) {
    std::vector<double> rates(c.equations->size());
    Work work = c.equations->make_work();
    EXPECT_TRUE(c.equations->derivatives(c.scene.initial.time, c.scene.initial.y, rates, work).ok());
    const Layout& layout = c.scene.model->layout();
    motion.update(c.scene.initial.y, std::span<const double>(rates).subspan(layout.positions, layout.speeds));
    FeltMotion felt(*c.scene.model, *c.equations);
    felt.update(c.scene.initial, motion.bodies());
    bodies = felt.bodies();
    boom = static_cast<std::size_t>(c.scene.model->body("boom"));
    load = MotionStiffness(*c.scene.model, boom).evaluate(bodies, felt.at_frames());
  }
  LoadedScene c;
  TreeMotion motion;
  std::vector<BodyMotion> bodies;
  std::size_t boom = 0;
  LoadRatio load;
};

void expect_alike(const Felt& a, const Felt& b) {
  EXPECT_GT(a.load.size(), 0.01) << "nothing is felt";
  EXPECT_NEAR(a.load.least, b.load.least, 1e-9);
  EXPECT_NEAR(a.load.greatest, b.load.greatest, 1e-9 * (1 + std::abs(b.load.greatest)));
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const Vector3 difference =
        a.bodies[i].R.transpose() * a.bodies[i].force - b.bodies[i].R.transpose() * b.bodies[i].force;
    EXPECT_LT(difference.norm(), 1e-9 * (1 + b.bodies[i].force.norm())) << i;
  }
}

/// A boom with a tip mass on a hub; hinge, loads and motion follow.
std::string hub_with_boom(const std::string& rest) {
  return R"(format: withy/1
time: {end: 1}
bodies:
  hub: {type: rigid, mass: 3, center_of_mass: [0.1, 0.2, 0], inertia: [2, 5, 6, 0, 0, 0], frames: {out: {position: [0.5, 0.1, 0]}}}
  boom: {type: beam, length: 4, mass_per_length: 0.3, bending_y: {stiffness: 12, modes: 2}, bending_z: {stiffness: 9, modes: 1}}
  tip: {type: rigid, mass: 0.7, center_of_mass: [0.2, 0, 0.1], inertia: [0.02, 0.02, 0.02, 0, 0, 0]}
)" + rest;
}

// Weight, as a base that is shaken the other way; a driven shaft, at rest in axes that turn with it.
TEST(Fields, load_bodies_as_the_motions_that_they_stand_for) {
  const std::string falling = R"(hinges:
  float: {type: free, parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
  end: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: tip}
initial: {hinges: {float: {rate: [0.3, -0.2, 0.4, 1, 2, 3]}, end: {position: [0.3], rate: [1]}}, bodies: {boom: {modes: [0.05, 0.01, -0.02], rates: [0.3, 0.1, 0.2]}}}
loads: {push: {type: force, frame: hub, value: [40, -30, 25]}
)";
  expect_alike(Felt(hub_with_boom(falling + "  , shaker: {type: base-excitation, value: [1, 9.81, -2]}}\n")),
               Felt(hub_with_boom(falling + "  }\ngravity: [-1, -9.81, 2]\n")));
  const std::string on_shaft = R"(hinges:
  shaft: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
  end: {type: weld, parent: boom.tip, child: tip}
)";
  expect_alike(Felt(hub_with_boom(on_shaft + "motions: {hold: {type: locked, hinge: shaft}}\nloads: {axes: {type: "
                                             "rotating-frame, axis: [0, 0, 1], rate: 0.8}}\n")),
               Felt(hub_with_boom(on_shaft + "motions: {spin: {type: constant-rate, hinge: shaft, rate: 0.8}}\n")));
}

// Along the vertical of an orbit mass feels 3 n² x, all of it: a uniform field would miss the boom's own.
TEST(Fields, pull_at_a_boom_over_all_of_its_length) {
  const Felt f(R"(format: withy/1
time: {end: 1}
bodies: {boom: {type: beam, length: 4, mass_per_length: 0.3, bending_y: {stiffness: 12, modes: 2}}}
hinges: {root: {type: weld, parent: world, child: boom, offset: {position: [1, 0, 0]}}}
loads: {earth: {type: gravity-gradient, rate: 0.3, axes: orbit}}
)");
  EXPECT_NEAR(f.bodies[f.boom].force.x(), -3 * 0.09 * 0.3 * (25 - 1) / 2, 1e-12);
  EXPECT_NEAR(f.bodies[f.boom].gradient(0, 0), 3 * 0.09, 1e-15);
}

/// A bead slides outward in axes that turn at 2, from 0.5 s on at 3, from 0.8 s on not at all: r as of cosh and sinh,
/// then straight on. An accelerometer on it feels nothing along the slide, a reaction across it Coriolis' force; the
/// energy that the field has given is its work.
TEST(Fields, change_at_events) {
  LoadedScene c(R"(format: withy/1
time: {end: 1, output: 0.1}
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies: {bead: {type: rigid, mass: 2}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: bead}}
initial: {hinges: {slide: {position: [0.3]}}}
loads: {axes: {type: rotating-frame, rate: 2}}
outputs: {imu: {type: accelerometer, of: bead}, held: {type: reaction, hinge: slide}}
events: {faster: {at: 0.5, do: {set: loads.axes.rate=3}}, off: {at: 0.8, do: {switch_off: axes}}}
)");
  const std::vector<State> states = c.run();
  double r = 0.3, v = 0, from = 0, rate = 2;
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> seen(reader.columns().size());
  for (const State& s : states) {
    if (from < 0.5 && s.time >= 0.5 - 1e-12) {
      r = 0.3 * std::cosh(1.0), v = 0.6 * std::sinh(1.0), from = 0.5, rate = 3;
    }
    if (from < 0.8 && s.time >= 0.8 - 1e-12) {
      const double r0 = r, v0 = v;
      r = r0 * std::cosh(0.9) + v0 / 3 * std::sinh(0.9), v = 3 * r0 * std::sinh(0.9) + v0 * std::cosh(0.9);
      from = 0.8, rate = 0;
    }
    const double t = s.time - from;
    const double place = rate > 0 ? r * std::cosh(rate * t) + v / rate * std::sinh(rate * t) : r + v * t;
    const double speed = rate > 0 ? rate * r * std::sinh(rate * t) + v * std::cosh(rate * t) : v;
    EXPECT_NEAR(c.position(s, "slide"), place, 1e-9) << s.time;
    EXPECT_NEAR(c.rate(s, "slide"), speed, 1e-9) << s.time;
    EXPECT_NEAR(s.y.back(), speed * speed - 0, 1e-8) << "work is the kinetic energy of 2 kg at " << s.time;
    if (std::abs(s.time - from) < 1e-12) continue;  // both sides of a jump
    ASSERT_TRUE(reader.read(s, seen));
    EXPECT_NEAR(seen[0], 0, 1e-9) << s.time;
    EXPECT_NEAR(seen[1], 2 * rate * speed, 1e-8) << s.time;
    EXPECT_NEAR(seen[4], 2 * 2 * rate * speed, 1e-8) << s.time;
  }
  EXPECT_LT(std::abs(c.summary.energy_drift), 1e-9);
}

TEST(Fields, refuse_what_has_no_meaning) {
  const std::string head =
      "format: withy/1\ntime: {end: 1}\nbodies: {a: {type: rigid, mass: 1}}\n"
      "hinges: {h: {type: free, parent: world, child: a}}\nloads: {f: {";
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"type: gravity-gradient, rate: 1, vertical: [1, 0, 1]", "is not perpendicular to 'normal'"},
      {"type: gravity-gradient, rate: 1, normal: [0, 0, 0]", "has no length"},
      {"type: point-gravity, parameter: -1", "need"},
      {"type: base-excitation", "need one of 'law' and 'formula'"},
      {"type: base-excitation, formula: [\"x\", \"0\", \"0\"]", "there is nothing called 'x'"},
      {"type: base-excitation, formula: [\"0\", \"0\"]", "three formulas"},
      {"type: rotating-frame, rate: 1, axis: [0, 0, 0]", "has no length"}};
  for (const auto& [load, message] : wrong) {
    try {
      const LoadedScene c(head + load + "}}\n");
      ADD_FAILURE() << load;
    } catch (const std::exception& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("test.yaml:5"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace withy::test
