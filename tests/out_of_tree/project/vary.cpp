// Varies a scene, runs the variations on four threads, and reads their results.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <thread>
#include <vector>
#include <withy/host/scene.hpp>

namespace host = withy::host;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const auto log = [](std::string_view remark) { std::fprintf(stderr, "%s\n", std::string(remark).c_str()); };
    const host::Library library({.plugins = {}, .log = log});  // folders of plugins of your own; threads share it
    const host::Scene slew = host::Scene::read(library, argv[1]);

    std::vector<host::Scene> scenes;
    for (const double speed : {0.5, 0.8, 1.0, 1.1, 1.2, 1.3}) {
      scenes.push_back(slew);
      scenes.back()
          .set("loads.slew.time_scale", speed)
          .set("bodies.link1.damping_ratio", "2 %")
          .formulation("ruthless");
      scenes.back().check();  // what is wrong is said here, all at once
    }
    std::vector<host::Result> results(scenes.size());
    std::atomic<std::size_t> next = 0;
    {
      std::vector<std::jthread> threads;
      for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
          for (std::size_t k = next++; k < scenes.size(); k = next++) results[k] = scenes[k].run();
        });
    }
    for (const host::Result& result : results) {  // a bad end is a status, with its reason in `message`
      const std::vector<double> tip = result.column("link1.tip.deflection_y");
      const auto farther = [](double a, double b) { return std::abs(a) < std::abs(b); };
      std::printf("%s: shoulder %.4f rad, link1 bent by up to %.5f m\n", result.status.c_str(),
                  result.column("shoulder").back(), std::abs(*std::max_element(tip.begin(), tip.end(), farther)));
    }
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
