/// \file
/// Scenes that remember what the ones before had in common, against scenes made by themselves.
#include "withy/scene/scene_parts.hpp"

#include <bit>
#include <filesystem>
#include <functional>
#include <random>

#include "scene_fixture.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/moving_state.hpp"
#include "withy/scene/same_content.hpp"

namespace withy::test {
namespace {

/// Everything that can be seen of a scene, or of why there is none.
struct Seen {
  std::string problem, sources;
  Value source;
  std::vector<std::uint64_t> bits;  ///< its initial state, and rates of a state in motion
};

Seen seen(const std::function<Scene()>& make) {
  Seen all;
  try {
    const Scene scene = make();
    all.source = scene.source;
    for (const FileUsed& f : scene.sources.files) all.sources += f.path + " " + f.sha256 + "\n";
    for (const PluginUsed& p : scene.sources.plugins) all.sources += p.kind + " " + p.id + " " + p.file + "\n";
    const auto equations = scene.formulation->compile(scene.model);
    const State state = moving_state(*scene.model, scene.initial);
    std::vector<double> rates(equations->size());
    Work work = equations->make_work();
    if (!equations->derivatives(state.time, state.y, rates, work).ok()) rates.clear();
    for (const double x : scene.initial.y) all.bits.push_back(std::bit_cast<std::uint64_t>(x));
    for (const double x : rates) all.bits.push_back(std::bit_cast<std::uint64_t>(x));
  } catch (const std::exception& e) {
    all.problem = e.what();
  }
  return all;
}

/// Where numbers stand in a scene.
void collect(const Value& value, const std::string& path, std::vector<std::string>& paths) {
  if (value.kind() == Value::Kind::number) paths.push_back(path);
  const auto below = [&](const std::string& key) { return path.empty() ? key : path + "." + key; };
  for (const auto& [key, member] : value.members()) collect(member, below(key), paths);
  for (std::size_t i = 0; i < value.items().size(); ++i) collect(value.items()[i], below(std::to_string(i)), paths);
}

class SceneParts : public SceneTest {
 protected:
  void expect_same(const SceneValues& values, withy::SceneParts& parts, const std::string& what) {
    const Seen alone = seen([&] { return make_scene(values, registry); });
    const Seen among = seen([&] { return make_scene(values, registry, parts); });
    EXPECT_EQ(among.problem, alone.problem) << what;
    EXPECT_EQ(among.sources, alone.sources) << what;
    EXPECT_TRUE(same_content(among.source, alone.source)) << what;
    EXPECT_EQ(among.bits, alone.bits) << what;
    problems += alone.problem.empty() ? 0 : 1;
  }
  int problems = 0;
};

TEST_F(SceneParts, ScenesAreThoseMadeByThemselvesWhateverNumberChanges) {
  std::mt19937 random(11);
  for (const auto& entry : std::filesystem::directory_iterator(WITHY_SOURCE_DIRECTORY "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    const SceneValues base = SceneValues::read(entry.path());
    std::vector<std::string> paths;
    collect(base.root(), "", paths);
    std::shuffle(paths.begin(), paths.end(), random);
    paths.resize(std::min<std::size_t>(paths.size(), 8));
    withy::SceneParts parts;
    expect_same(base, parts, entry.path());
    for (const std::string& path : paths) {
      for (const double factor : {1.01, -1.0}) {
        SceneValues changed = base;
        changed.set(path, Value(factor * base.find(path)->number()), "a change");
        expect_same(changed, parts, entry.path().string() + ": " + path + " times " + std::to_string(factor));
      }
    }
    expect_same(base, parts, entry.path().string() + " again");
  }
  EXPECT_GT(problems, 10) << "negative lengths and masses are refused, in the same words";
}

TEST_F(SceneParts, WhatRestsOnNamesIsCheckedAgainstTheNamesOfItsOwnScene) {
  const std::string text = replaced(good_scene, "out: {position: [0.0762, 0, 0]}",
                                    "out: {position: [0.0762, 0, 0]}\n      thrust: {position: [0, 0.1, 0]}") +
                           "  push: {type: force, frame: hub.thrust, value: [1, 0, 0]}\n";
  withy::SceneParts parts;
  expect_same(SceneValues::parse(text, "s.yaml"), parts, "with the frame");
  expect_same(SceneValues::parse(replaced(text, "thrust: {pos", "thruster: {pos"), "s.yaml"), parts, "without it");
  EXPECT_EQ(problems, 1);
  expect_same(SceneValues::parse(text, "s.yaml"), parts, "with it again");
  EXPECT_EQ(problems, 1);
}

TEST_F(SceneParts, StationsAreFramesOfTheScenesThatNameThem) {
  const std::string text = replaced(good_scene, "hinges:",
                                    "  panel: {type: plate, length: 1, width: 1, mass_per_area: 2, stiffness: 5}\n"
                                    "hinges:\n  edge: {type: weld, parent: hub.out, child: panel}") +
                           "  push: {type: force, frame: panel.left, value: [0, 0, 1]}\n";
  withy::SceneParts parts;
  expect_same(SceneValues::parse(text, "s.yaml"), parts, "at one corner");
  expect_same(SceneValues::parse(replaced(text, "panel.left", "panel.right"), "s.yaml"), parts, "at the other");
  expect_same(SceneValues::parse(text, "s.yaml"), parts, "at the first again");
  EXPECT_EQ(problems, 0);
}

TEST_F(SceneParts, WhatDoesNotChangeIsOneObject) {
  withy::SceneParts parts;
  const SceneValues base = SceneValues::parse(good_scene, "s.yaml");
  SceneValues stiffer = base;
  stiffer.set("bodies.boom.bending_y.stiffness", Value(120.0), "case 1");
  const Scene first = make_scene(base, registry, parts), second = make_scene(stiffer, registry, parts);
  const auto body = [](const Scene& scene, const char* name) {
    return scene.model->bodies()[static_cast<std::size_t>(scene.model->body(name))].body;
  };
  EXPECT_EQ(body(first, "hub"), body(second, "hub"));
  EXPECT_NE(body(first, "boom"), body(second, "boom"));
  EXPECT_EQ(first.integrator, second.integrator);
}

TEST_F(SceneParts, WhatStopsChangingAfterManyScenesIsOneObjectAgain) {
  withy::SceneParts parts;
  const SceneValues base = SceneValues::parse(good_scene, "s.yaml");
  const auto boom_of = [&](double stiffness) {
    SceneValues values = base;
    values.set("bodies.boom.bending_y.stiffness", Value(stiffness), "a case");
    const Scene scene = make_scene(values, registry, parts);
    return scene.model->bodies()[static_cast<std::size_t>(scene.model->body("boom"))].body;
  };
  for (int k = 0; k < 50; ++k) boom_of(100.0 + k);
  std::shared_ptr<const Body> last = boom_of(90);
  int made = 0;
  for (int k = 0; k < 100; ++k) {
    const std::shared_ptr<const Body> next = boom_of(90);
    made += next == last ? 0 : 1;
    last = next;
  }
  EXPECT_LT(made, 50);
  EXPECT_EQ(boom_of(90), last);
}

}  // namespace
}  // namespace withy::test
