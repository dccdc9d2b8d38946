// Simulations that a host steps.
#include "withy/host/simulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <thread>

#include "withy/tests/host/busy.hpp"

namespace withy {
namespace {

using host::Scene;
using host::Simulation;
using host::Snapshot;
using test::busy_scene;
using test::drive;
using test::library;
using testing::HasSubstr;

// x'' = τ/J with τ held, then a ramp: polynomials, whatever the steps.
TEST(HostedSimulation, moves_as_its_inputs_say) {
  for (const bool linear : {false, true}) {
    Scene scene = Scene::parse(library(), R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {command: {type: input, hinge: axle, hold: constant}}
)");
    if (linear) scene.set("loads.command.hold", "linear");
    Simulation simulation(scene);
    EXPECT_EQ(simulation.inputs().at(0).unit, "N m");
    const double J = 0.2;
    double x = 0, v = 0, before = 0;
    for (const auto& [t, h, tau] :
         std::vector<std::array<double, 3>>{{0.5, 0.5, 0.4}, {0.75, 0.25, 0.4}, {2, 1.25, -1}}) {
      simulation.set_input("command", tau);
      EXPECT_EQ(simulation.input("command"), tau);
      simulation.step(t);
      EXPECT_EQ(simulation.time(), t);
      const double from = linear ? before : tau;
      x += h * v + h * h / J * (from / 3 + tau / 6);
      v += h / J * (from + tau) / 2;
      before = tau;
      EXPECT_NEAR(simulation.output("axle"), x, 1e-9);
      EXPECT_NEAR(simulation.output("axle.rate"), v, 1e-9);
      EXPECT_EQ(simulation.output("t"), t);
    }
  }
}

// Communication points change nothing but where steps end: the run of the scene is met within its tolerance.
TEST(HostedSimulation, without_inputs_is_the_run_of_the_scene) {
  const Scene scene =
      Scene::read(library(), WITHY_SOURCES "/scenes/two-link-slew.yaml")
          .set("outputs", "{imu: {type: accelerometer, of: link2.tip}, drive: {type: effort, hinge: shoulder}}");
  const host::Result run = scene.run();
  ASSERT_EQ(run.status, "completed") << run.message;
  Simulation simulation(scene);
  ASSERT_EQ(simulation.outputs().size(), run.columns.size());
  for (std::size_t i = 0; i < run.columns.size(); ++i) {
    EXPECT_EQ(simulation.outputs()[i].name, run.columns[i].name);
    EXPECT_EQ(simulation.outputs()[i].unit, run.columns[i].unit);
  }
  const std::vector<double> t = run.column("t"), shoulder = run.column("shoulder"), tip = run.column("link2.tip.x"),
                            imu = run.column("imu.x"), drive = run.column("drive");
  for (std::size_t i = 1; i < t.size(); i += 7) {
    simulation.step(t[i]);
    EXPECT_NEAR(simulation.output("shoulder"), shoulder[i], 1e-5);
    EXPECT_NEAR(simulation.output("link2.tip.x"), tip[i], 1e-5);
    EXPECT_NEAR(simulation.output("imu.x"), imu[i], 1e-3);
    EXPECT_NEAR(simulation.output("drive"), drive[i], 1e-9);
  }
}

TEST(HostedSimulation, gives_the_same_bits_on_many_threads) {
  const Scene scene = busy_scene();
  Simulation alone(scene);
  const std::vector<double> expected = drive(alone, 0, 20);
  std::vector<std::vector<double>> got(8);
  std::vector<std::thread> threads;
  for (std::vector<double>& rows : got) {
    threads.emplace_back([&] {
      for (int times = 0; times < 3; ++times) {
        Simulation simulation(Scene::parse(library(), test::busy_arm));
        rows = drive(simulation, 0, 20);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& rows : got) EXPECT_EQ(rows, expected);
}

/// WITHY_MODELS sets their number: 1,000 under sanitizers (docs/faults.md).
TEST(HostedSimulation, made_stepped_and_destroyed_on_four_threads_are_what_they_are_on_one) {
  const char* asked = std::getenv("WITHY_MODELS");
  const int models = asked != nullptr ? std::atoi(asked) : 24;
  // Formulations and integrators of every kind, each in a scene of its own, by a library of its own now and then.
  const auto model = [](int k) {
    constexpr const char* formulations[] = {"quadratic", "ruthless", "linear", "exact", "consistent"};
    constexpr const char* integrators[] = {"dopri5", "rk4", "dop853", "radau"};
    const std::optional<host::Library> own = k % 16 == 0 ? std::optional<host::Library>(std::in_place) : std::nullopt;
    Scene scene = Scene::parse(own ? *own : library(), test::busy_arm);
    scene.set("formulation", formulations[k % 5]);
    scene.set("integrator", k % 4 == 1 ? "{name: rk4, step: 0.01}" : integrators[k % 4]);
    scene.set("bodies.boom.mass_per_length", 0.4 + 0.001 * (k % 7));
    Simulation simulation(scene);
    return drive(simulation, 0, 3);
  };
  std::vector<std::vector<double>> one(140);
  for (int k = 0; k < std::min(models, 140); ++k) one[static_cast<std::size_t>(k)] = model(k);
  std::atomic<int> next{0}, wrong{0};
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int k = next++; k < models; k = next++)
          if (model(k) != one[static_cast<std::size_t>(k % 140)]) ++wrong;
      });
  }
  EXPECT_EQ(wrong, 0);
}

TEST(HostedSimulation, passes_events_or_halts_at_them) {
  Simulation passing(busy_scene()), halting(busy_scene());
  for (Simulation* s : {&passing, &halting}) s->set_input("torque", 0.2);
  passing.step(1);
  std::vector<std::string> names;
  for (const host::Event& e : passing.events()) names.push_back(e.name);
  ASSERT_THAT(names, testing::IsSupersetOf({"forth", "halt"}));
  EXPECT_FALSE(halting.advance_to(1));
  EXPECT_LT(halting.time(), 1);
  EXPECT_EQ(halting.events().back().name, "halt");
  EXPECT_NEAR(halting.output("axle"), 0.1, 1e-9);
  halting.step(1);
  EXPECT_NEAR(halting.output("axle"), passing.output("axle"), 1e-5);
}

// A spring of 4 N m/rad on 1 kg m^2 passes zero each half period, at pi/4, 3 pi/4, 5 pi/4.
TEST(HostedSimulation, halts_each_time_at_an_event_that_only_stops_and_once_where_it_does_something) {
  const auto halts = [](const std::string& more) {
    Simulation simulation(Scene::parse(library(), R"(
format: withy/1
time: {end: 5}
integrator: {name: dop853, rtol: 1e-10, atol: 1e-10}
bodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 4}
  idle: {type: expression, hinge: axle, value: 0 * t}
events: {middle: {hinge: axle, value: 0, stop: true)" +
                                                      more + R"(}}
initial: {hinges: {axle: {position: 0.1}}}
)"));
    std::vector<double> times;
    while (!simulation.advance_to(4.5)) times.push_back(simulation.time());
    return times;
  };
  const double quarter = std::numbers::pi / 4;
  const auto near = [](double t) { return testing::DoubleNear(t, 1e-8); };
  const auto all = testing::ElementsAre(near(quarter), near(3 * quarter), near(5 * quarter));
  EXPECT_THAT(halts(""), all);
  EXPECT_THAT(halts(", repeat: true"), all);
  EXPECT_THAT(halts(", do: {switch_off: idle}"), testing::ElementsAre(near(quarter)));
  EXPECT_THAT(halts(", do: {switch_off: idle}, repeat: true"), all);
}

TEST(HostedSimulation, halts_at_a_stop_that_is_where_it_goes_anyway) {
  Simulation simulation(Scene::parse(library(), R"(
format: withy/1
time: {end: 5}
bodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
events: {over: {at: 1, stop: true}}
)"));
  EXPECT_TRUE(simulation.advance_to(0.5));
  EXPECT_FALSE(simulation.advance_to(1));
  EXPECT_EQ(simulation.time(), 1);
  EXPECT_EQ(simulation.events().back().name, "over");
  EXPECT_TRUE(simulation.advance_to(1.5)) << "it may go on";
}

TEST(HostedSimulation, begins_anew_from_its_state_with_motions_that_it_moves) {
  for (const char* sets : {"position", "rate", "acceleration"}) {
    Scene scene = Scene::parse(library(), R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
time: {end: 5}
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  rod: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: hub}
  pin: {type: revolute, axis: [0, 0, 1], parent: hub, child: rod}
motions: {drive: {hinge: rail, type: input, sets: )" +
                                              std::string(sets) + "}}\ninitial: {hinges: {pin: {position: 0.4}}}\n");
    Simulation driven(scene);
    for (int k = 1; k <= 5; ++k) {
      driven.set_input("drive", std::string(sets) == "position" ? 0.01 * k * k : 0.2 * k);
      driven.step(0.1 * k);
    }
    scene.set("initial", driven.state());
    Simulation begun(scene);
    EXPECT_GT(driven.output("rail.rate"), 0.1) << sets;
    for (const double t : {0.5, 0.8}) {  // nothing is set from here on
      driven.step(t);
      begun.step(t);
      for (const char* output : {"rail", "rail.rate", "pin", "pin.rate"})
        EXPECT_NEAR(begun.output(output), driven.output(output), 1e-8) << sets << ' ' << output << ' ' << t;
    }
  }
}

TEST(HostedSimulation, that_cannot_go_on_says_why_and_may_go_back) {
  Scene scene = Scene::read(library(), WITHY_SOURCES "/scenes/two-link-slew.yaml");
  Simulation simulation(scene.set("loads.slew.time_scale", 1.2).formulation("consistent"));
  simulation.step(0.01);
  const Snapshot good = simulation.snapshot();
  try {
    simulation.step(3);
    FAIL();
  } catch (const host::SimulationStopped& e) {
    EXPECT_EQ(e.status(), "singular");
    EXPECT_THAT(e.what(), HasSubstr("The mass matrix of this formulation became singular"));
    EXPECT_EQ(e.time(), simulation.time());
    EXPECT_LT(e.time(), 3);
  }
  const double stands = simulation.time();
  const auto stopped_again = [&](auto&& act) {
    try {
      act();
      return std::string("not stopped");
    } catch (const host::SimulationStopped& e) {
      EXPECT_EQ(e.time(), stands);
      EXPECT_THAT(e.what(), HasSubstr("The mass matrix of this formulation became singular"));
      return e.status();
    }
  };
  EXPECT_EQ(stopped_again([&] { simulation.step(3); }), "singular");
  EXPECT_EQ(stopped_again([&] { simulation.advance_to(stands); }), "singular");
  EXPECT_EQ(stopped_again([&] { static_cast<void>(simulation.snapshot()); }), "singular");
  EXPECT_THROW(simulation.step(0), std::invalid_argument);
  EXPECT_EQ(simulation.time(), stands);
  simulation.restore(good);
  simulation.step(0.02);
  EXPECT_EQ(simulation.time(), 0.02);
}

/// A boom with a heavy body beside its axis, in space: bent, M0 + M1 loses the inertia of a motion. Steps go on there
/// until time resolves no more, 80,000 of them, but for the watch that runs have too.
TEST(HostedSimulation, whose_steps_come_to_nothing_where_a_motion_has_no_inertia_ends) {
  Scene scene = Scene::parse(library(), R"(
format: withy/1
time: {end: 1}
formulation: symmetric
integrator: {name: dop853, rtol: 1e-12, atol: 1e-12}
bodies:
  boom: {type: beam, length: 2, mass_per_length: 1.2, bending_y: {stiffness: 60, modes: 2}, bending_z: {stiffness: 40, modes: 1}, torsion: {stiffness: 20, inertia: 0.02, modes: 1}}
  arm: {type: rigid, mass: 0.5, center_of_mass: [0.2, 0.1, 0], inertia: [0.05, 0.08, 0.07, 0, 0, 0]}
hinges:
  root: {type: spherical, parent: world, child: boom, offset: {position: [0.3, 0.2, 0.1]}}
  wrist: {type: revolute, axis: [0.2, 0.3, 1], parent: boom.tip, child: arm}
initial: {bodies: {boom: {modes: [0.045, 0, 0.045, 0.045]}}}
)",
                             "boom");
  Simulation simulation(scene);
  try {
    for (int k = 1; k <= 1000; ++k) simulation.step(1e-3 * k);
    FAIL();
  } catch (const host::SimulationStopped& e) {
    EXPECT_EQ(e.status(), "singular");
    EXPECT_THAT(e.what(), HasSubstr("the steps come to nothing"));
    EXPECT_THAT(e.what(), testing::Not(HasSubstr("not the reason")));
  }
  constexpr std::size_t of_a_step = 12;
  EXPECT_LT(simulation.evaluations(), 20000 * of_a_step);
}

TEST(HostedSimulation, that_is_interrupted_goes_on) {
  int asked = 0;
  Simulation simulation(busy_scene(), [&] { return ++asked == 5; });
  EXPECT_THROW(simulation.step(1), host::SimulationStopped);
  EXPECT_LT(simulation.time(), 1);
  simulation.step(1);
  EXPECT_EQ(simulation.time(), 1);
}

TEST(HostedSimulation, finds_modal_coordinates_as_the_table_in_csv_names_them_too) {
  const Simulation simulation(test::smooth_arm());
  EXPECT_EQ(simulation.output_index("boom.bending_y.2.rate"), simulation.output_index("boom.bending_y[2].rate"));
  EXPECT_THROW(static_cast<void>(simulation.output_index("boom.bending_y.3")), std::out_of_range);
}

TEST(HostedSimulation, refuses_bad_use_and_lives_on) {
  Simulation simulation(busy_scene());
  const auto text_of = [](auto&& act) -> std::string {
    try {
      act();
    } catch (const std::exception& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(text_of([&] { simulation.set_input("torqe", 1); }), HasSubstr("did you mean 'torque'"));
  EXPECT_THAT(text_of([&] { simulation.set_input("torque", std::nan("")); }), HasSubstr("need a finite number"));
  EXPECT_THAT(text_of([&] { static_cast<void>(simulation.output("axel")); }), HasSubstr("did you mean 'axle'"));
  EXPECT_THROW(static_cast<void>(simulation.output(1000)), std::out_of_range);
  EXPECT_THROW(simulation.restore(Snapshot()), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Snapshot::of_numbers(std::vector<double>{1, 2, 3})), std::invalid_argument);
  Simulation pendulum(Scene::read(library(), WITHY_SOURCES "/scenes/pendulum.yaml"));
  EXPECT_THAT(text_of([&] { simulation.restore(pendulum.snapshot()); }), HasSubstr("of another scene"));
  simulation.step(0.1);
  EXPECT_THAT(text_of([&] { simulation.step(0.05); }), HasSubstr("before the present one"));
  EXPECT_THAT(text_of([&] { simulation.step(std::nan("")); }), HasSubstr("need a finite number"));
  EXPECT_THAT(text_of([&] { simulation.step(INFINITY); }), HasSubstr("need a finite number"));
  EXPECT_THAT(text_of([] { const Simulation automatic(busy_scene().formulation("auto")); }), HasSubstr("got 'auto'"));
  Simulation fresh(busy_scene());
  fresh.step(0.1);
  simulation.step(0.2);
  fresh.step(0.2);
  EXPECT_EQ(std::vector<double>(simulation.output_values().begin(), simulation.output_values().end()),
            std::vector<double>(fresh.output_values().begin(), fresh.output_values().end()));
}

}  // namespace
}  // namespace withy
