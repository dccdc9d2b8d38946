// Mutated scenes are either scenes or reported: never a crash, a hang or another exception.
#include <cmath>
#include <random>
#include <regex>

#include "scene_fixture.hpp"

namespace withy::test {
namespace {

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string mutate(std::string text) {
    for (std::size_t count = 1 + below(4); count > 0 && !text.empty(); --count) {
      const std::size_t at = below(text.size());
      const std::size_t length = std::min(1 + below(12), text.size() - at);
      switch (below(6)) {
        case 0:
          text[at] = static_cast<char>(text[at] ^ static_cast<char>(1u << below(8)));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(below(text.size()), text.substr(at, length));
          break;
        case 3:
          text.insert(at, tokens[below(std::size(tokens))]);
          break;
        case 4:
          std::swap(text[at], text[below(text.size())]);
          break;
        default:
          text.resize(at);
      }
    }
    return text;
  }

 private:
  static constexpr const char* tokens[] = {"[",
                                           "]",
                                           "{",
                                           "}",
                                           ": ",
                                           "- ",
                                           "&a ",
                                           "*a",
                                           "!",
                                           "\"",
                                           "'",
                                           "\n",
                                           "\t",
                                           "#",
                                           "?",
                                           "|",
                                           ">",
                                           "%",
                                           "@",
                                           "`",
                                           ".nan",
                                           "-1",
                                           "1e999",
                                           "0",
                                           "~",
                                           "null",
                                           "world",
                                           "...",
                                           "---\n",
                                           "<<: ",
                                           "\xEF\xBB\xBF",
                                           "\xC3\xA9",
                                           "180 deg",
                                           "\\"};
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
  std::mt19937_64 random_;
};

class Fuzz : public SceneTest {};

TEST_F(Fuzz, MutatedScenesAreScenesOrReported) {
  const std::string scenes[] = {good_scene, file_text("scenes/two-link-slew.yaml"), file_text("scenes/pendulum.yaml"),
                                file_text("scenes/spacecraft.yaml"), file_text("scenes/driven-arm.yaml")};
  const std::regex many_modes("modes:[ \\n]*[0-9.e+]{2,}");
  Mutator mutator(20240601);
  int good = 0;
  int bad = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = mutator.mutate(scenes[static_cast<std::size_t>(i) % std::size(scenes)]);
    // With a digit more, a count of modes is a good scene that takes seconds to build.
    if (std::regex_search(text, many_modes)) continue;
    try {
      const Scene scene = parse_scene(text, "fuzz.yaml", registry);
      ASSERT_NE(scene.model, nullptr);
      ASSERT_NE(scene.formulation, nullptr);
      ASSERT_NE(scene.integrator, nullptr);
      ++good;
    } catch (const SceneError& e) {
      ASSERT_FALSE(e.problems().empty());
      for (const Diagnostic& d : e.problems()) {
        ASSERT_GT(d.place.line, 0) << d.message << "\n" << text;
        ASSERT_FALSE(d.message.empty());
      }
      ++bad;
    }
  }
  RecordProperty("good", good);
  RecordProperty("bad", bad);
  // Comments and names make up much of the files: a part of the mutations does no harm.
  EXPECT_GT(good, 200);
  EXPECT_GT(bad, 2000);
}

TEST_F(Fuzz, MutatedStatesAreStatesOrReported) {
  const Scene scene = parse_scene(file_text("scenes/spacecraft.yaml"), "s", registry);
  const std::string json = write_state(*scene.model, scene.initial);
  Mutator mutator(11);
  for (int i = 0; i < 5000; ++i) {
    const std::string text = mutator.mutate(json);
    try {
      const State state = parse_state(text, "fuzz.json", *scene.model, scene.initial);
      for (const double y : state.y) ASSERT_TRUE(std::isfinite(y)) << text;
    } catch (const SceneError& e) {
      ASSERT_FALSE(e.problems().empty());
    }
  }
}

TEST_F(Fuzz, MutatedOverridesAreTakenOrReported) {
  const char* overrides[] = {"time.end=2.5", "bodies.hub.frames.out.position=[0, 1, 2]",
                             "integrator={name: rk4, step: 1e-3}", "initial.hinges.shoulder.position=[30 deg]",
                             "gravity.1=-9.81 m/s^2"};
  Mutator mutator(5);
  for (int i = 0; i < 2000; ++i) {
    const SceneOptions options{"", "", {mutator.mutate(overrides[static_cast<std::size_t>(i) % std::size(overrides)])}};
    try {
      parse_scene(good_scene, "s.yaml", registry, options);
    } catch (const SceneError& e) {
      ASSERT_FALSE(e.problems().empty());
    }
  }
}

}  // namespace
}  // namespace withy::test
