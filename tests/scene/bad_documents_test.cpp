// Documents as wholes: problems all at once and each once, what no scene can be, and how much is read before that is
// said.
#include <gmock/gmock.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "scene_fixture.hpp"

namespace withy::test {
namespace {

class BadDocuments : public SceneTest {};

TEST_F(BadDocuments, ProblemsAreReportedAllAtOnceInTheOrderOfTheFile) {
  std::string text = replaced(good_scene, "mass: 20.0", "mass: -20.0");
  text = replaced(text, "length: 0.9", "lenght: 0.9");
  text = replaced(text, "modes: 2", "modes: many");
  text = replaced(text, "parent: hub.out", "parent: hubb.out");
  text = replaced(text, "period: 5", "period: 5 kg");
  EXPECT_EQ(problems(text, registry),
            "s.yaml:7:11: /bodies/hub/mass: got -20; need finite >= 0 [kg]\n"
            "s.yaml:11:3: /bodies/boom/length: missing: length, undeformed; need finite > 0 [m]\n"
            "s.yaml:13:5: /bodies/boom/lenght: unknown key \"lenght\"; did you mean 'length'?\n"
            "s.yaml:15:40: /bodies/boom/bending_y/modes: got \"many\"; need whole number >= 0 and <= 1000\n"
            "s.yaml:19:30: /hinges/root/parent: no body \"hubb\"; did you mean 'hub'?\n"
            "s.yaml:21:82: /loads/motor/period: got \"5 kg\": 'kg' is a wrong unit here; need finite > 0 [s]");
}

/// Faults of names far apart, each said alone in the words in which all are said together.
TEST_F(BadDocuments, NamesAreLookedUpWhereNoModelCanBeMade) {
  const std::string base = std::string(good_scene) + R"(integrator: {name: dopri5, rtol: 1e-6}
outputs: {end: {type: frame, of: boom.tip}}
events:
  there: {hinge: shoulder, value: "30 deg", stop: true}
  first: {at: 0.2, do: {lock: shoulder}}
  then: {after: first, do: {unlock: shoulder}}
  last: {at: 0.5, do: {switch_off: motor}}
initial: {hinges: {shoulder: {rate: [0.1]}}}
)";
  ASSERT_EQ(problems(base, registry), "");
  std::string text = base;
  std::vector<std::string> alone;
  for (const auto& [good, bad] :
       std::vector<std::pair<std::string, std::string>>{{"parent: hub.out,", "parent: hub.outt,"},
                                                        {"rtol: 1e-6", "rtol: -1"},
                                                        {"of: boom.tip", "of: boom.tpp"},
                                                        {"{hinge: shoulder, value", "{hinge: sholder, value"},
                                                        {"lock: shoulder}", "lock: sholder}"},
                                                        {"after: first", "after: frst"},
                                                        {"switch_off: motor", "switch_off: motr"},
                                                        {"hinges: {shoulder: {rate", "hinges: {shouldr: {rate"}}) {
    alone.push_back(problems(replaced(base, good, bad), registry));
    text = replaced(text, good, bad);
  }
  const std::string all = problems(text, registry);
  for (const std::string& problem : alone) {
    EXPECT_EQ(std::count(problem.begin(), problem.end(), '\n'), 0) << problem;
    EXPECT_THAT(all, testing::HasSubstr(problem));
  }
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 7) << all;
}

TEST_F(BadDocuments, AFormulaThatACommaCutsIsToldSo) {
  EXPECT_THAT(
      problems(std::string(good_scene) + "outputs: {least: {type: expression, value: min(t, shoulder)}}\n", registry),
      testing::HasSubstr("/outputs/least/shoulder): unknown key \"shoulder)\"; a formula with a comma needs quotes"));
}

// How many parts a body comes in its plugin says, when it makes it.
TEST_F(BadDocuments, PartsOfABodyAreNoUnknownNamesWhereNoModelCanBeMade) {
  const std::string all = problems(replaced(good_scene, "law: sine", "law: sinus") +
                                       "\ninitial: {bodies: {boom.2: {modes: [0.1]}, bom.2: {modes: [0.1]}}}\n",
                                   registry);
  EXPECT_THAT(all, testing::Not(testing::HasSubstr("boom.2\"")));
  EXPECT_THAT(all, testing::HasSubstr("no body \"bom.2\""));
}

TEST_F(BadDocuments, WhatRestsOnAPartThatIsReportedIsNotReportedToo) {
  const std::string parts = R"(
constraints:
  loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: boom.tpi, b: world}
  other: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: boom.tip, b: world}
outputs:
  closing: {type: reaction, constraint: loop}
  place: {type: frame, of: boom.tpi}
  twice: {type: expression, value: "2 * place.x", unit: m}
  drive: {type: effort, hinge: shoulder, of: motor}
  other_closing: {type: reaction, constraint: otter}
)";
  // Each fault alone is reported, once; so is a name that nothing bears.
  EXPECT_EQ(
      problems(replaced(good_scene, "law: sine", "law: sinus") + parts, registry),
      "s.yaml:21:53: /loads/motor/law: got \"sinus\": did you mean 'sine'?; need one of: constant, sine, table, "
      "steps\n"
      "s.yaml:24:60: /constraints/loop/a: no frame \"boom.tpi\"; did you mean 'boom.tip'?; frames of the body name its "
      "other places\n"
      "s.yaml:28:28: /outputs/place/of: no frame \"boom.tpi\"; did you mean 'boom.tip'?; frames of the body name its "
      "other places\n"
      "s.yaml:31:3: /outputs/other_closing: there is no constraint 'otter'");
}

/// A plate that no hinge holds but at its root: its corners, a place on it, and a node of a finite-element model.
const std::string with_stations = R"(format: withy/1
time: {end: 1.0}
bodies:
  panel: {type: plate, length: 1.2, width: 0.7, mass_per_area: 2.7, stiffness: 5}
  roof: {type: modal, file: )" WITHY_SOURCE_DIRECTORY R"(/tests/reference/sid/cartopPragV32.SID_FEM}
hinges:
  a: {type: weld, parent: world, child: panel}
  b: {type: weld, parent: world, child: roof}
constraints:
  held: {type: hinge, hinge: spherical, a: world, b: panel.left, offset: {position: [1.2, 0.35, 0]}}
loads:
  push: {type: force, frame: panel.right, law: constant, value: [0, 0, 1]}
  cable: {type: spring-damper, frame: panel.tip, to: roof.12, stiffness: 1, free_length: 0.1}
outputs:
  corner: {type: frame, of: panel.left}
  place: {type: frame, of: 'panel.(0.6, -0.2)'}
  node: {type: frame, of: roof.12}
)";

TEST_F(BadDocuments, StationsAreFramesWhereverTheyAreNamed) {
  EXPECT_EQ(problems(with_stations, registry), "");
  const Scene scene = parse_scene(with_stations, "s.yaml", registry, {});
  for (const char* frame : {"panel.left", "panel.right", "panel.(0.6, -0.2)", "roof.12"}) {
    const std::optional<FrameIndex> at = scene.model->find_frame(frame);
    ASSERT_TRUE(at) << frame;
    EXPECT_EQ(
        scene.model->bodies()[static_cast<std::size_t>(at->body)].frames[static_cast<std::size_t>(at->frame)].name,
        std::string(frame).substr(std::string(frame).find('.') + 1));
  }
  EXPECT_FALSE(scene.model->find_frame("panel.(0.6, 0.2)")) << "nothing names it";
}

TEST_F(BadDocuments, AWrongStationIsReportedWithTheNearest) {
  EXPECT_EQ(
      problems(replaced(replaced(with_stations, "frame: panel.right", "frame: panel.rigt"), "of: panel.left",
                        "of: panel.lefft"),
               registry),
      "s.yaml:12:30: /loads/push/frame: no frame \"panel.rigt\"; did you mean 'panel.right'?; frames of the body "
      "name its other places\n"
      "s.yaml:15:29: /outputs/corner/of: no frame \"panel.lefft\"; did you mean 'panel.left'?; frames of the body "
      "name its other places");
  EXPECT_EQ(
      problems(replaced(with_stations, "parent: world, child: roof", "parent: panel.rigt, child: roof"), registry),
      "s.yaml:8:27: /hinges/b/parent: body 'panel' has no frame \"rigt\"; did you mean 'right'?; its frames name "
      "other places of it");
}

TEST_F(BadDocuments, TheErrorCarriesPlaceAndMessageForPrograms) {
  try {
    parse_scene(replaced(good_scene, "mass: 20.0", "mass: -20.0"), "s.yaml", registry);
    FAIL() << "no error";
  } catch (const SceneError& e) {
    ASSERT_EQ(e.problems().size(), 1u);
    EXPECT_EQ(e.problems()[0].place.line, 7);
    EXPECT_EQ(e.problems()[0].place.column, 11);
    EXPECT_EQ(e.problems()[0].place.path, "/bodies/hub/mass");
    EXPECT_EQ(e.problems()[0].message, "got -20; need finite >= 0 [kg]");
  }
}

TEST_F(BadDocuments, WithoutAnEndCanBeReadButNotRun) {
  const Scene scene = parse_scene(replaced(good_scene, "end: 1.0, ", ""), "s.yaml", registry);
  EXPECT_FALSE(scene.end.has_value());
  try {
    (void)end_of_run(scene);
    FAIL() << "no error";
  } catch (const SceneError& e) {
    EXPECT_STREQ(e.what(),
                 "s.yaml:3:7: /time/end: missing, and no load or motion has an end of its own; need finite >= 0 [s]");
  }
}

TEST_F(BadDocuments, WithoutContentAreRefused) {
  EXPECT_EQ(problems("", registry), "s.yaml:1:1: empty; nothing to read");
  EXPECT_EQ(problems("# only a comment\n", registry), "s.yaml:1:1: empty; nothing to read");
  EXPECT_THAT(problems("just text", registry), testing::StartsWith("s.yaml:1:1: got \"just text\"; need a map"));
  EXPECT_THAT(problems("[1, 2]", registry), testing::StartsWith("s.yaml:1:1: got a list of 2; need a map"));
  EXPECT_THAT(problems("bodies: {}\nhinges: {}\nformat: withy/1\n", registry),
              testing::HasSubstr("s.yaml:1:9: /bodies: got none; need at least one body"));
}

TEST_F(BadDocuments, OfAHundredMegabytesAreRefusedBeforeTheyAreParsed) {
  const std::string text(std::size_t{100} << 20, ' ');
  EXPECT_EQ(problems(text, registry), "s.yaml:1:1: more than 64 MiB; a scene is at most that large");
}

TEST_F(BadDocuments, DeepNestingIsRefused) {
  EXPECT_THAT(problems("gravity: " + std::string(50'000'000, '['), registry),
              testing::HasSubstr("nested deeper than 32 levels"));
  EXPECT_THAT(problems("gravity: " + std::string(400, '[') + std::string(400, ']'), registry),
              testing::HasSubstr("nested deeper than 32 levels"));
  std::string map;
  for (int i = 0; i < 1000; ++i) map += "{a: ";
  EXPECT_THAT(problems("gravity: " + map, registry), testing::HasSubstr("nested deeper than 32 levels"));
  std::string block = "gravity:\n";
  for (int i = 1; i < 1000; ++i) block += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_THAT(problems(block, registry), testing::HasSubstr("nested deeper than 32 levels"));
}

TEST_F(BadDocuments, TooManyValuesAreRefused) {
  std::string row = "gravity: [";
  std::string column = "gravity:\n";
  for (int i = 0; i <= 1'000'000; ++i) {
    row += "0,";
    column += "- 0\n";
  }
  EXPECT_THAT(problems(row + "0]", registry), testing::HasSubstr("more than 1000000 values"));
  EXPECT_THAT(problems(column, registry), testing::HasSubstr("more than 1000000 values"));
  // Never closed, so that a parser would look for the end first.
  std::string open = "gravity: [";
  for (int i = 0; i < 8'000'000; ++i) open += "0,";
  EXPECT_THAT(problems(open, registry), testing::HasSubstr("more than 1000000 values"));
}

TEST_F(BadDocuments, AnAbsentFileIsASystemErrorThatNamesIt) {
  try {
    read_scene("no/such/scene.yaml", registry);
    FAIL() << "no error";
  } catch (const std::system_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("no/such/scene.yaml"));
    EXPECT_EQ(e.code(), std::errc::no_such_file_or_directory);
  }
  EXPECT_THROW(read_scene(WITHY_SOURCE_DIRECTORY, registry), std::system_error);
}

TEST_F(BadDocuments, TheGoodSceneIsGood) { EXPECT_EQ(problems(good_scene, registry), ""); }

}  // namespace
}  // namespace withy::test
