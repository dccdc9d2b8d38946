/// \file
/// What an evaluation costs at limits, beside the same without: numbers without leading digits, beams without modes.
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "evaluation.hpp"
#include "ratios.hpp"

namespace {

using withy::bench::Evaluation;

std::string spacecraft() {
  std::ifstream file(SCENES "/spacecraft.yaml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Six beams of no modes, or rigid bodies with the mass that beams have: m = ρL, I = mL²/12 about the middle.
std::string six_links(bool beams) {
  const std::string rigid =
      "type: rigid, mass: 0.625, center_of_mass: [0.25, 0, 0], inertia: [0, 0.0130208333, 0.0130208333, 0, 0, 0], "
      "frames: {tip: {position: [0.5, 0, 0]}}";
  std::ostringstream bodies, hinges;
  for (int i = 0; i < 6; ++i) {
    bodies << "  b" << i << ": {" << (beams ? "type: beam, length: 0.5, mass_per_length: 1.25" : rigid) << "}\n";
    hinges << "  h" << i << ": {type: revolute, axis: [0, " << i << ", " << (i % 2 == 0 ? 1 : 2)
           << "], parent: " << (i == 0 ? std::string("world") : "b" + std::to_string(i - 1) + ".tip") << ", child: b"
           << i << "}\n";
  }
  return "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 1]\nbodies:\n" + bodies.str() + "hinges:\n" +
         hinges.str();
}

/// Every coordinate and rate `value` where it is zero or `all` asks for it; quaternions stay units.
std::shared_ptr<Evaluation> filled(const std::string& formulation, double value, bool all) {
  auto e = std::make_shared<Evaluation>(spacecraft(), formulation);
  const withy::Layout& layout = e->equations->layout();
  for (double& y : e->y) y = all || y == 0 ? value : y;
  for (const withy::Slot& slot : layout.hinges) {
    if (all && slot.positions != slot.speeds) e->y[slot.position] = 1;
  }
  e->equations->normalize(e->y);
  return e;
}

void add(const std::string& name, std::shared_ptr<Evaluation> evaluation) {
  benchmark::RegisterBenchmark(name.c_str(), [evaluation](benchmark::State& state) { evaluation->time(state); });
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<withy::bench::Ratio> ratios;
  for (const char* formulation : {"ruthless", "inconsistent", "consistent", "quadratic", "linear", "exact"}) {
    const std::string name = std::string("spacecraft ") + formulation;
    add(name, filled(formulation, 1e-3, false));
    add(name + " at 1e-310", filled(formulation, 1e-310, true));
    ratios.push_back({name + " at 1e-310", name, 1.2});
  }
  add("six beams of no modes", std::make_shared<Evaluation>(six_links(true), "quadratic"));
  add("six rigid bodies", std::make_shared<Evaluation>(six_links(false), "quadratic"));
  ratios.push_back({"six beams of no modes", "six rigid bodies", 1.02});
  withy::bench::initialize(argc, argv);
  withy::bench::Summary summary;
  benchmark::RunSpecifiedBenchmarks(&summary);
  std::printf("%-58s %12s %12s %10s\n", "medians of CPU time", "ns", "ns", "ratio");
  summary.print(ratios);
  return 0;
}
