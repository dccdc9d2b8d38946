/// \file
/// A block on a spring, the data that measurements of it give, and fits to them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "withy/campaign/random.hpp"
#include "withy/campaign/tune.hpp"
#include "withy/tests/results/scratch.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::test {

inline constexpr const char* block = R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
time: {end: 4, output: 0.02}
bodies:
  block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 50, damping: 0.8}   # as the maker says
initial: {hinges: {slide: {position: ["20 mm"], rate: [0.3]}}}
)";

/// What makes the data: m ẍ + c ẋ + k x = 0 in closed form.
struct Truth {
  double stiffness = 58, damping = 1.1, start = 0.025, rate = 0.3;
  double mass = 2;
  [[nodiscard]] double at(double t) const {
    const double decay = damping / (2 * mass), omega = std::sqrt(stiffness / mass - decay * decay);
    return std::exp(-decay * t) * (start * std::cos(omega * t) + (rate + decay * start) / omega * std::sin(omega * t));
  }
};

/// Normally distributed, by Box and Muller.
inline double noise(std::uint64_t seed, std::uint64_t i) {
  return std::sqrt(-2 * std::log(campaign::Key(seed)["a"][i].uniform())) *
         std::cos(2 * std::numbers::pi * campaign::Key(seed)["b"][i].uniform());
}

struct TuneFolder : Scratch {
  /// 160 rows at times that are no outputs of the scene; every seventh place was not measured.
  void measure(const Truth& truth, double deviation, std::uint64_t seed) const {
    std::string text = "t[ms],operator,slide[mm]\n";
    for (std::uint64_t i = 0; i < 160; ++i) {
      const double t = 0.0249 * static_cast<double>(i);
      const double x = truth.at(t) + deviation * noise(seed, i);
      text += i % 7 == 3 ? fmt::format("{},Ann,\n", 1e3 * t) : fmt::format("{},Ann,{}\n", 1e3 * t, 1e3 * x);
    }
    write("data.csv", text);
  }
  [[nodiscard]] study::Prepared prepared(const std::string& text = block) const {
    return study::prepare(SceneValues::parse(text, "block.yaml"), plugins());
  }
  [[nodiscard]] campaign::TuneResult tuned(campaign::TuneQuestion question, const std::string& text = block) const {
    question.data = (*this / "data.csv").string();
    return tune(prepared(text), plugins(), question);
  }
  [[nodiscard]] campaign::TuneResult tuned(const std::vector<std::string>& parameters) const {
    campaign::TuneQuestion question;
    question.parameters = parameters;
    return tuned(question);
  }
};

inline const std::vector<std::string> three = {"loads.spring.stiffness", "loads.spring.damping",
                                               "initial.hinges.slide.position.0"};
}  // namespace withy::test
