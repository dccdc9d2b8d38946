#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/tests/cli/json_result.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Eval, GivesOneObjectWithConsistentShapes) {
  const Folder folder;
  folder.write("state.json", R"({"hinges": {"shoulder": {"position": [0.1], "rate": [0.3]}},
                                 "bodies": {"link1": {"modes": [0.01, 0.001], "rates": [0, 0]}}})");
  const json j = result(folder, {"eval", "scenes/two-link-slew.yaml", "--state", "state.json"});
  EXPECT_EQ(j.at("coordinates"), json({"shoulder.0", "link1.bending_y[1]", "link1.bending_y[2]", "elbow.0",
                                       "link2.bending_y[1]", "link2.bending_y[2]"}));
  ASSERT_EQ(j.at("mass_matrix").size(), 6U);
  for (const json& row : j.at("mass_matrix")) EXPECT_EQ(row.size(), 6U);
  for (const char* key : {"force", "applied", "accelerations"}) EXPECT_EQ(j.at(key).size(), 6U) << key;
  for (const char* key : {"linear_momentum", "angular_momentum"}) EXPECT_EQ(j.at(key).size(), 3U) << key;
  EXPECT_GT(j.at("kinetic_energy"), 0.0) << "the shoulder turns";
  EXPECT_GT(j.at("potential_energy"), 0.0) << "link1 is bent";
  EXPECT_GT(j.at("condition"), 1.0);
  // Rows of M a = f + applied: what eval prints belongs together. The residual is measured against the terms summed;
  // 1e-9 leaves room for a condition of M of about 1e6.
  for (std::size_t i = 0; i < 6; ++i) {
    double sum = -j["force"][i].get<double>() - j["applied"][i].get<double>();
    double size = std::abs(sum);
    for (std::size_t k = 0; k < 6; ++k) {
      const double term = j["mass_matrix"][i][k].get<double>() * j["accelerations"][k].get<double>();
      sum += term;
      size += std::abs(term);
    }
    EXPECT_LE(std::abs(sum), 1e-9 * size) << i;
  }
}

// 2 kg, 0.5 m beside the hinge.
TEST(Eval, TellsWhatLocksCarry) {
  const Folder folder;
  folder.write("s.yaml", R"(format: withy/1
time: {end: 2}
gravity: [0, -9.81, 0]
bodies: {a: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}}
events: {let_go: {at: 1, do: {unlock: h}}}
initial: {locked: [h]}
)");
  folder.write("free.json", R"({"locked": []})");
  const json locked = result(folder, {"eval", "s.yaml"}),
             free = result(folder, {"eval", "s.yaml", "--state", "free.json"});
  ASSERT_EQ(locked.at("motion_efforts").size(), 1U);
  EXPECT_NEAR(locked.at("motion_efforts")[0].get<double>(), 9.81, 1e-12);
  EXPECT_FALSE(free.contains("motion_efforts"));
}

// 0.2 + 1 s · 0.3/s is beyond `on`: a run begins with the jets on.
TEST(Eval, HasRelaysStandAsWhereARunBegins) {
  const Folder folder;
  folder.write("s.yaml", R"(format: withy/1
time: {end: 1}
bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}}
loads: {jets: {type: hinge-relay, hinge: h, effort: 2, on: 0.4, off: 0.1, rate_time: 1}}
initial: {hinges: {h: {position: 0.2, rate: 0.3}}}
)");
  const auto applied = [&](const char* held) {
    folder.write("state.json", held);
    return result(folder, {"eval", "s.yaml", "--state", "state.json"}).at("applied");
  };
  EXPECT_EQ(applied("{}"), json({-2.0}));
  EXPECT_EQ(applied(R"({"hinges": {"h": {"rate": [0.1]}}})"), json({0.0}));
  EXPECT_EQ(applied(R"({"held": {"jets": [0]}})"), json({0.0})) << "what a state says they hold, they hold";
}

TEST(Eval, ABadStateIsLocatedBadInput) {
  const Folder folder;
  folder.write("state.json", R"({"hinges": {"sholder": {"position": [0.1]}}})");
  const Finished f = withy(folder, {"eval", "scenes/two-link-slew.yaml", "--state", "state.json"});
  EXPECT_EQ(f.status, 2);
  EXPECT_EQ(f.out, "");
  EXPECT_THAT(f.err, HasSubstr("state.json:1:"));
  EXPECT_THAT(f.err, HasSubstr("shoulder")) << "the nearest known name";
}

TEST(Bench, CountsNoAllocationsInAnyFormulation) {
  const Folder folder;
  const json all = result(folder, {"bench", "scenes/two-link-slew.yaml", "--formulation", "all"});
  std::vector<std::string> names;
  for (const json& j : all) {
    names.push_back(j.at("formulation"));
    EXPECT_EQ(j.at("allocations_per_evaluation"), 0.0) << names.back();
    EXPECT_GT(j.at("ns_per_evaluation"), 0.0);
    EXPECT_GT(j.at("evaluations"), 0);
    EXPECT_EQ(j.at("bodies"), 5);
    EXPECT_EQ(j.at("coordinates"), 6);
  }
  for (const char* name : {"ruthless", "inconsistent", "consistent", "quadratic"})
    EXPECT_THAT(names, testing::Contains(name));
}

TEST(Bench, OneFormulationIsOneObject) {
  const Folder folder;
  EXPECT_EQ(result(folder, {"bench", "scenes/pendulum.yaml"}).at("formulation"), "quadratic");
}

TEST(Bench, SaysOfThreadsFromWhichSizeTheyPayOrWhyThereIsOne) {
  const Folder folder;
  std::string bodies =
                  "  hub: {type: rigid, mass: 4, inertia: [1, 2, 3, 0, 0, 0], frames: {a: {position: [-1, 0, 0]}, b: "
                  "{position: [1, 0, 0]}}}\n",
              hinges = "  base: {type: free, parent: world, child: hub}\n";
  for (const std::string arm : {"a", "b"}) {
    for (int i = 0; i < 9; ++i) {
      const std::string name = arm + std::to_string(i);
      bodies += "  " + name + ": {type: beam, length: 0.5, mass_per_length: 1, bending_y: {stiffness: 90}}\n";
      hinges += "  h" + name + ": {type: revolute, axis: [0, 0, 1], child: " + name +
                ", parent: " + (i == 0 ? "hub." + arm : arm + std::to_string(i - 1) + ".tip") + "}\n";
    }
  }
  folder.write("arms.yaml", "format: withy/1\ntime: {end: 0.02}\nbodies:\n" + bodies + "hinges:\n" + hinges +
                                "loads:\n  push: {type: hinge-effort, hinge: ha0, value: 0.1}\n");
  const json j = result(folder, {"bench", "arms.yaml", "--threads", "2"}).at("threads");
  EXPECT_EQ(j.at("count"), 2);
  EXPECT_GT(j.at("ns_all_threads"), 0.0);
  EXPECT_GT(j.at("ns_hand_over"), 0.0);
  EXPECT_LT(j.at("longest_share"), 0.6);
  EXPECT_GE(j.at("pays_from_bodies"), 1);
  EXPECT_EQ(result(folder, {"bench", "scenes/pendulum.yaml", "--threads", "2"}).at("threads").at("one_thread_because"),
            "its tree has no two branches of some size");
  // A run on threads is the run.
  ASSERT_EQ(withy(folder, {"run", "arms.yaml", "--no-hdf5", "--out", "one"}).status, 0);
  ASSERT_EQ(withy(folder, {"run", "arms.yaml", "--no-hdf5", "--out", "two", "--threads", "2"}).status, 0);
  EXPECT_EQ(folder.read("two/results.csv"), folder.read("one/results.csv"));
  const Finished alone = withy(folder, {"run", "scenes/pendulum.yaml", "--threads", "2", "--out", "pendulum"});
  EXPECT_EQ(alone.status, 0);
  EXPECT_THAT(alone.err, HasSubstr("--threads: one evaluates all: its tree has no two branches of some size"));
}

TEST(Inspect, TextShowsTheTreeAndJsonTheSame) {
  const Folder folder;
  const json j = result(folder, {"inspect", "scenes/two-link-slew.yaml", "--json"});
  EXPECT_EQ(j.at("bodies").size(), 5U);
  EXPECT_EQ(j.at("coordinates").size(), 6U);
  EXPECT_EQ(j.at("mass_matrix").at("determinant_sign"), 1);
  const Finished text = withy(folder, {"inspect", "scenes/two-link-slew.yaml"});
  for (const json& body : j.at("bodies")) EXPECT_THAT(text.out, HasSubstr("─ " + body.at("name").get<std::string>()));
  for (const json& plugin : j.at("plugins")) EXPECT_THAT(text.out, HasSubstr(plugin.at("name").get<std::string>()));
  EXPECT_EQ(j.at("families").at(0).at("body"), "link1");
  EXPECT_EQ(j.at("families").at(0).at("modes"), 2);
  EXPECT_THAT(text.out, HasSubstr("link1: 2 bending_y clamped-free; link2: 2 bending_y clamped-free"));
  // The state's limits, as a run that ends where it begins has them.
  ASSERT_EQ(withy(folder, {"run", "scenes/two-link-slew.yaml", "--set", "time.end=0", "--out", "still"}).status, 0);
  const json still = json::parse(folder.read("still/run.json")).at("certificate").at("indicators");
  EXPECT_EQ(j.at("indicators"), still);
  EXPECT_THAT(text.out, HasSubstr("tip deflection of 'link1' over its length: 0, limit 0.1"));
  EXPECT_THAT(withy(folder, {"inspect", "scenes/spinning-boom.yaml"}).out,
              HasSubstr("motion spin: spin-up of hinge axle"));
}

TEST(Inspect, OnlyPluginsTheSceneNamesAreLoaded) {
  const Folder folder;
  std::vector<std::string> loaded;
  const json j = result(folder, {"inspect", "scenes/pendulum.yaml", "--json"});
  for (const json& plugin : j.at("plugins")) loaded.push_back(plugin.at("name"));
  EXPECT_THAT(loaded, testing::Contains("body/rigid"));
  EXPECT_THAT(loaded, testing::Not(testing::Contains("mode-family/clamped-free")));
}

TEST(Plugins, EachIsDescribedWithFileVersionAndOptions) {
  const Folder folder;
  const json all = result(folder, {"plugins", "--json"});
  std::vector<std::string> names;
  for (const json& p : all) {
    names.push_back(p.at("kind").get<std::string>() + '/' + p.at("id").get<std::string>());
    EXPECT_EQ(p.at("state"), "loaded") << p;
    EXPECT_TRUE(std::filesystem::exists(p.at("file").get<std::string>()));
    EXPECT_NE(p.at("version"), "");
    EXPECT_NE(p.at("summary"), "");
    EXPECT_TRUE(p.at("options").is_array());
  }
  for (const char* name : {"body/beam", "body/rigid", "hinge/revolute", "mode-family/clamped-free",
                           "formulation/quadratic", "integrator/dopri5", "load/rigid-inverse-dynamics"}) {
    EXPECT_THAT(names, testing::Contains(name));
  }
  const Finished one = withy(folder, {"plugins", "beam"});
  EXPECT_EQ(one.status, 0);
  EXPECT_THAT(one.out, HasSubstr("length"));
}

TEST(Schema, IsJsonThatKnowsThePlugins) {
  const Folder folder;
  const json j = result(folder, {"schema"});
  EXPECT_EQ(j.at("$schema"), "https://json-schema.org/draft/2020-12/schema");
  EXPECT_THAT(j.dump(), HasSubstr("\"beam\""));
}

}  // namespace
}  // namespace withy::test
