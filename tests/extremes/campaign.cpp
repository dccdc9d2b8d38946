#include "campaign.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace withy::extremes {

void Campaign::row(const std::string& what, const std::string& oracle, const std::string& gate,
                   const std::string& measured, bool met) {
  rows_.push_back({extreme_ + ": " + what, oracle, gate, measured, met});
  const Row& r = rows_.back();
  fmt::print("{:<6} {} | {} | gate {} | {}\n", r.met ? "met" : "MISSED", r.extreme, r.oracle, r.gate, r.measured);
  std::fflush(stdout);
}

void Campaign::at_most(const std::string& what, const std::string& oracle, double measured, double gate) {
  row(what, oracle, fmt::format("≤ {:.3g}", gate), fmt::format("{:.3g}", measured), measured <= gate);
}

void Campaign::holds(const std::string& what, const std::string& oracle, const std::string& gate,
                     const std::string& why) {
  row(what, oracle, gate, why.empty() ? "holds" : why, why.empty());
}

std::vector<double> Made::rates(const State& state) const {
  std::vector<double> y_dot(equations->size());
  Work work = equations->make_work();
  work.poison();
  if (!equations->derivatives(state.time, state.y, y_dot, work).ok())
    std::fill(y_dot.begin(), y_dot.end(), std::numeric_limits<double>::quiet_NaN());
  return y_dot;
}

std::vector<double> Made::accelerations(const State& state) const {
  const std::vector<double> y_dot = rates(state);
  const auto first = y_dot.begin() + static_cast<std::ptrdiff_t>(layout().positions);
  return {first, first + static_cast<std::ptrdiff_t>(layout().speeds)};
}

std::shared_ptr<const Integrator> integrator(const std::string& options) {
  Registry registry;
  enroll_static_plugins(registry);
  return parse_scene("format: withy/1\ntime: {end: 1}\nintegrator: " + options +
                         "\nbodies: {b: {type: rigid, mass: 1}}\n"
                         "hinges: {h: {type: weld, parent: world, child: b}}\n",
                     "text", registry)
      .integrator;
}

std::string equal_steps(const std::string& id, double step) {
  const auto has_step = [&] {
    Registry registry;
    enroll_static_plugins(registry);
    const auto& parameters = registry.find<Integrator>(id)->parameters;
    return std::any_of(parameters.begin(), parameters.end(), [](const ParameterSpec& p) { return p.key == "step"; });
  };
  if (has_step()) return fmt::format("{{name: {}, step: {:.17g}}}", id, step);
  // What an iteration may leave is a part of the tolerance, which is none here.
  return fmt::format("{{name: {}, rtol: 1, atol: 1e200, initial_step: {:.17g}, max_step: {:.17g}{}}}", id, step, step,
                     id == "radau" ? ", iteration_error: 1e-214" : "");
}

std::string with_tolerance(const std::string& id, double tolerance) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto& parameters = registry.find<Integrator>(id)->parameters;
  if (std::none_of(parameters.begin(), parameters.end(), [](const ParameterSpec& p) { return p.key == "rtol"; }))
    return "";
  return fmt::format("{{name: {}, rtol: {:.17g}, atol: {:.17g}}}", id, tolerance, tolerance);
}

const std::string pendulum =
    "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {end: 1}\nbodies:\n  arm: {type: beam, length: 1, "
    "mass_per_length: 1, bending_y: {stiffness: 20, modes: 2}}\n  bob: {type: rigid, mass: 1, inertia: [0.01, 0.01, "
    "0.01, 0, 0, 0]}\nhinges:\n  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}\n  tip: {type: "
    "weld, parent: arm.tip, child: bob}\ninitial: {hinges: {pivot: {position: [-1], rate: [0.5]}}, bodies: {arm: "
    "{modes: [0.01, 0]}}}\n";

const std::string vibration =
    "format: withy/1\ntime: {end: 1}\nbodies: {beam: {type: beam, length: 1, mass_per_length: 1, bending_y: "
    "{stiffness: 1, modes: 1}}}\nhinges: {wall: {type: weld, parent: world, child: beam}}\n"
    "initial: {bodies: {beam: {modes: [0.01]}}}\n";

double energy(const Made& made, const State& s) {
  const Energies e = made.equations->energies(s.y);
  return e.kinetic + e.potential;
}

double energy_growth(const Made& made, const Integrator& method, double h, std::size_t steps) {
  const auto stepper = method.start(*made.equations, made.scene.initial);
  const double before = energy(made, stepper->state());
  const double end = h * static_cast<double>(steps);
  for (std::size_t i = 0; i < steps; ++i)
    if (stepper->step(end).outcome != StepResult::Outcome::ok) return std::numeric_limits<double>::infinity();
  return std::log(energy(made, stepper->state()) / before);
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string scene_text(const std::string& name) { return text_of(std::string(WITHY_SCENES) + "/" + name + ".yaml"); }

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double d = std::abs(a[i] - b[i]);
    if (!(d <= most)) most = d;  // keeps NaN
    size = std::max(size, std::abs(b[i]));
  }
  return size > 0 ? most / size : most;
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace withy::extremes
