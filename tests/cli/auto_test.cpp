#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Auto, TellsWhenWhyAndToWhatItWentOver) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/spin-up.yaml", "--formulation", "auto", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("ruthless from 0 to "));
  EXPECT_THAT(f.out, HasSubstr("left since at "));
  const json run = json::parse(folder.read("out/run.json"));
  EXPECT_EQ(run.at("formulation"), "auto");
  const json& list = run.at("certificate").at("stretches").at("list");
  ASSERT_GE(list.size(), 2U);
  EXPECT_EQ(list.at(0).at("formulation"), "ruthless");
  const json& why = list.at(0).at("escalated_because").at(0);
  EXPECT_GT(why.at("value"), why.at("limit"));
  for (const json& stretch : list) EXPECT_NE(stretch.at("formulation"), "inconsistent");
  // Every output once, whatever the formulation.
  EXPECT_EQ(lines(folder.read("out/results.csv")).size(), 1002U);
}

TEST(Auto, EventsAreFoundOnceWhicheverTheFormulation) {
  const Folder folder;
  folder.write("spin.yaml",
               "format: withy/1\ntime: {end: 1.5}\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 1, "
               "bending_y: {stiffness: 20, modes: 2}}\nhinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: "
               "world, child: beam}\nmotions:\n  spin: {type: spin-up, hinge: axle, rate: 8, duration: 1}\n"
               "events:\n  early: {hinge: axle, of: rate, value: 0.5}\n  late: {hinge: axle, value: 5}\n");
  const Finished f = withy(folder, {"run", "spin.yaml", "--formulation", "auto", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json run = json::parse(f.out);
  ASSERT_GE(run.at("certificate").at("stretches").at("list").size(), 2U);
  const json& events = run.at("events");
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events.at(0).at("name"), "early");
  EXPECT_EQ(events.at(1).at("name"), "late");
}

TEST(Auto, WhatDoesNotGoOverIsRefusedPlainly) {
  const Folder folder;
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--resume"}, {"--checkpoint", "5"}}) {
    std::vector<std::string> words = {"run", "scenes/spin-up.yaml", "--formulation", "auto", "--out", "out"};
    words.insert(words.end(), option.begin(), option.end());
    const Finished f = withy(folder, words);
    EXPECT_EQ(f.status, 2);
    EXPECT_THAT(f.err, HasSubstr(option.front() + ": a run of formulation 'auto' keeps no checkpoints"));
  }
  folder.write("sampled.yaml",
               "format: withy/1\ntime: {end: 1}\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 1, "
               "bending_y: {stiffness: 20, modes: 2}}\nhinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: "
               "world, child: beam}\nloads:\n  control: {type: pd-controller, law: constant, sample: 0.03, hinges: "
               "{axle: {to: 0.5, stiffness: 5, damping: 0.4}}}\n");
  const Finished f = withy(folder, {"run", "sampled.yaml", "--formulation", "auto"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("sampled.yaml: /formulation: got 'auto'"));
  EXPECT_THAT(f.err, HasSubstr("load 'control' has discrete states"));
}

TEST(Auto, IsForAWholeSceneAndNoModelOfATrade) {
  const Folder folder;
  Finished f = withy(folder, {"run", "scenes/spin-up.yaml", "--set", "bodies.blade.formulation=auto"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("name a formulation"));
  f = withy(folder, {"trade", "scenes/spin-up.yaml", "--formulations", "auto"});
  EXPECT_EQ(f.status, 2);
}

}  // namespace
}  // namespace withy::test
