// Studies a scene with the libraries below the façade, whose results are values: how sure a run is, what vibrates, and
// which models are worth their cost.
#include <cstdio>
#include <exception>
#include <string>
#include <withy/study/linear_model.hpp>
#include <withy/withy.hpp>

namespace study = withy::study;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    withy::Plugins plugins;
    withy::SceneValues values = withy::SceneValues::read(argv[1]);
    values.set("loads.slew.time_scale", withy::Value(1.2), "host").choose_formulation("ruthless", "host");
    const study::Prepared prepared = study::prepare(values, plugins.registry());

    const auto [summary, certificate] = study::run(prepared, plugins.registry());
    std::printf("%s at %.3f s\n", std::string(withy::name(summary.status)).c_str(), summary.final.time);
    for (const withy::Slot& hinge : prepared.model().layout().hinges)
      if (hinge.positions == 1)
        std::printf("%s %.4f deg\n", hinge.name.c_str(), summary.final.y[hinge.position] * 57.29577951308232);
    if (certificate.estimate)
      std::printf("error against %s: hinges %.4f deg, tips %.4f m\n", certificate.estimate->against.c_str(),
                  certificate.estimate->distances.greatest_hinge() * 57.29577951308232,
                  certificate.estimate->distances.greatest_tip());

    const study::Configuration at_start(prepared, prepared.scene.initial, {});
    for (const auto pole : withy::poles(study::linear_model(at_start, {}).system))
      if (pole.imag() > 0) std::printf("vibrates at %.2f rad/s\n", pole.imag());

    const study::Axes axes{{"ruthless", "linear", "quadratic"}, {""}, {1, 2}, {"dopri5"}, {1e-4}, {}};
    study::TradeStudy trade(prepared, plugins.registry(), study::points_of(axes), {});
    trade.run();  // on all cores
    const auto results = trade.results();
    const auto front = study::pareto_front(results);
    for (std::size_t i = 0; i < results.size(); ++i)
      if (front[i])
        std::printf("worth it: %s, off by %.3f %%\n", results[i].point.text().c_str(), 100 * results[i].relative_error);
    return summary.status == withy::RunStatus::completed ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
