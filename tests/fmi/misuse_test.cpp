// Handles, resources and parameters that cannot be: no instance, or a sentence that says what is wrong.
#include <gmock/gmock.h>

#include "withy/tests/fmi/importer.hpp"

namespace withy::test {

TEST(Misuse, HandlesTokensAndResourcesThatAreNoneGiveNoInstance) {
  const Unpacked& fmu = exported(commanded, 2);
  const Fmi2 f(fmu);
  Heard heard;
  const fmi2CallbackFunctions functions{&hear2, nullptr, nullptr, nullptr, &heard};
  const std::string resources = "file://" + (fmu.folder / "resources").string();
  const auto make = [&](const char* token, const char* where) {
    fmi2Component c = f.Instantiate("x", fmi2CoSimulation, token, where, &functions, 0, 0);
    EXPECT_EQ(c, nullptr);
    return heard.last;
  };
  EXPECT_NE(make("not-the-token", resources.c_str()).find("'not-the-token'"), std::string::npos);
  EXPECT_NE(make(fmu.token.c_str(), "file:///nowhere").find("/nowhere"), std::string::npos);
  EXPECT_NE(make(fmu.token.c_str(), "http://host/x").find("need a file of this machine"), std::string::npos);
  EXPECT_EQ(f.Instantiate("x", fmi2CoSimulation, fmu.token.c_str(), resources.c_str(), nullptr, 0, 0), nullptr);
  // A scene that has been changed since is not what the model description describes.
  const std::filesystem::path changed = scratch() / "changed resources";
  std::filesystem::copy(fmu.folder / "resources", changed, std::filesystem::copy_options::recursive);
  std::ofstream(changed / "scene" / "commanded-arm.yaml", std::ios::app) << "# more\n";
  EXPECT_NE(
      make(fmu.token.c_str(), ("file://" + scratch().string() + "/changed%20resources").c_str()).find("another FMU"),
      std::string::npos);
  std::vector<std::uint64_t> memory(64);
  EXPECT_EQ(f.DoStep(nullptr, 0, 1, 1), fmi2Error);
  EXPECT_EQ(f.DoStep(memory.data(), 0, 1, 1), fmi2Error);
  f.FreeInstance(nullptr);
  f.FreeInstance(memory.data());
}

TEST(Misuse, ASentenceSaysWhatIsWrongAndParametersThatCannotBeAreReportedByTheirPath) {
  const Unpacked& fmu = exported(commanded, 2);
  Instance2 i(fmu, fmi2CoSimulation);
  EXPECT_EQ(i.fmi.DoStep(i.c, 0, 0.1, 1), fmi2Error);
  EXPECT_EQ(i.heard.last, "fmi2DoStep: is not to be called in the mode instantiated");
  EXPECT_EQ(i.set(fmu.reference("bodies.link1.length"), -1), fmi2OK);
  EXPECT_EQ(i.fmi.EnterInitializationMode(i.c), fmi2Error);
  EXPECT_NE(i.heard.last.find("/bodies/link1/length"), std::string::npos) << i.heard.last;
  EXPECT_EQ(i.set(fmu.reference("bodies.link1.length"), 0.9), fmi2OK);
  i.initialize();
  EXPECT_EQ(i.set(fmu.reference("bodies.link1.length"), 1), fmi2Error);
  EXPECT_EQ(i.set(fmu.reference("link1.tip.x"), 1), fmi2Error);
  EXPECT_EQ(i.heard.last, "fmi2SetReal: variable 'link1.tip.x': is calculated");
  EXPECT_EQ(i.set(fmu.reference("command"), std::nan("")), fmi2Error);
  EXPECT_EQ(i.fmi.DoStep(i.c, 0.5, 0.1, 1), fmi2Error);
  EXPECT_EQ(i.fmi.GetDerivatives(i.c, nullptr, 0), fmi2Error);
  EXPECT_EQ(i.heard.last, "fmi2GetDerivatives: is of model exchange; the instance is of co-simulation");
}

/// Past a stop time that the host has set there is an error, and the instance stands where it was; integrators may look
/// beyond it.
TEST(Misuse, NoStepGoesBeyondTheStopTimeOfTheHost) {
  const Unpacked &two = exported(smooth_arm_file(), 2), &three = exported(smooth_arm_file(), 3);
  Instance2 stepped(two, fmi2CoSimulation);
  EXPECT_EQ(stepped.fmi.SetupExperiment(stepped.c, fmi2False, 0, 0.5, fmi2True, 0.1), fmi2Error);
  EXPECT_THAT(stepped.heard.last, testing::HasSubstr("stop time 0.1 s lies before the start time 0.5 s"));
  EXPECT_EQ(stepped.fmi.SetupExperiment(stepped.c, fmi2False, 0, 0, fmi2True, 0.3), fmi2OK);
  EXPECT_EQ(stepped.fmi.EnterInitializationMode(stepped.c), fmi2OK);
  EXPECT_EQ(stepped.fmi.ExitInitializationMode(stepped.c), fmi2OK);
  double t = 0;
  for (int i = 0; i < 3; ++i, t += 0.1) EXPECT_EQ(stepped.fmi.DoStep(stepped.c, t, 0.1, fmi2True), fmi2OK);
  EXPECT_GT(t, 0.3);  // by rounding, which is none of the host's
  const double there = stepped.get(two.reference("axle"));
  EXPECT_EQ(stepped.fmi.DoStep(stepped.c, t, 0.1, fmi2True), fmi2Error);
  EXPECT_THAT(stepped.heard.last, testing::HasSubstr("lies beyond the stop time that was set, 0.3 s"));
  EXPECT_EQ(stepped.get(two.reference("axle")), there);

  Instance3 all(three, true);
  EXPECT_EQ(all.fmi.EnterInitializationMode(all.c, false, 0, 0, true, 0.3), fmi3OK);
  EXPECT_EQ(all.fmi.ExitInitializationMode(all.c), fmi3OK);
  bool event = false, terminate = false, early = false;
  EXPECT_EQ(all.fmi.DoStep(all.c, 0, 0.31, true, &event, &terminate, &early, &t), fmi3Error);
  EXPECT_EQ(all.fmi.DoStep(all.c, 0, 0.3, true, &event, &terminate, &early, &t), fmi3OK);

  Instance2 exchanged(two, fmi2ModelExchange);
  EXPECT_EQ(exchanged.fmi.SetupExperiment(exchanged.c, fmi2False, 0, 0, fmi2True, 0.3), fmi2OK);
  EXPECT_EQ(exchanged.fmi.EnterInitializationMode(exchanged.c), fmi2OK);
  EXPECT_EQ(exchanged.fmi.ExitInitializationMode(exchanged.c), fmi2OK);
  EXPECT_EQ(exchanged.fmi.SetTime(exchanged.c, 0.4), fmi2Error);
  EXPECT_EQ(exchanged.fmi.EnterContinuousTimeMode(exchanged.c), fmi2OK);
  EXPECT_EQ(exchanged.fmi.SetTime(exchanged.c, 0.4), fmi2OK);
  std::vector<double> slopes(two.states.size());
  EXPECT_EQ(exchanged.fmi.GetDerivatives(exchanged.c, slopes.data(), slopes.size()), fmi2OK);
  fmi2Boolean enter = fmi2False, end = fmi2False;
  EXPECT_EQ(exchanged.fmi.CompletedIntegratorStep(exchanged.c, fmi2True, &enter, &end), fmi2Error);
  EXPECT_EQ(exchanged.fmi.EnterEventMode(exchanged.c), fmi2Error);
  EXPECT_EQ(exchanged.fmi.SetTime(exchanged.c, 0.3), fmi2OK);
  EXPECT_EQ(exchanged.fmi.EnterEventMode(exchanged.c), fmi2OK);
}

}  // namespace withy::test
