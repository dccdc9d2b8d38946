// FMI 2.0: a status and a sentence, never a crash.
#include "withy/tests/fmi/random_calls.hpp"

namespace withy::test {
namespace {

/// All calls of an instance, with arguments by chance.
struct Calls2 {
  Chance& chance;
  const Unpacked& fmu;
  Instance2& instance;
  decltype(instance.fmi)& fmi = instance.fmi;
  fmi2Component c = instance.c;
  std::size_t n = fmu.states.size();
  double t = 0;
  std::vector<fmi2FMUstate> states = std::vector<fmi2FMUstate>(3);
  std::vector<char> bytes = std::vector<char>(4000);

  /// Beginning and end.
  [[nodiscard]] Calls<fmi2Status> of_life() {
    return {[this] { return fmi.SetupExperiment(c, chance.below(2) == 0, chance.number(), chance.number(), 0, 0); },
            [this] { return fmi.EnterInitializationMode(c); },
            [this] { return fmi.ExitInitializationMode(c); },
            [this] { return fmi.EnterInitializationMode(c); },
            [this] { return fmi.ExitInitializationMode(c); },
            [this] { return fmi.Terminate(c); },
            [this] { return fmi.Reset(c); }};
  }

  /// Variables.
  [[nodiscard]] Calls<fmi2Status> of_values() {
    return {[this] {
              auto r = chance.references();
              return fmi.GetReal(c, chance.maybe(r.data()), r.size(), chance.array());
            },
            [this] {
              auto r = chance.references();
              return fmi.SetReal(c, chance.maybe(r.data()), r.size(), chance.array());
            },
            [this] {
              const auto r = fmu.of("input");
              return fmi.SetReal(c, r.data(), r.size(), chance.array());
            },
            [this] {
              auto r = chance.references();
              int v = 0;
              return fmi.GetInteger(c, r.data(), std::min<std::size_t>(r.size(), 1), &v);
            },
            [this] {
              auto r = chance.references();
              const char* v = "";
              return fmi.SetString(c, r.data(), std::min<std::size_t>(r.size(), 1), &v);
            },
            [this] {
              int order = 1;
              auto r = chance.references();
              return fmi.SetRealInputDerivatives(c, r.data(), 1, &order, chance.array());
            },
            [this] {
              int order = 1;
              auto r = chance.references();
              return fmi.GetRealOutputDerivatives(c, r.data(), 1, &order, chance.array());
            },
            [this] {
              const char* category = "logAll";
              return fmi.SetDebugLogging(c, chance.below(2) == 0, 1, chance.maybe(&category));
            }};
  }

  /// States that are kept, and derivatives at them.
  [[nodiscard]] Calls<fmi2Status> of_kept_states() {
    return {[this] { return fmi.GetFMUstate(c, chance.maybe(&states[chance.below(3)])); },
            [this] { return fmi.SetFMUstate(c, chance.rarely() ? &states : states[chance.below(3)]); },
            [this] { return fmi.FreeFMUstate(c, chance.maybe(&states[chance.below(3)])); },
            [this] {
              std::size_t size = 0;
              return fmi.SerializedFMUstateSize(c, states[chance.below(3)], &size);
            },
            [this] {
              return fmi.SerializeFMUstate(c, states[chance.below(3)], bytes.data(), chance.count(bytes.size() - 1));
            },
            [this] {
              fmi2FMUstate made = nullptr;
              const fmi2Status s = fmi.DeSerializeFMUstate(c, bytes.data(), chance.below(bytes.size()), &made);
              if (made != nullptr) fmi.FreeFMUstate(c, &made);
              return s;
            },
            [this] {
              auto u = chance.references(), k = chance.references();
              return fmi.GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), chance.array(),
                                                  chance.more());
            }};
  }

  /// Events and continuous states.
  [[nodiscard]] Calls<fmi2Status> of_model_exchange() {
    return {[this] { return fmi.EnterEventMode(c); },
            [this] {
              fmi2EventInfo info;
              return fmi.NewDiscreteStates(c, chance.maybe(&info));
            },
            [this] { return fmi.EnterContinuousTimeMode(c); },
            [this] {
              fmi2Boolean a = 0, b = 0;
              return fmi.CompletedIntegratorStep(c, 1, chance.maybe(&a), &b);
            },
            [this] { return fmi.SetTime(c, t = chance.number()); },
            [this] { return fmi.SetContinuousStates(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetDerivatives(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetEventIndicators(c, chance.array(), chance.count(0)); },
            [this] { return fmi.GetContinuousStates(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetNominalsOfContinuousStates(c, chance.array(), chance.count(n)); }};
  }

  /// Steps and what is asked of them.
  [[nodiscard]] Calls<fmi2Status> of_co_simulation() {
    return {[this] {
              const double h = chance.step();
              const fmi2Status s = fmi.DoStep(c, t, h, 1);
              if (s == fmi2OK) t += h;
              return s;
            },
            [this] { return fmi.CancelStep(c); },
            [this] {
              fmi2Status v;
              return fmi.GetStatus(c, fmi2DoStepStatus, &v);
            },
            [this] { return fmi.GetRealStatus(c, static_cast<fmi2StatusKind>(chance.below(4)), chance.array()); },
            [this] {
              int v;
              return fmi.GetIntegerStatus(c, fmi2Terminated, &v);
            },
            [this] {
              int v;
              return fmi.GetBooleanStatus(c, static_cast<fmi2StatusKind>(chance.below(4)), chance.maybe(&v));
            },
            [this] {
              const char* v;
              return fmi.GetStringStatus(c, fmi2PendingStatus, &v);
            }};
  }
};

}  // namespace

TEST(Misuse, FiveThousandRandomSequencesOfCallsOfFmi2GiveAStatusAndASentence) {
  const Unpacked& fmu = exported(commanded, 2);
  std::size_t good = 0;
  for (const fmi2Type type : {fmi2ModelExchange, fmi2CoSimulation}) {
    Instance2 i(fmu, type);
    Chance chance(1 + type, fmu);
    Calls2 calls{chance, fmu, i};
    const auto all = joined<fmi2Status>({calls.of_life(), calls.of_values(), calls.of_kept_states(),
                                         calls.of_model_exchange(), calls.of_co_simulation()});
    good += play<fmi2Status>(chance, all, 2500, i.heard, [&] {
      calls.t = 0;
      // Half of the sequences begin where something can happen.
      if (i.fmi.Reset(i.c) != fmi2OK || chance.below(2) == 0) return;
      i.fmi.SetupExperiment(i.c, 0, 0, 0, 0, 0);
      i.fmi.EnterInitializationMode(i.c);
      i.fmi.ExitInitializationMode(i.c);
      if (type == fmi2ModelExchange) i.fmi.EnterContinuousTimeMode(i.c);
    });
  }
  EXPECT_GT(good, 10000U);
}

}  // namespace withy::test
