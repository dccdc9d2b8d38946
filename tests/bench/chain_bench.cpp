/// \file
/// Chains: rigid ones beside the order-n recursions of Simbody, RBDL and Pinocchio (in the same run, where they are
/// installed), beams in each formulation, growth with the number of links, cost against the number of modes, and the
/// price of an empty call. Before anything is timed, ours and the rival's accelerations must agree.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "evaluation.hpp"
#include "ratios.hpp"
#include "rival_chains.hpp"

namespace {

using withy::bench::Joint;
/// Those that the build has found.
struct Rival {
  const char* name;
  std::unique_ptr<withy::bench::RivalChain> (*make)(const std::vector<Joint>&);
  double most;       ///< of our time over theirs
  int links = 1000;  ///< that it is asked for at most
};
const std::vector<Rival> rivals = {
#ifdef WITHY_BENCH_SIMBODY
    {"Simbody", withy::bench::simbody_chain, 0.18},
#endif
#ifdef WITHY_BENCH_RBDL
    {"RBDL", withy::bench::rbdl_chain, 0},
#endif
#ifdef WITHY_BENCH_PINOCCHIO
    // Its data has four tensors of n³ numbers, 32 GB for 1,000 links.
    {"Pinocchio", withy::bench::pinocchio_chain, 0, 100},
#endif
};

using withy::bench::Evaluation;

/// The same numbers for us and for the rival.
std::vector<Joint> joints(int n) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Joint> chain(static_cast<std::size_t>(n));
  for (Joint& j : chain) {
    double norm = 0;
    for (double& a : j.axis) {
      a = normal(random);
      norm += a * a;
    }
    for (double& a : j.axis) a /= std::sqrt(norm);
    j.at[0] = 0.4 + 0.1 * uniform(random);
    j.at[1] = 0.1 * uniform(random);
    j.at[2] = 0.1 * uniform(random);
    j.angle = uniform(random);
    j.rate = 0.1 * uniform(random);
  }
  return chain;
}

void place(std::ostringstream& hinges, const Joint& j, int i, const std::string& parent) {
  hinges << "  h" << i << ": {type: revolute, axis: [" << j.axis[0] << ", " << j.axis[1] << ", " << j.axis[2]
         << "], parent: " << (i == 0 ? "world" : parent) << ", child: b" << i << "}\n";
}

std::string scene(const std::ostringstream& bodies, const std::ostringstream& hinges, const std::vector<Joint>& chain) {
  std::ostringstream s;
  s.precision(17);
  s << "format: withy/1\ntime: {end: 1.0}\nbodies:\n"
    << bodies.str() << "hinges:\n"
    << hinges.str() << "initial:\n  hinges:\n";
  for (std::size_t i = 0; i < chain.size(); ++i)
    s << "    h" << i << ": {position: [" << chain[i].angle << "], rate: [" << chain[i].rate << "]}\n";
  return s.str();
}

std::string rigid_chain(int n) {
  const std::vector<Joint> chain = joints(n);
  std::ostringstream bodies, hinges;
  bodies.precision(17);
  hinges.precision(17);
  for (int i = 0; i < n; ++i) {
    const Joint& next = chain[static_cast<std::size_t>(i + 1 < n ? i + 1 : i)];
    bodies << "  b" << i
           << ": {type: rigid, mass: 1.5, center_of_mass: [0.2, 0.01, 0.02], inertia: [0.02, 0.03, 0.035, "
           << "0.001, 0, 0.002], frames: {out: {position: [" << next.at[0] << ", " << next.at[1] << ", " << next.at[2]
           << "]}}}\n";
    place(hinges, chain[static_cast<std::size_t>(i)], i, "b" + std::to_string(i - 1) + ".out");
  }
  return scene(bodies, hinges, chain);
}

/// Beams with `modes` bending modes in each of two planes.
std::string beam_chain(int n, int modes) {
  const std::vector<Joint> chain = joints(n);
  std::ostringstream bodies, hinges;
  hinges.precision(17);
  for (int i = 0; i < n; ++i) {
    bodies << "  b" << i << ": {type: beam, length: 1, mass_per_length: 1.2, damping_ratio: 0.01, ";
    if (modes > 0)
      bodies << "bending_y: {stiffness: 5000, modes: " << modes << "}, bending_z: {stiffness: 4000, modes: " << modes
             << "}, ";
    bodies << "frames: {}}\n";
    place(hinges, chain[static_cast<std::size_t>(i)], i, "b" + std::to_string(i - 1) + ".tip");
  }
  return scene(bodies, hinges, chain);
}

void time_rival(benchmark::State& state, const Rival& rival, int n) {
  const auto chain = rival.make(joints(n));
  double s = 0;
  for (auto _ : state) {
    chain->evaluate(1e-12 * s);
    s = chain->acceleration(0);
  }
  benchmark::DoNotOptimize(s);
}

/// Conditioning grows with the fourth power of the number of links; 30 joints agree to 1e-9 of the largest element.
void agree(const Rival& rival, int n) {
  Evaluation ours(rigid_chain(n), "quadratic");
  withy::Work work = ours.equations->make_work();
  ours.equations->derivatives(0, ours.y, ours.y_dot, work);
  const auto chain = rival.make(joints(n));
  chain->evaluate(0);
  double difference = 0, size = 0;
  for (int i = 0; i < n; ++i) {
    const double a = ours.y_dot[ours.first_speed() + static_cast<std::size_t>(i)];
    difference = std::max(difference, std::abs(a - chain->acceleration(i)));
    size = std::max(size, std::abs(a));
  }
  std::printf("rigid chain of %d against %s: largest relative difference %.1e\n", n, rival.name, difference / size);
  if (!(difference < 1e-9 * size)) std::exit(1);
}

/// What a virtual call of this shape costs by itself.
struct Nothing final : withy::EquationsOfMotion {
  withy::Layout order;
  const withy::Layout& layout() const override { return order; }
  withy::Work make_work() const override { return withy::Work(0); }
  withy::Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                                withy::Work& /*work*/) const noexcept override {
    y_dot[0] = t + y[0];
    return {};
  }
  void load_efforts(double /*t*/, std::span<const double> /*y*/, int /*load*/, std::span<double> /*efforts*/,
                    withy::Work& /*work*/) const noexcept override {}
  withy::Evaluation motion_efforts(double /*t*/, std::span<const double> /*y*/, std::span<double> /*efforts*/,
                                   withy::Work& /*work*/) const noexcept override {
    return {};
  }
  void inverse_dynamics(std::span<const double> /*y*/, std::span<const double> /*u_dot*/, std::span<double> /*efforts*/,
                        withy::Work& /*work*/) const override {}
  void mass_times(std::span<const double> /*y*/, std::span<const double> /*a*/, std::span<double> /*product*/,
                  withy::Work& /*work*/) const override {}
  void normalize(std::span<double> /*y*/) const noexcept override {}
  withy::DenseSystem system(double /*t*/, std::span<const double> /*y*/) const override { return {}; }
  withy::Energies energies(std::span<const double> /*y*/) const override { return {}; }
  std::unique_ptr<withy::Observation> make_observation() const override { return nullptr; }
  withy::WorldPose frame_pose(std::span<const double> /*y*/, int /*body*/, int /*frame*/) const override { return {}; }
  std::array<double, 3> deflection(std::span<const double> /*y*/, int /*body*/, int /*frame*/) const override {
    return {};
  }
  std::vector<std::string> savings() const override { return {}; }
};

void empty_call(benchmark::State& state) {
  const std::unique_ptr<withy::EquationsOfMotion> nothing = std::make_unique<Nothing>();
  withy::Work work = nothing->make_work();
  std::vector<double> y(1), y_dot(1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(nothing->derivatives(0, y, y_dot, work));
    y[0] = 1e-12 * y_dot[0];
  }
}

void add(const std::string& name, const std::string& text, const std::string& formulation) {
  // Compiled when first asked for, once for all repetitions.
  auto evaluation = std::make_shared<std::optional<Evaluation>>();
  benchmark::RegisterBenchmark(name.c_str(), [text, formulation, evaluation](benchmark::State& state) {
    if (!*evaluation) evaluation->emplace(text, formulation);
    (*evaluation)->time(state);
  });
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<withy::bench::Ratio> ratios;
  std::vector<withy::bench::PerUnit> units;
  std::vector<withy::bench::Growth> growths;
  for (const int n : {2, 10, 30, 100, 1000, 10000}) {
    const std::string ours = "rigid chain " + std::to_string(n);
    add(ours, rigid_chain(n), "quadratic");
    units.push_back({ours, static_cast<double>(n), n == 2 ? 125.0 : (n <= 1000 && n >= 30 ? 150.0 : 0.0)});
    for (const Rival& rival : rivals) {
      if (n > rival.links) continue;
      if (n == 30) agree(rival, n);
      const std::string theirs = std::string(rival.name) + " " + std::to_string(n);
      benchmark::RegisterBenchmark(theirs.c_str(), time_rival, rival, n);
      units.push_back({theirs, static_cast<double>(n)});
      ratios.push_back({ours, theirs, rival.most});
    }
  }
  growths.push_back({"rigid chain 10", "rigid chain 10000", 1000, 1.05});
  growths.push_back({"rigid chain 10", "rigid chain 1000", 100});
  for (const Rival& rival : rivals) {
    const std::string name = std::string(rival.name) + " ";
    if (rival.links >= 1000) growths.push_back({name + "10", name + "1000", 100});
  }
  const std::pair<const char*, double> formulations[] = {{"ruthless", 600}, {"quadratic", 1200}, {"consistent", 0}};
  for (const auto& [formulation, most] : formulations) {
    const std::string name = std::string(formulation) + " beams ";
    for (const int n : {10, 30, 100, 1000, 10000}) {
      add(name + std::to_string(n), beam_chain(n, 2), formulation);
      units.push_back({name + std::to_string(n), static_cast<double>(n), n <= 1000 ? most : 0});
    }
    growths.push_back({name + "10", name + "10000", 1000, 1.05});
    for (const int modes : {0, 1, 2, 4, 8, 16}) {
      const std::string one = std::string(formulation) + " two beams of " + std::to_string(2 * modes) + " modes";
      add(one, beam_chain(2, modes), formulation);
      units.push_back({one, 2});
    }
  }
  benchmark::RegisterBenchmark("empty call", empty_call);
  units.push_back({"empty call", 1});

  withy::bench::initialize(argc, argv);
  withy::bench::Summary summary;
  benchmark::RunSpecifiedBenchmarks(&summary);
  std::printf("%-58s %12s %12s %10s\n", "medians of CPU time", "ns", "ns or links", "figure");
  summary.print(units);
  summary.print(ratios);
  summary.print(growths);
  return 0;
}
