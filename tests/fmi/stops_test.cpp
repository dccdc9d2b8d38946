// Events that stop a run, and starts and kinds of which nothing can come.
#include <gmock/gmock.h>

#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// A top that turns at 1 rad/s about z; after a second the simulation is over.
constexpr const char* top = R"(format: withy/1
time: {end: 3}
bodies: {bus: {type: rigid, mass: 1, inertia: [2, 2, 2, 0, 0, 0], frames: {p: {position: [1, 0, 0]}}}}
hinges: {base: {type: free, parent: world, child: bus}}
initial: {hinges: {base: {rate: [0, 0, 1, 0, 0, 0]}}}
outputs: {p: {type: frame, of: bus.p, show: position}}
events: {over: {at: 1, stop: true}}
)";

std::string top_file() {
  const std::filesystem::path file = scratch() / "top.yaml";
  std::ofstream(file) << top;
  return file.string();
}

/// Steps of 0.25 s land on the event, those of 0.3 s do not.
TEST(Stops, EndCoSimulationAlsoWhereAStepEndsAnyway) {
  for (const double h : {0.25, 0.1, 0.3}) {
    Instance2 two(exported(top_file(), 2), fmi2CoSimulation);
    Instance3 three(exported(top_file(), 3), true);
    two.initialize();
    three.initialize();
    bool event = false, terminate = false, early = false;
    double last = 0;
    fmi2Status status = fmi2OK;
    for (int k = 0; status == fmi2OK && k < 20; ++k) {
      status = two.fmi.DoStep(two.c, k * h, h, fmi2True);
      ASSERT_EQ(three.fmi.DoStep(three.c, k * h, h, true, &event, &terminate, &early, &last), fmi3OK);
      EXPECT_EQ(terminate, status == fmi2Discard);
      EXPECT_FALSE(event || early);
    }
    EXPECT_EQ(status, fmi2Discard) << h;
    EXPECT_EQ(two.heard.last, "fmi2DoStep: event 'over' ends the simulation at t = 1 s");
    EXPECT_EQ(last, 1);
    fmi2Boolean terminated = fmi2False;
    EXPECT_EQ(two.fmi.GetBooleanStatus(two.c, fmi2Terminated, &terminated), fmi2OK);
    EXPECT_TRUE(terminated);
    double reached = 0;
    EXPECT_EQ(two.fmi.GetRealStatus(two.c, fmi2LastSuccessfulTime, &reached), fmi2OK);
    EXPECT_EQ(reached, 1);
  }
}

/// As of hosts that begin all variables with zeros: it would turn without an attitude.
TEST(Starts, OfAQuaternionThatIsZeroAreRefused) {
  const Unpacked& fmu = exported(top_file(), 2);
  for (const fmi2Type type : {fmi2CoSimulation, fmi2ModelExchange}) {
    Instance2 i(fmu, type);
    for (const char* name : {"base.qw", "base.qx", "base.qy", "base.qz"})
      EXPECT_EQ(i.set(fmu.reference(name), 0), fmi2OK);
    EXPECT_EQ(i.fmi.SetupExperiment(i.c, fmi2False, 0, 0, fmi2False, 0), fmi2OK);
    EXPECT_EQ(i.fmi.EnterInitializationMode(i.c), fmi2OK);
    EXPECT_EQ(i.fmi.ExitInitializationMode(i.c), fmi2Error);
    EXPECT_THAT(i.heard.last, HasSubstr("hinge 'base': got base.qw, qx, qy, qz = 0, 0, 0, 0; need a quaternion that is "
                                        "not zero"));
    EXPECT_EQ(i.set(fmu.reference("base.qz"), 2), fmi2OK);  // of any other length it is scaled
    EXPECT_EQ(i.fmi.ExitInitializationMode(i.c), fmi2OK) << i.heard.last;
    EXPECT_NEAR(i.get(fmu.reference("p.x")), -1, 1e-12);
  }
}

/// The solver of a host would not keep them closed.
TEST(Instances, OfModelExchangeAreNotMadeOfClosedLoops) {
  const std::filesystem::path out = scratch() / "loop.fmu";
  const auto prepared = host::Scene::read(library(), SCENES "/gallery/four-bar.yaml").prepare();
  static_cast<void>(fmi::export_fmu(*prepared, {}, library().registry(), {2, false, true, out}));
  const Unpacked fmu = unpack(out, 2);
  Instance2(fmu, fmi2CoSimulation).initialize();
  try {
    Instance2(fmu, fmi2ModelExchange);
    ADD_FAILURE() << "it is made";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("--kind cs"));
  }
}

}  // namespace
}  // namespace withy::test
