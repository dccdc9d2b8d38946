// A program of its own that simulates a scene: reads it, varies it, runs it, and says how sure the result is.
#include <cstdio>
#include <exception>
#include <string>
#include <withy/withy.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    withy::Plugins plugins;  // those of the package; folders of your own are its argument
    withy::SceneValues values = withy::SceneValues::read(argv[1]);
    values.set("loads.slew.time_scale", withy::Value(1.2), "host").choose_formulation("ruthless", "host");
    const auto prepared = withy::study::prepare(values, plugins.registry());
    const auto [summary, certificate] = withy::study::run(prepared, plugins.registry());

    std::printf("%s at %.3f s\n", std::string(withy::name(summary.status)).c_str(), summary.final.time);
    for (const withy::Slot& hinge : prepared.model().layout().hinges)
      if (hinge.positions == 1)
        std::printf("%s %.4f deg\n", hinge.name.c_str(), summary.final.y[hinge.position] * 57.29577951308232);
    if (certificate.estimate)
      std::printf("error against %s: hinges %.4f deg, tips %.4f m\n", certificate.estimate->against.c_str(),
                  certificate.estimate->distances.greatest_hinge() * 57.29577951308232,
                  certificate.estimate->distances.greatest_tip());
    return summary.status == withy::RunStatus::completed ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
