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
