// Calls by chance, in and out of order, with good and bad arguments: a status and a sentence, never a crash.
#include <functional>
#include <random>

#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

/// Arguments that are right, wrong and missing, by chance.
class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  bool rarely() { return random_() % 12 == 0; }
  std::size_t below(std::size_t n) { return random_() % n; }
  double number() {
    constexpr double some[] = {0, 0.1, -0.3, 1, 2.5, 1e-3};
    return rarely() ? (below(2) == 0 ? std::nan("") : 1e300) : some[below(std::size(some))];
  }
  template <class T>
  T* maybe(T* pointer) {
    return rarely() ? nullptr : pointer;
  }
  std::vector<std::uint32_t> references(std::size_t variables) {
    std::vector<std::uint32_t> all(below(4));
    for (auto& r : all) r = static_cast<std::uint32_t>(rarely() ? random_() : below(variables));
    return all;
  }

 private:
  std::mt19937 random_;
};

/// \returns how many calls were in order
template <class Status>
std::size_t play(Chance& chance, const std::vector<std::function<Status()>>& calls, std::size_t sequences,
                 const Heard& heard, const std::function<void()>& begin) {
  std::size_t good = 0;
  for (std::size_t s = 0; s < sequences; ++s) {
    begin();
    for (int k = 0; k < 12; ++k) {
      const int lines = heard.lines;
      const auto status = static_cast<int>(calls[chance.below(calls.size())]());
      EXPECT_TRUE(status == 0 || status == 2 || status == 3) << status;
      EXPECT_TRUE(status == 0 || heard.lines > lines) << "an error without a sentence";
      good += status == 0 ? 1 : 0;
    }
  }
  return good;
}

}  // namespace

TEST(Misuse, FiveThousandRandomSequencesOfCallsOfFmi2GiveAStatusAndASentence) {
  const Unpacked& fmu = exported(commanded, 2);
  const std::size_t n = fmu.states.size(), all = fmu.variables.size();
  std::size_t good = 0;
  for (const fmi2Type type : {fmi2ModelExchange, fmi2CoSimulation}) {
    Instance2 i(fmu, type);
    Chance chance(1 + type);
    double t = 0;
    std::vector<double> numbers(64);
    std::vector<fmi2FMUstate> states(3);
    std::vector<char> bytes(4000);
    const auto vr = [&] { return chance.references(all); };
    const auto array = [&] {
      for (double& x : numbers) x = chance.number();
      return chance.maybe(numbers.data());
    };
    const auto count = [&](std::size_t right) { return chance.rarely() ? right + 1 : right; };
    auto& f = i.fmi;
    fmi2Component c = i.c;
    std::vector<std::function<fmi2Status()>> calls{
        [&] { return f.SetupExperiment(c, chance.below(2) == 0, chance.number(), chance.number(), 0, 0); },
        [&] { return f.EnterInitializationMode(c); },
        [&] { return f.ExitInitializationMode(c); },
        [&] { return f.EnterInitializationMode(c); },
        [&] { return f.ExitInitializationMode(c); },
        [&] { return f.Terminate(c); },
        [&] { return f.Reset(c); },
        [&] {
          auto r = vr();
          return f.GetReal(c, chance.maybe(r.data()), r.size(), array());
        },
        [&] {
          auto r = vr();
          return f.SetReal(c, chance.maybe(r.data()), r.size(), array());
        },
        [&] {
          const auto r = fmu.of("input");
          return f.SetReal(c, r.data(), r.size(), array());
        },
        [&] {
          auto r = vr();
          int v = 0;
          return f.GetInteger(c, r.data(), std::min<std::size_t>(r.size(), 1), &v);
        },
        [&] {
          auto r = vr();
          const char* v = "";
          return f.SetString(c, r.data(), std::min<std::size_t>(r.size(), 1), &v);
        },
        [&] { return f.GetFMUstate(c, chance.maybe(&states[chance.below(3)])); },
        [&] { return f.SetFMUstate(c, chance.rarely() ? &states : states[chance.below(3)]); },
        [&] { return f.FreeFMUstate(c, chance.maybe(&states[chance.below(3)])); },
        [&] {
          std::size_t size = 0;
          return f.SerializedFMUstateSize(c, states[chance.below(3)], &size);
        },
        [&] { return f.SerializeFMUstate(c, states[chance.below(3)], bytes.data(), count(bytes.size() - 1)); },
        [&] {
          fmi2FMUstate made = nullptr;
          const fmi2Status s = f.DeSerializeFMUstate(c, bytes.data(), chance.below(bytes.size()), &made);
          if (made != nullptr) f.FreeFMUstate(c, &made);
          return s;
        },
        [&] {
          auto u = vr(), k = vr();
          return f.GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), array(), numbers.data() + 32);
        },
        [&] { return f.EnterEventMode(c); },
        [&] {
          fmi2EventInfo info;
          return f.NewDiscreteStates(c, chance.maybe(&info));
        },
        [&] { return f.EnterContinuousTimeMode(c); },
        [&] {
          fmi2Boolean a = 0, b = 0;
          return f.CompletedIntegratorStep(c, 1, chance.maybe(&a), &b);
        },
        [&] { return f.SetTime(c, t = chance.number()); },
        [&] { return f.SetContinuousStates(c, array(), count(n)); },
        [&] { return f.GetDerivatives(c, array(), count(n)); },
        [&] { return f.GetEventIndicators(c, array(), count(0)); },
        [&] { return f.GetContinuousStates(c, array(), count(n)); },
        [&] { return f.GetNominalsOfContinuousStates(c, array(), count(n)); },
        [&] {
          int order = 1;
          auto r = vr();
          return f.SetRealInputDerivatives(c, r.data(), 1, &order, array());
        },
        [&] {
          int order = 1;
          auto r = vr();
          return f.GetRealOutputDerivatives(c, r.data(), 1, &order, array());
        },
        [&] {
          const double h = chance.rarely() ? chance.number() : 0.01;
          const fmi2Status s = f.DoStep(c, t, h, 1);
          if (s == fmi2OK) t += h;
          return s;
        },
        [&] { return f.CancelStep(c); },
        [&] {
          fmi2Status v;
          return f.GetStatus(c, fmi2DoStepStatus, &v);
        },
        [&] { return f.GetRealStatus(c, static_cast<fmi2StatusKind>(chance.below(4)), array()); },
        [&] {
          int v;
          return f.GetIntegerStatus(c, fmi2Terminated, &v);
        },
        [&] {
          int v;
          return f.GetBooleanStatus(c, static_cast<fmi2StatusKind>(chance.below(4)), chance.maybe(&v));
        },
        [&] {
          const char* v;
          return f.GetStringStatus(c, fmi2PendingStatus, &v);
        },
        [&] {
          const char* category = "logAll";
          return f.SetDebugLogging(c, chance.below(2) == 0, 1, chance.maybe(&category));
        }};
    good += play<fmi2Status>(chance, calls, 2500, i.heard, [&] {
      t = 0;
      // Half of the sequences begin where something can happen.
      if (f.Reset(c) != fmi2OK || chance.below(2) == 0) return;
      f.SetupExperiment(c, 0, 0, 0, 0, 0);
      f.EnterInitializationMode(c);
      f.ExitInitializationMode(c);
      if (type == fmi2ModelExchange) f.EnterContinuousTimeMode(c);
    });
  }
  EXPECT_GT(good, 10000U);
}

TEST(Misuse, FiveThousandRandomSequencesOfCallsOfFmi3GiveAStatusAndASentence) {
  const Unpacked& fmu = exported(commanded, 3);
  const std::size_t n = fmu.states.size(), all = fmu.variables.size();
  std::size_t good = 0;
  for (const bool stepped : {false, true}) {
    Instance3 i(fmu, stepped);
    Chance chance(stepped ? 3 : 4);
    double t = 0;
    std::vector<double> numbers(64);
    std::vector<fmi3FMUState> states(3);
    std::vector<fmi3Byte> bytes(4000);
    bool b[4] = {};
    double d = 0;
    const auto vr = [&] { return chance.references(all); };
    const auto array = [&] {
      for (double& x : numbers) x = chance.number();
      return chance.maybe(numbers.data());
    };
    const auto count = [&](std::size_t right) { return chance.rarely() ? right + 1 : right; };
    auto& f = i.fmi;
    fmi3Instance c = i.c;
    std::vector<std::function<fmi3Status()>> calls{
        [&] { return f.EnterInitializationMode(c, chance.below(2) == 0, chance.number(), 0, false, 0); },
        [&] { return f.ExitInitializationMode(c); },
        [&] { return f.EnterInitializationMode(c, false, 0, chance.number(), true, 0); },
        [&] { return f.ExitInitializationMode(c); },
        [&] { return f.EnterEventMode(c); },
        [&] { return f.Terminate(c); },
        [&] { return f.Reset(c); },
        [&] {
          auto r = vr();
          return f.GetFloat64(c, chance.maybe(r.data()), r.size(), array(), count(r.size()));
        },
        [&] {
          auto r = vr();
          return f.SetFloat64(c, chance.maybe(r.data()), r.size(), array(), count(r.size()));
        },
        [&] {
          const auto r = fmu.of("input");
          return f.SetFloat64(c, r.data(), r.size(), array(), r.size());
        },
        [&] {
          auto r = vr();
          return f.GetBoolean(c, r.data(), std::min<std::size_t>(r.size(), 1), b, 1);
        },
        [&] {
          auto r = vr();
          float v = 0;
          return f.SetFloat32(c, r.data(), std::min<std::size_t>(r.size(), 1), &v, 1);
        },
        [&] {
          auto r = vr();
          return f.GetClock(c, r.data(), std::min<std::size_t>(r.size(), 1), b);
        },
        [&] {
          std::size_t size = 0;
          return f.GetNumberOfVariableDependencies(c, 1, &size);
        },
        [&] { return f.GetFMUState(c, chance.maybe(&states[chance.below(3)])); },
        [&] { return f.SetFMUState(c, chance.rarely() ? &states : states[chance.below(3)]); },
        [&] { return f.FreeFMUState(c, chance.maybe(&states[chance.below(3)])); },
        [&] {
          std::size_t size = 0;
          return f.SerializedFMUStateSize(c, states[chance.below(3)], &size);
        },
        [&] { return f.SerializeFMUState(c, states[chance.below(3)], bytes.data(), count(bytes.size() - 1)); },
        [&] {
          fmi3FMUState made = nullptr;
          const fmi3Status s = f.DeserializeFMUState(c, bytes.data(), chance.below(bytes.size()), &made);
          if (made != nullptr) f.FreeFMUState(c, &made);
          return s;
        },
        [&] {
          auto u = vr(), k = vr();
          return f.GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), array(), count(k.size()),
                                            numbers.data() + 32, u.size());
        },
        [&] {
          auto u = vr(), k = vr();
          return f.GetAdjointDerivative(c, u.data(), u.size(), k.data(), k.size(), array(), count(u.size()),
                                        numbers.data() + 32, k.size());
        },
        [&] { return f.EnterConfigurationMode(c); },
        [&] { return f.GetIntervalDecimal(c, nullptr, 0, nullptr, nullptr); },
        [&] { return f.EvaluateDiscreteStates(c); },
        [&] { return f.UpdateDiscreteStates(c, &b[0], &b[1], &b[2], chance.maybe(&b[3]), &b[0], &d); },
        [&] { return f.EnterContinuousTimeMode(c); },
        [&] { return f.CompletedIntegratorStep(c, true, chance.maybe(&b[0]), &b[1]); },
        [&] { return f.SetTime(c, chance.number()); },
        [&] { return f.SetContinuousStates(c, array(), count(n)); },
        [&] { return f.GetContinuousStateDerivatives(c, array(), count(n)); },
        [&] { return f.GetEventIndicators(c, array(), count(0)); },
        [&] { return f.GetContinuousStates(c, array(), count(n)); },
        [&] { return f.GetNominalsOfContinuousStates(c, array(), count(n)); },
        [&] {
          std::size_t size = 0;
          return f.GetNumberOfContinuousStates(c, chance.maybe(&size));
        },
        [&] { return f.EnterStepMode(c); },
        [&] {
          int order = 1;
          return f.GetOutputDerivatives(c, nullptr, 0, &order, array(), 0);
        },
        [&] {
          const double h = chance.rarely() ? chance.number() : 0.01;
          const fmi3Status s = f.DoStep(c, t, h, true, &b[0], &b[1], &b[2], chance.maybe(&d));
          if (s == fmi3OK) t += h;
          return s;
        },
        [&] { return f.ActivateModelPartition(c, 0, 0); }};
    good += play<fmi3Status>(chance, calls, 2500, i.heard, [&] {
      t = 0;
      if (f.Reset(c) != fmi3OK || chance.below(2) == 0) return;
      f.EnterInitializationMode(c, false, 0, 0, false, 0);
      f.ExitInitializationMode(c);
      if (!stepped) f.EnterContinuousTimeMode(c);
    });
  }
  EXPECT_GT(good, 10000U);
}

}  // namespace withy::test
