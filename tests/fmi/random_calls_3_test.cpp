// FMI 3.0: a status and a sentence, never a crash.
#include "withy/tests/fmi/random_calls.hpp"

namespace withy::test {
namespace {

/// All calls of an instance, with arguments by chance.
struct Calls3 {
  Chance& chance;
  const Unpacked& fmu;
  Instance3& instance;
  decltype(instance.fmi)& fmi = instance.fmi;
  fmi3Instance c = instance.c;
  std::size_t n = fmu.states.size();
  double t = 0, d = 0;
  bool b[4] = {};
  std::vector<fmi3FMUState> states = std::vector<fmi3FMUState>(3);
  std::vector<fmi3Byte> bytes = std::vector<fmi3Byte>(4000);

  /// Beginning and end.
  [[nodiscard]] Calls<fmi3Status> of_life() {
    return {[this] { return fmi.EnterInitializationMode(c, chance.below(2) == 0, chance.number(), 0, false, 0); },
            [this] { return fmi.ExitInitializationMode(c); },
            [this] { return fmi.EnterInitializationMode(c, false, 0, chance.number(), true, 0); },
            [this] { return fmi.ExitInitializationMode(c); },
            [this] { return fmi.EnterEventMode(c); },
            [this] { return fmi.Terminate(c); },
            [this] { return fmi.Reset(c); }};
  }

  /// Variables.
  [[nodiscard]] Calls<fmi3Status> of_values() {
    return {[this] {
              auto r = chance.references();
              return fmi.GetFloat64(c, chance.maybe(r.data()), r.size(), chance.array(), chance.count(r.size()));
            },
            [this] {
              auto r = chance.references();
              return fmi.SetFloat64(c, chance.maybe(r.data()), r.size(), chance.array(), chance.count(r.size()));
            },
            [this] {
              const auto r = fmu.of("input");
              return fmi.SetFloat64(c, r.data(), r.size(), chance.array(), r.size());
            },
            [this] {
              auto r = chance.references();
              return fmi.GetBoolean(c, r.data(), std::min<std::size_t>(r.size(), 1), b, 1);
            },
            [this] {
              auto r = chance.references();
              float v = 0;
              return fmi.SetFloat32(c, r.data(), std::min<std::size_t>(r.size(), 1), &v, 1);
            },
            [this] {
              auto r = chance.references();
              return fmi.GetClock(c, r.data(), std::min<std::size_t>(r.size(), 1), b);
            },
            [this] {
              std::size_t size = 0;
              return fmi.GetNumberOfVariableDependencies(c, 1, &size);
            },
            [this] {
              int order = 1;
              return fmi.GetOutputDerivatives(c, nullptr, 0, &order, chance.array(), 0);
            }};
  }

  /// States that are kept, and derivatives at them.
  [[nodiscard]] Calls<fmi3Status> of_kept_states() {
    return {[this] { return fmi.GetFMUState(c, chance.maybe(&states[chance.below(3)])); },
            [this] { return fmi.SetFMUState(c, chance.rarely() ? &states : states[chance.below(3)]); },
            [this] { return fmi.FreeFMUState(c, chance.maybe(&states[chance.below(3)])); },
            [this] {
              std::size_t size = 0;
              return fmi.SerializedFMUStateSize(c, states[chance.below(3)], &size);
            },
            [this] {
              return fmi.SerializeFMUState(c, states[chance.below(3)], bytes.data(), chance.count(bytes.size() - 1));
            },
            [this] {
              fmi3FMUState made = nullptr;
              const fmi3Status s = fmi.DeserializeFMUState(c, bytes.data(), chance.below(bytes.size()), &made);
              if (made != nullptr) fmi.FreeFMUState(c, &made);
              return s;
            },
            [this] {
              auto u = chance.references(), k = chance.references();
              return fmi.GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), chance.array(),
                                                  chance.count(k.size()), chance.more(), u.size());
            },
            [this] {
              auto u = chance.references(), k = chance.references();
              return fmi.GetAdjointDerivative(c, u.data(), u.size(), k.data(), k.size(), chance.array(),
                                              chance.count(u.size()), chance.more(), k.size());
            }};
  }

  /// Events and continuous states.
  [[nodiscard]] Calls<fmi3Status> of_model_exchange() {
    return {[this] { return fmi.EnterConfigurationMode(c); },
            [this] { return fmi.GetIntervalDecimal(c, nullptr, 0, nullptr, nullptr); },
            [this] { return fmi.EvaluateDiscreteStates(c); },
            [this] { return fmi.UpdateDiscreteStates(c, &b[0], &b[1], &b[2], chance.maybe(&b[3]), &b[0], &d); },
            [this] { return fmi.EnterContinuousTimeMode(c); },
            [this] { return fmi.CompletedIntegratorStep(c, true, chance.maybe(&b[0]), &b[1]); },
            [this] { return fmi.SetTime(c, chance.number()); },
            [this] { return fmi.SetContinuousStates(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetContinuousStateDerivatives(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetEventIndicators(c, chance.array(), chance.count(0)); },
            [this] { return fmi.GetContinuousStates(c, chance.array(), chance.count(n)); },
            [this] { return fmi.GetNominalsOfContinuousStates(c, chance.array(), chance.count(n)); },
            [this] {
              std::size_t size = 0;
              return fmi.GetNumberOfContinuousStates(c, chance.maybe(&size));
            }};
  }

  /// Steps and clocks.
  [[nodiscard]] Calls<fmi3Status> of_co_simulation() {
    return {[this] { return fmi.EnterStepMode(c); },
            [this] {
              const double h = chance.step();
              const fmi3Status s = fmi.DoStep(c, t, h, true, &b[0], &b[1], &b[2], chance.maybe(&d));
              if (s == fmi3OK) t += h;
              return s;
            },
            [this] { return fmi.ActivateModelPartition(c, 0, 0); }};
  }
};

}  // namespace

TEST(Misuse, FiveThousandRandomSequencesOfCallsOfFmi3GiveAStatusAndASentence) {
  const Unpacked& fmu = exported(commanded, 3);
  std::size_t good = 0;
  for (const bool stepped : {false, true}) {
    Instance3 i(fmu, stepped);
    Chance chance(stepped ? 3 : 4, fmu);
    Calls3 calls{chance, fmu, i};
    const auto all = joined<fmi3Status>({calls.of_life(), calls.of_values(), calls.of_kept_states(),
                                         calls.of_model_exchange(), calls.of_co_simulation()});
    good += play<fmi3Status>(chance, all, 2500, i.heard, [&] {
      calls.t = 0;
      if (i.fmi.Reset(i.c) != fmi3OK || chance.below(2) == 0) return;
      i.fmi.EnterInitializationMode(i.c, false, 0, 0, false, 0);
      i.fmi.ExitInitializationMode(i.c);
      if (!stepped) i.fmi.EnterContinuousTimeMode(i.c);
    });
  }
  EXPECT_GT(good, 10000U);
}

}  // namespace withy::test
