// Plans: everything that is wrong is said at once, each at its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "withy/campaign/cases.hpp"
#include "withy/campaign/histories.hpp"
#include "withy/campaign/kept.hpp"
#include "withy/tests/campaign/plan_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Plans, SayAllThatIsWrongAtItsPlace) {
  const PlanFolder folder;
  const std::string said = folder.errors(R"(vary:
  bodies.rod.mass: {normal: {mean: 1.2, devation: 0.1}}
  gravity.1: {uniform: {from: -9, to: -10}}
  bodies.rodd.mass: {grid: [1, 2]}
  time.end: {list: nowhere.csv}
  integrator.rtol: {normal: {mean: "3 kg", deviation: 0.1}}
cases: 2.5
sede: 3
keep: {final: pivot}
correlation: {of: [gravity.2], matrix: [[1]]}
)");
  const std::string file = (folder / "plan.yaml").string();
  for (const char* part :
       {":5:41: /vary/bodies.rod.mass/normal/devation: unknown key \"devation\"; did you mean 'deviation'?",
        ":6:24: /vary/gravity.1/uniform: 'from' is not below 'to'",
        ":7:29: /bodies: no \"rodd\" here to change; did you mean 'rod'?", ":8:20: /vary/time.end/list: cannot read",
        ":9:55: /vary/integrator.rtol/normal/deviation: its unit is another",
        ":10:8: /cases: got 2.5; need a whole number", ":11:1: /sede: unknown key \"sede\"; did you mean 'seed'?",
        ":12:15: /keep/final: got \"pivot\"; need a list", ":13:15: /correlation/of: \"gravity.2\" does not vary"})
    EXPECT_THAT(said, HasSubstr(file + part)) << said;
}

TEST(Plans, LookUpNamesWhateverElseIsWrong) {
  const PlanFolder folder;
  const std::string said = folder.errors(R"(vary:
  bodies.rod.mass: {grid: [1, -3]}
  gravity.1: {normal: {mean: -9, deviation: -1}}
cases: 3
sede: 3
keep: {final: [pivto]}
derived: {gravity.0: 2 * bodies.rodd.mass}
)");
  EXPECT_THAT(said, AllOf(HasSubstr("/bodies/rod/mass: got -3"), HasSubstr("need a deviation above 0"),
                          HasSubstr("unknown key \"sede\""), HasSubstr("no result \"pivto\"; did you mean 'pivot'?"),
                          HasSubstr("bodies.rodd.mass")));
  EXPECT_THAT(said, testing::Not(HasSubstr("nothing is drawn"))) << "what is drawn is what is wrong";
}

TEST(Plans, TryEveryValueThatStandsInThemInTheScene) {
  const PlanFolder folder;
  const std::string said = folder.errors(R"(vary:
  bodies.rod.mass: {grid: [1, 2, -3, "4 m"]}
  integrator.name: {grid: [dopri5, dopri]}
  gravity.1: {uniform: {from: "-10 kg", to: "-9 kg"}}
)");
  EXPECT_THAT(said, HasSubstr("plan.yaml:7:31: /gravity/1: got \"-10 kg\""));
  const std::string later = folder.errors(R"(vary:
  bodies.rod.mass: {grid: [1, 2, -3, "4 m"]}
  integrator.name: {grid: [dopri5, dopri]}
keep: {final: [pivot]}
)");
  EXPECT_THAT(later, AllOf(HasSubstr("plan.yaml:5:34: /bodies/rod/mass: got -3"),
                           HasSubstr("plan.yaml:5:38: /bodies/rod/mass: got \"4 m\""),
                           HasSubstr("plan.yaml:6:36: /integrator/name: no integrator plugin \"dopri\"")));
  EXPECT_THAT(folder.errors("vary: {bodies.rod.mass: {grid: [1]}}\nkeep: {peak: [pivto]}\n"),
              HasSubstr("plan.yaml:5:15: /keep/peak/0: no result \"pivto\"; did you mean 'pivot'?"));
}

/// The rod's inertia about z can only be that about x: it has none about y.
TEST(Plans, TakeValuesThatTheSceneTakesOnlyWithWhatFollowsFromThem) {
  const PlanFolder folder;
  folder.write("list.csv", "i\n0.2\n0.3\n");
  for (const char* values : {"{grid: [0.2, 0.3]}", "{grid: [0.2 kg m^2, 0.3]}", "{list: {file: list.csv, column: i}}",
                             "{normal: {mean: 0.2, deviation: 0.02}}", "{uniform: {from: 0.2, to: 0.3}}"}) {
    const Plan plan = folder.plan(std::string("vary: {bodies.rod.inertia.2: ") + values +
                                  "}\nderived: {bodies.rod.inertia.0: bodies.rod.inertia.2}\n");
    const CaseValues first = Cases(plan).values(0);
    EXPECT_EQ(first[0]->number(), first[1]->number()) << values;
  }
}

TEST(Plans, TellWhatTheSceneRefusesOfDerivedValuesOnceAndAtTheirPlace) {
  const PlanFolder folder;
  const auto told = [&](const std::string& values, const std::string& formula) {
    return folder.errors("vary: {bodies.rod.center_of_mass.0: " + values + "}\nderived: {bodies.rod.mass: " + formula +
                         "}\n");
  };
  const std::string x = "bodies.rod.center_of_mass.0", place = "plan.yaml:5:28: /bodies/rod/mass: got ";
  const std::string each = told("{grid: [1, 2, 3]}", "-" + x);
  EXPECT_THAT(each, HasSubstr(place + "-1"));
  EXPECT_EQ(each.find(place), each.rfind(place)) << each;
  EXPECT_THAT(told("{grid: [1, 2, -3]}", x), HasSubstr(place + "-3")) << "not the first alone";
  EXPECT_THAT(told("{uniform: {from: 0, to: 1}}", "-1 - " + x), HasSubstr(place + "-1.5"));
  EXPECT_EQ(told("{uniform: {from: 0, to: 1}}", x), "nothing") << "no case has the end itself";
}

/// What goes together with no other value is a mistake; what goes together with some is a matter of the cases.
TEST(Plans, TakeValuesThatTheSceneTakesOnlyWithSomeOfOthers) {
  const PlanFolder folder;
  const auto plan = [](const std::string& z, const std::string& x) {
    return "vary:\n  bodies.rod.inertia.2: {grid: " + z + "}\n  bodies.rod.inertia.0: {grid: " + x + "}\n";
  };
  EXPECT_EQ(Cases(folder.plan(plan("[0.1, 0.3]", "[0.1, 0.3]"))).size(), 4U);
  EXPECT_EQ(Cases(folder.plan(plan("[0.2, 0.3]", "[0.3, 0.2]"))).size(), 4U) << "the first do not go together";
  const Plan read = folder.plan(plan("[0.2 kg m^2, 0.3]", "[0.3 kg m^2, 0.2]"));
  for (const Axis& axis : read.axes) EXPECT_EQ(axis.levels.numbers.size(), 2U) << axis.path;
  const std::string said = folder.errors(plan("[0.1, 0.5, 0.3]", "[0.1, 0.3]"));
  EXPECT_THAT(said, HasSubstr("plan.yaml:5:38: /bodies/rod/inertia: "));
  EXPECT_EQ(said.find("plan.yaml:"), said.rfind("plan.yaml:")) << said;
  EXPECT_THAT(folder.errors(plan("[0.1, 0.3]", "[0.1, 0.3]") + "design: one-at-a-time\n"),
              AllOf(HasSubstr("plan.yaml:5:38: "), HasSubstr("plan.yaml:6:38: ")))
      << "no case has both";
}

TEST(Plans, RefuseWhatTheirDesignCannotBe) {
  const PlanFolder folder;
  EXPECT_THAT(folder.errors("vary: {bodies.rod.mass: {grid: [1, 2]}}\ncases: 3\n"), HasSubstr("nothing is drawn"));
  EXPECT_THAT(folder.errors("vary: {bodies.rod.mass: {grid: [1, 2]}}\ndesign: morris\n"),
              HasSubstr("draws every value"));
  EXPECT_THAT(folder.errors("vary: {bodies.rod.mass: {latin: {from: 1, to: 2}}}\ndesign: saltelli\n"),
              HasSubstr("a sampling of its own"));
  const std::string two = "vary: {gravity.0: {uniform: {from: 1, to: 2}}, gravity.2: {uniform: {from: 1, to: 2}}}\n";
  for (const char* matrix : {"[[1, 0.5], [0.4, 1]]", "[[1, 2], [2, 1]]", "[[1, 0.5]]", "[[2, 0], [0, 1]]"})
    EXPECT_THAT(folder.errors(two + "correlation: {of: [gravity.0, gravity.2], matrix: " + matrix + "}\n"),
                HasSubstr("need 2 rows of 2 correlations"));
}

/// As the scene reads them: 2000 g are 2 kg in tables, too. Names stay names, and what is no mass is the scene's to
/// refuse.
TEST(Plans, HaveTheLevelsOfGridsAndListsInSiUnits) {
  const PlanFolder folder;
  folder.write("list.csv", "rate\n0.5\n30 deg/s\n1 rpm\n");
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {grid: ["2000 g", 2.5, "3 kg"]}
  initial.hinges.pivot.rate.0: {list: list.csv}
  name: {grid: ["2 kg", other]}
  gravity: {grid: [[0, "-9810 mm/s^2", 0]]}
derived: {bodies.rod.center_of_mass.1: "-0.25 * bodies.rod.mass"}
)");
  EXPECT_THAT(plan.axes[0].levels.numbers, ElementsAre(2, 2.5, 3));
  ASSERT_EQ(plan.axes[1].levels.numbers.size(), 3U);
  EXPECT_NEAR(plan.axes[1].levels.numbers[1], 0.523598775598299, 1e-15);
  EXPECT_NEAR(plan.axes[1].levels.numbers[2], 0.104719755119660, 1e-15);
  ASSERT_EQ(plan.axes[2].levels.size(), 2U);
  EXPECT_EQ(plan.axes[2].levels.at(0).text(), "2 kg");
  EXPECT_EQ(plan.axes[3].levels.at(0).kind(), Value::Kind::list);
  // A row of another unit in a list, of which the first is tried.
  folder.write("mixed.csv", "mass\n1500 g\n5 s\n");
  const Plan mixed = folder.plan("vary: {bodies.rod.mass: {list: mixed.csv}}\n");
  EXPECT_EQ(mixed.axes[0].levels.at(0).number(), 1.5);
  EXPECT_EQ(mixed.axes[0].levels.at(1).text(), "5 s");
}

/// The first quantities of two columns stand in different rows, and no case has both: an effort that would end before
/// it begins. Nor does a wrong row before others, which its case tells, leave these in other units.
TEST(Plans, HaveLevelsInSiUnitsWhereTheFirstOfAllColumnsMakeNoScene) {
  const PlanFolder folder;
  folder.write("scene.yaml", R"(format: withy/1
time: {end: 1}
bodies: {rod: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}
loads: {push: {type: hinge-effort, hinge: pin, law: constant, value: 1, start: 0.1, stop: 0.9}}
)");
  folder.write("plan.yaml", R"(format: withy-sweep/1
scene: scene.yaml
vary: {loads.push.start: {list: list.csv}, loads.push.stop: {list: list.csv}}
derived: {bodies.rod.mass: "1 + loads.push.start"}
)");
  const std::string head = "loads.push.start,loads.push.stop\n0.1,200 ms\n";
  const auto starts = [&](const std::string& rows) {
    folder.write("list.csv", head + rows);
    return read_plan((folder / "plan.yaml").string(), test::plugins()).axes[0].levels.numbers;
  };
  EXPECT_THAT(starts("500 ms,0.9\n"), ElementsAre(0.1, 0.5));
  EXPECT_THAT(starts("500 ms,0.4\n200 ms,0.4\n"), ElementsAre(0.1, 0.5, 0.2));
}

TEST(Plans, KeepColumnsOfHingesVectorsAndSingleResults) {
  const PlanFolder folder;
  const Plan plan = folder.plan(
      "vary: {bodies.rod.mass: {grid: [1, \"2 kg\"]}}\nkeep: {final: [pivot, rod.tip, t], peak: [pivot.rate]}\n");
  EXPECT_THAT(kept_columns(plan), ElementsAre("final.pivot[rad]", "final.rod.tip.x[m]", "final.rod.tip.y[m]",
                                              "final.rod.tip.z[m]", "final.t[s]", "peak.pivot.rate[rad/s]"));
}

/// And a case that is run alone has them, too.
TEST(Plans, KeepOutputsThatTheSceneDoesNotDefine) {
  const PlanFolder folder;
  const Plan plan = folder.plan(
      "vary: {bodies.rod.mass: {grid: [1, 2]}}\nkeep: {final: [pivot.reaction.fx.max], peak: [pivot.acceleration]}\n");
  EXPECT_THAT(kept_columns(plan), ElementsAre("final.pivot.reaction.fx.max[N]", "peak.pivot.acceleration[rad/s^2]"));
  ASSERT_GE(plan.set.size(), 2U);
  const auto& [path, name] = plan.set[plan.set.size() - 2];
  EXPECT_EQ(path, "outputs");
  EXPECT_EQ(name.text(), "pivot.reaction.fx.max");
  EXPECT_THAT(folder.errors("vary: {bodies.rod.mass: {grid: [1]}}\nkeep: {final: [pivto.acceleration]}\n"),
              HasSubstr("no hinge \"pivto\"; did you mean 'pivot'?"));
}

TEST(Plans, KeepHistoriesAtTimesThatAllCasesShare) {
  const PlanFolder folder;
  const std::string vary = "vary: {bodies.rod.mass: {grid: [1, 2]}}\n";
  const Plan plan = folder.plan(vary + "keep: {history: {of: [pivot, rod.tip], every: \"200 ms\"}}\n");
  EXPECT_THAT(plan.history.times, ElementsAre(0, 0.2, 0.4, 0.5));
  EXPECT_THAT(history_columns(plan), ElementsAre("pivot[rad]", "rod.tip.x[m]", "rod.tip.y[m]", "rod.tip.z[m]"));
  EXPECT_EQ(folder.plan(vary + "keep: {history: [pivot]}\n").history.times.size(), 26U) << "the scene's outputs";
  for (const auto& [history, why] : {std::pair("[pivto]", "no result \"pivto\"; did you mean 'pivot'"),
                                     std::pair("{every: 0.1}", "missing; need a list"),
                                     std::pair("{of: [pivot], every: \"1 m\"}", "need a time above 0 s"),
                                     std::pair("{of: [pivot], every: 1e-6}", "times are too many"),
                                     std::pair("{of: [pivot], evry: 1}", "did you mean 'every'")})
    EXPECT_THAT(folder.errors(vary + "keep: {history: " + history + "}\n"), HasSubstr(why));
  EXPECT_THAT(folder.errors("vary: {time.end: {grid: [1, 2]}}\nkeep: {history: [pivot]}\n"),
              HasSubstr("needs one end of all cases, and time.end varies"));
  EXPECT_THAT(folder.errors(vary + "derived: {time.end: \"bodies.rod.mass\"}\nkeep: {history: [pivot]}\n"),
              HasSubstr("needs one end of all cases, and time.end varies"));
  EXPECT_THAT(folder.errors("vary: {initial.time: {grid: [0, 0.1]}}\nkeep: {history: [pivot]}\n"),
              HasSubstr("needs one start of all cases, and initial.time varies"));
}

TEST(Histories, BeginWhereRunsDo) {
  EXPECT_THAT(history_times(1, 1.5, 0.2), ElementsAre(1, 1.2, 1.4, 1.5));
  EXPECT_THAT(history_times(-0.5, 0, 0.25), ElementsAre(-0.5, -0.25, 0));
}

TEST(Plans, DeriveValuesByFormulasOfWhatVariesAndOfTheScene) {
  const PlanFolder folder;
  const std::string vary = "vary: {bodies.rod.mass: {grid: [2, 4]}}\n";
  const Plan plan = folder.plan(vary + "derived: {gravity.0: \"sqrt(bodies.rod.mass) * gravity.1 / 2\"}\n");
  EXPECT_EQ(Cases(plan).values(1)[1]->number(), 2 * -9.81 / 2);
  EXPECT_THAT(folder.errors(vary + "derived: {gravity.0: \"2 *\"}\n"),
              HasSubstr("plan.yaml:5:22: /derived/gravity.0: "));
  EXPECT_THAT(folder.errors(vary + "derived: {gravity.0: \"2 * gravity.7\"}\n"),
              HasSubstr("\"gravity.7\" neither varies nor is a number of the scene"));
  EXPECT_THAT(folder.errors(vary + "derived: {bodies.rod.mas: \"2\"}\n"),
              HasSubstr("plan.yaml:5:27: /bodies/rod/mas: unknown key"));
}

/// In every case a formula sees the numbers of that case.
TEST(Plans, DeriveValuesFromThoseDerivedBefore) {
  const PlanFolder folder;
  const std::string vary = "vary: {bodies.rod.mass: {grid: [2, 4]}}\n";
  const Plan plan = folder.plan(vary + "derived: {gravity.0: 3 * bodies.rod.mass, gravity.2: gravity.0 + 1}\n");
  for (const std::uint64_t i : {0U, 1U}) {
    EXPECT_EQ(Cases(plan).values(i)[1]->number(), 6 + 6 * static_cast<double>(i));
    EXPECT_EQ(Cases(plan).values(i)[2]->number(), 7 + 6 * static_cast<double>(i));
  }
  EXPECT_EQ(Cases(folder.plan(vary + "derived: {gravity.1: gravity.1 / bodies.rod.mass}\n")).values(0)[1]->number(),
            -9.81 / 2)
      << "its own path is the scene's number";
  EXPECT_THAT(folder.errors(vary + "derived: {gravity.2: gravity.0 + 1, gravity.0: 3 * bodies.rod.mass}\n"),
              HasSubstr("plan.yaml:5:22: /derived/gravity.2: \"gravity.0\" is derived behind it"));
  EXPECT_THAT(folder.errors("vary: {gravity: {grid: [[0, -9, 0], [0, -8, 0]]}}\n"
                            "derived: {bodies.rod.mass: -gravity.1}\n"),
              HasSubstr("\"gravity.1\" is a part of \"gravity\""));
}

/// Where a value elsewhere is wrong, quantities have not been read as numbers, which is no trouble of theirs.
TEST(Plans, SayNothingOfQuantitiesWhereAnotherValueIsWrong) {
  const PlanFolder folder;
  const std::string derived = "derived: {gravity.0: 3 * bodies.rod.mass}\n";
  const std::string said =
      folder.errors("vary: {bodies.rod.mass: {grid: [1.5 kg, 2]}, gravity.1: {grid: [-9, -x]}}\n" + derived);
  EXPECT_THAT(said, AllOf(HasSubstr("/gravity/1: got \"-x\""), testing::Not(HasSubstr("as plain numbers"))));
  EXPECT_THAT(folder.errors("vary: {name: {grid: [one, two]}}\nderived: {gravity.0: 3 * name}\n"),
              HasSubstr("\"name\" varies, but not as plain numbers"));
}

/// Two paths may lead into each other only where neither takes away what the other sets.
TEST(Plans, RefuseWhatAnotherValueWouldReplace) {
  const PlanFolder folder;
  EXPECT_THAT(folder.errors("vary: {gravity.1: {grid: [-9, -8]}, gravity: {grid: [[0, -7, 0]]}}\n"),
              HasSubstr("plan.yaml:4:37: /vary/gravity: takes the place of \"gravity.1\""));
  EXPECT_THAT(folder.errors("vary: {gravity: {grid: [[0, -7, 0]]}, gravity.1: {grid: [-9, -8]}}\n"),
              HasSubstr("/vary/gravity.1: takes the place of a part that values of \"gravity\" give"));
  EXPECT_THAT(folder.errors("vary: {gravity: {grid: [[0, -7, 0]]}}\nderived: {gravity.1: \"-9\"}\n"),
              HasSubstr("/derived/gravity.1: takes the place of a part that values of \"gravity\" give"));
  EXPECT_THAT(folder.errors("vary: {integrator: {grid: [dopri5]}, integrator.name: {grid: [rk4]}}\n"),
              HasSubstr("/vary/integrator.name: takes the place of a part"));
  const std::string apart = "vary: {integrator: {grid: [dopri5, radau]}, integrator.rtol: {grid: [1.0e-4, 1.0e-6]}}\n";
  EXPECT_EQ(Cases(folder.plan(apart)).size(), 4U) << "no integrator says a tolerance";
  const std::string alone = "vary: {gravity.1: {grid: [-9]}, gravity: {grid: [[0, -7, 0]]}}\ndesign: one-at-a-time\n";
  EXPECT_EQ(Cases(folder.plan(alone)).size(), 3U) << "no case has both";
}

TEST(Plans, FingerprintsTellApartWhatChangesResultsAndNothingElse) {
  const PlanFolder folder;
  const auto of = [&](const std::string& more) { return folder.plan(more).fingerprint; };
  const std::string plan = "vary: {bodies.rod.mass: {normal: {mean: 1, deviation: 0.1}}}\ncases: 3\n";
  EXPECT_EQ(of(plan), of("# a comment\nname: other words\n" + plan + "failures: stop\n"));
  EXPECT_NE(of(plan), of(plan + "seed: 1\n"));
  EXPECT_NE(of(plan), of(plan + "keep: {final: [pivot]}\n"));
  const std::string list = "vary: {bodies.rod.mass: {list: mass.csv}}\n";
  folder.write("mass.csv", "mass\n1\n2\n");
  const std::string before = of(list);
  folder.write("mass.csv", "mass\n1\n3\n");
  EXPECT_NE(before, of(list));
}

/// Whatever row of a list names it, alone or with others of its row.
TEST(Plans, FingerprintsKnowTheFilesThatListsName) {
  const PlanFolder folder;
  folder.write("boom.yaml", R"(format: withy/1
time: {end: 1}
bodies: {boom: {type: modal, file: a.SID_FEM, damping_ratio: 0.005}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
)");
  folder.write("files.csv", "bodies.boom.file,gravity.1\na.SID_FEM,-1\na.SID_FEM,-2\nb.SID_FEM,-3\n");
  folder.write("files.yaml",
               "format: withy-sweep/1\nscene: boom.yaml\nvary: {bodies.boom.file: {list: files.csv}, "
               "gravity.1: {list: files.csv}}\n");
  const auto fingerprint = [&] { return read_plan((folder / "files.yaml").string(), test::plugins()).fingerprint; };
  std::ifstream file(WITHY_SOURCES "/scenes/cantilever.SID_FEM", std::ios::binary);
  const std::string cantilever{std::istreambuf_iterator<char>(file), {}};
  for (const char* name : {"a.SID_FEM", "b.SID_FEM"}) folder.write(name, cantilever);
  const std::string before = fingerprint();
  EXPECT_EQ(fingerprint(), before);
  folder.write("b.SID_FEM", cantilever + "\n");
  EXPECT_NE(fingerprint(), before);
}

}  // namespace
}  // namespace withy::campaign
