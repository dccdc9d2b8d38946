// A program of its own that closes a loop: it holds the shoulder of an arm at an angle, a hundred times a second.
#include <cstdio>
#include <exception>
#include <withy/host/simulation.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const withy::host::Library library;
    withy::host::Simulation arm(withy::host::Scene::read(library, argv[1]));
    const std::size_t command = arm.input_index("command");
    const std::size_t angle = arm.output_index("shoulder"), rate = arm.output_index("shoulder.rate");
    for (int k = 1; k <= 600; ++k) {
      arm.set_input(command, 6 * (0.5 - arm.output(angle)) - 2 * arm.output(rate));
      arm.step(0.01 * k);
    }
    std::printf("shoulder at %.3f rad, tip deflected by %.5f m\n", arm.output(angle),
                arm.output("link1.tip.deflection_y"));
    return 0;
  } catch (const withy::host::SimulationStopped& e) {
    std::fprintf(stderr, "stopped at %.3f s: %s\n", e.time(), e.what());
    return 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
