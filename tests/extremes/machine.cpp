/// \file
/// What the processor does to us, and what we do to it: denormal numbers, its floating-point state, threads; and
/// rotations.
#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "campaign.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/plugins/host/plugin_host.hpp"

namespace withy::extremes {

void denormals(Campaign& campaign) {
  for (const std::string& formulation : formulations) {
    const Made made(scene_text("spacecraft"), formulation);
    State none = made.scene.initial, small = none;
    std::fill(none.y.begin(), none.y.end(), 0.0);
    std::fill(small.y.begin(), small.y.end(), 1e-310);
    for (std::size_t h = 0; h < made.layout().hinges.size(); ++h) {
      const Slot& slot = made.layout().hinges[h];
      if (slot.positions != slot.speeds) small.y[slot.position] = none.y[slot.position] = 1;  // a quaternion
    }
    campaign.at_most(formulation + ", spacecraft, all coordinates and rates 1e-310", "the same with zeros",
                     difference(made.accelerations(small), made.accelerations(none)), 1e-12);
  }
  // A plugin linked with -ffast-math sets flush-to-zero when it is loaded.
  volatile double least = std::numeric_limits<double>::min();
  std::string refusal = "not refused";
  {
    Registry registry;
    const PluginHost host({WITHY_FAST_MATH_PLUGIN});
    host.attach(registry);
    try {
      (void)registry.find<Body>("extremes-fast-math");
    } catch (const PluginError& e) {
      refusal = e.what();
      const std::size_t at = refusal.find("is refused");
      refusal = at == std::string::npos ? refusal : refusal.substr(at);
    }
  }
  campaign.row("a plugin linked with -ffast-math", "½ of the least normal number is not 0",
               "refused, the state as before", refusal.substr(0, 90),
               refusal.find("flush-to-zero") != std::string::npos && least / 2 > 0);
}

void threads(Campaign& campaign) {
  const auto final_state = [](const Made& made) {
    RunOptions options;
    options.end = 0.3;
    return simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, {}).final.y;
  };
  for (const std::string& formulation : formulations) {
    // One model and one set of equations for all threads.
    const Made made(scene_text("spacecraft"), formulation);
    const std::vector<double> alone = final_state(made);
    const int count = campaign.quick() ? 4 : 64;
    std::vector<std::vector<double>> found(static_cast<std::size_t>(count));
    std::vector<std::thread> all;
    for (auto& f : found) all.emplace_back([&made, &f, &final_state] { f = final_state(made); });
    for (std::thread& t : all) t.join();
    const auto equal = std::count(found.begin(), found.end(), alone);
    campaign.row(fmt::format("{}, {} threads on one model", formulation, count), "one thread alone", "bitwise",
                 fmt::format("{} of {} bitwise", equal, count), equal == count);
  }
}

void rotations(Campaign& campaign) {
  // q and −q are one rotation.
  for (const std::string& formulation : formulations) {
    const Made made(scene_text("spacecraft"), formulation);
    State s = made.scene.initial, other;
    const std::size_t ball = made.layout().hinge("gimbal")->position, base = made.layout().hinge("float")->position;
    const double q[] = {0.5, -0.1, 0.7, 0.5};
    for (std::size_t i = 0; i < 4; ++i) {
      s.y[ball + i] = q[i] / std::sqrt(1.0);
      s.y[base + i] = q[3 - i] / std::sqrt(1.0);
    }
    made.equations->normalize(s.y);
    other = s;
    for (std::size_t i = 0; i < 4; ++i) {
      other.y[ball + i] = -other.y[ball + i];
      other.y[base + i] = -other.y[base + i];
    }
    const bool same = made.accelerations(s) == made.accelerations(other);
    campaign.row(formulation + ", accelerations at q and −q", "one rotation", "bitwise",
                 same ? "bitwise" : fmt::format("{:.2g}", difference(made.accelerations(other), made.accelerations(s))),
                 same);
  }
  const std::string top =
      "format: withy/1\ntime: {end: 1}\nbodies: {top: {type: rigid, mass: 1, inertia: [1, 2, 2.5, 0, 0, 0]}}\nhinges: "
      "{ball: "
      "{type: spherical, parent: world, child: top}}\ninitial: {hinges: {ball: {rate: [1, 2, 3]}}}\n";
  const Made made(top);
  const std::size_t steps = campaign.quick() ? 200'000 : 1'000'000'000;
  const double h = 0.01;
  const auto stepper = integrator("{name: rk4, step: 0.01}")->start(*made.equations, made.scene.initial);
  double worst = 0;
  const double end = h * static_cast<double>(steps);
  std::size_t done = 0;
  const double began = cpu_seconds();
  for (; done < steps; ++done) {
    if (stepper->step(end).outcome != StepResult::Outcome::ok) break;
    const auto& y = stepper->state().y;
    worst = std::max(worst, std::abs(std::sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]) - 1));
    if ((done & 0xffff) == 0 && cpu_seconds() - began > 60) break;
  }
  campaign.row(fmt::format("a tumbling body, {:.3g} steps of rk4: ‖q‖ − 1", static_cast<double>(done)),
               "unit quaternions", "≤ 4·2⁻⁵²", fmt::format("{:.2g}", worst), worst <= 4 * 0x1p-52);
  // No hinge of the project has coordinates that can be singular but the universal one whose axes are parallel.
  std::string why = "accepted";
  try {
    const Made parallel(
        "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\nhinges: "
        "{u: {type: universal, parent: world, child: "
        "b, first_axis: [1, 2, 3], second_axis: [2, 4, 6]}}\n");
  } catch (const SceneError& e) {
    why = e.what();
  }
  campaign.row("a universal hinge whose axes are parallel", "rank of H", "refused with its place", why.substr(0, 80),
               why.find("second_axis") != std::string::npos);
  // Axes that become parallel on the way: at 90° a gimbal of two universal hinges in a row loses a rate.
  const std::string gimbal =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  ring: {type: rigid, mass: 0}\n  rotor: {type: rigid, mass: 1, "
      "inertia: [1, 2, 2.5, 0, 0, 0]}\n"
      "hinges:\n  a: {type: universal, first_axis: [0, 0, 1], second_axis: [0, 1, 0], parent: world, child: ring}\n"
      "  b: {type: revolute, axis: [1, 0, 0], parent: ring, child: rotor}\n"
      "initial: {hinges: {a: {position: [0.3, ANGLE], rate: [0.1, 1]}, b: {rate: [0.2]}}}\n";
  const auto at = [&](const std::string& angle) {
    std::string text = gimbal;
    text.replace(text.find("ANGLE"), 5, angle);
    return text;
  };
  const Made locked(at("1.5707963267948966"));
  const std::string refused = unattainable(locked.model(), *locked.equations, locked.scene.initial, 1e-6);
  campaign.row("yaw, pitch and roll by three hinges, a run from 90° of pitch", "det M = 0", "refused, typed",
               refused.empty() ? "accepted" : refused.substr(0, 60), !refused.empty());
  const Made towards(at("0.9"));
  RunOptions options;
  options.end = 1;
  options.most_seconds = 20;
  const RunSummary t =
      simulate(towards.model(), *towards.equations, *towards.scene.integrator, towards.scene.initial, options, {});
  const bool finite = std::all_of(t.final.y.begin(), t.final.y.end(), [](double y) { return std::isfinite(y); });
  campaign.row(
      "the same driven past 90° of pitch", "energy, free motion", "drift ≤ 1e-4, or ends typed",
      fmt::format("{}, drift {:.1g}", name(t.status), t.energy_drift),
      finite && (t.status == RunStatus::completed ? t.energy_drift <= 1e-4 : t.status != RunStatus::interrupted));
}

}  // namespace withy::extremes
