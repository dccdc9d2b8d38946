#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <vector>

#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmi/fmi3.h"
#include "withy/bindings/fmi/resources.hpp"
#include "withy/bindings/fmi/variables.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/output_file.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/fuzz/calls.hpp"

namespace withy::fuzz {
namespace {

/// What an FMU of the scene carries, and what its model description would say.
struct Carried {
  std::string resources, token;
  std::size_t variables = 0, states = 0, indicators = 0;
};

const Carried& carried() {
  static const Carried& made = *[] {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path("/dev/shm") / ("withy-fuzz-" + std::to_string(::getpid())) / "resources";
    fs::create_directories(folder / fmi::scene_folder);
    write_file(folder / fmi::recipe_file, fmi::write_recipe("scene.yaml", {}));
    write_file(folder / fmi::scene_folder / "scene.yaml", called_scene);
    Registry plugins;
    enroll_static_plugins(plugins);
    const study::Prepared prepared = study::prepare(fmi::read_resources(folder.string()), plugins);
    const fmi::Variables variables = fmi::variables_of(prepared, plugins);
    return new Carried{folder.string() + '/', fmi::token_of(prepared, variables), variables.all.size(),
                       variables.states, variables.indicators};
  }();
  return made;
}

int heard = 0;  ///< sentences so far
void hear2(void*, fmi2String, fmi2Status, fmi2String, fmi2String, ...) { ++heard; }
void hear3(void*, fmi3Status, fmi3String, fmi3String) { ++heard; }

/// What calls of both versions take.
struct Arguments {
  explicit Arguments(Choices& c) : choose(c), numbers(64), bytes(4000) {}
  std::vector<std::uint32_t> references() {
    std::vector<std::uint32_t> all(choose.below(4));
    for (auto& r : all)
      r = static_cast<std::uint32_t>(choose.rarely() ? 1000000 * choose.below(256) : choose.below(carried().variables));
    return all;
  }
  double* array() {
    for (std::size_t i = 0; i < 8; ++i) numbers[i] = choose.number();
    return choose.maybe(numbers.data());
  }
  fmi3Byte* data() { return reinterpret_cast<fmi3Byte*>(bytes.data()); }
  /// Of a step of co-simulation.
  double step() {
    return choose.rarely() ? std::min(choose.number(), 0.1) : 0.01 * static_cast<double>(choose.below(4));
  }

  Choices& choose;
  std::vector<double> numbers;
  std::vector<char> bytes;
  std::size_t written = 0;  ///< of a state, into `bytes`
  double t = 0;
};

template <class Status>
void play(Choices& choose, const std::vector<std::function<Status()>>& calls) {
  for (int k = 0; choose.any() && k < 80; ++k) {
    const int before = heard;
    const auto status = static_cast<int>(calls[choose.below(calls.size())]());
    expect(status == 0 || status == 2 || status == 3, "a status that no call may give");
    expect(status == 0 || heard > before, "a bad status without a sentence");
  }
}

std::vector<std::function<fmi2Status()>> calls2(fmi2Component c, Arguments& a, std::array<fmi2FMUstate, 2>& states) {
  Choices& choose = a.choose;
  const std::size_t n = carried().states;
  return {
      [c, &choose] { return fmi2SetupExperiment(c, choose.rarely(), choose.number(), 0.1 * choose.number(), 0, 0); },
      [c] { return fmi2EnterInitializationMode(c); },
      [c] { return fmi2ExitInitializationMode(c); },
      [c] { return fmi2Terminate(c); },
      [c, &a] { return a.t = 0, fmi2Reset(c); },
      [c, &a] {
        const auto r = a.references();
        return fmi2GetReal(c, r.data(), r.size(), a.array());
      },
      [c, &a] {
        const auto r = a.references();
        return fmi2SetReal(c, r.data(), r.size(), a.array());
      },
      [c, &choose, &states] { return fmi2GetFMUstate(c, choose.maybe(&states[choose.below(2)])); },
      [c, &choose, &states] { return fmi2SetFMUstate(c, choose.rarely() ? &states : states[choose.below(2)]); },
      [c, &choose, &states] { return fmi2FreeFMUstate(c, choose.maybe(&states[choose.below(2)])); },
      [c, &a, &choose, &states] {
        fmi2FMUstate state = states[choose.below(2)];
        const fmi2Status sized = fmi2SerializedFMUstateSize(c, state, &a.written);
        return sized != fmi2OK ? sized : fmi2SerializeFMUstate(c, state, a.bytes.data(), a.written);
      },
      [c, &a, &choose, &states] {
        if (choose.rarely()) a.bytes[choose.below(256)] ^= 1;
        fmi2FMUstate& state = states[choose.below(2)];
        fmi2FreeFMUstate(c, &state);
        return fmi2DeSerializeFMUstate(c, a.bytes.data(), a.written, &state);
      },
      [c, &a] {
        const auto u = a.references(), k = a.references();
        return fmi2GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), a.array(),
                                            a.numbers.data() + 32);
      },
      [c] { return fmi2EnterEventMode(c); },
      [c, &choose] {
        fmi2EventInfo info;
        return fmi2NewDiscreteStates(c, choose.maybe(&info));
      },
      [c] { return fmi2EnterContinuousTimeMode(c); },
      [c, &choose] {
        fmi2Boolean event = 0, end = 0;
        return fmi2CompletedIntegratorStep(c, 1, choose.maybe(&event), &end);
      },
      [c, &choose] { return fmi2SetTime(c, choose.number()); },
      [c, &a, &choose, n] { return fmi2SetContinuousStates(c, a.array(), choose.count(n)); },
      [c, &a, &choose, n] { return fmi2GetDerivatives(c, a.array(), choose.count(n)); },
      [c, &a, &choose] { return fmi2GetEventIndicators(c, a.array(), choose.count(carried().indicators)); },
      [c, &a, &choose, n] { return fmi2GetContinuousStates(c, a.array(), choose.count(n)); },
      [c, &a] {
        const double h = a.step();
        const fmi2Status s = fmi2DoStep(c, a.t, h, 1);
        if (s == fmi2OK) a.t += h;
        return s;
      }};
}

/// Those of model exchange.
std::vector<std::function<fmi3Status()>> integrator_calls3(fmi3Instance c, Arguments& a) {
  Choices& choose = a.choose;
  const std::size_t n = carried().states;
  return {[c] { return fmi3EnterEventMode(c); },
          [c, &choose] {
            bool b[5] = {};
            double next = 0;
            return fmi3UpdateDiscreteStates(c, choose.maybe(b), b + 1, b + 2, b + 3, b + 4, choose.maybe(&next));
          },
          [c] { return fmi3EnterContinuousTimeMode(c); },
          [c, &choose] {
            bool event = false, end = false;
            return fmi3CompletedIntegratorStep(c, true, choose.maybe(&event), &end);
          },
          [c, &choose] { return fmi3SetTime(c, choose.number()); },
          [c, &a, &choose, n] { return fmi3SetContinuousStates(c, a.array(), choose.count(n)); },
          [c, &a, &choose, n] { return fmi3GetContinuousStateDerivatives(c, a.array(), choose.count(n)); },
          [c, &a, &choose] { return fmi3GetEventIndicators(c, a.array(), choose.count(carried().indicators)); },
          [c, &a, &choose, n] { return fmi3GetContinuousStates(c, a.array(), choose.count(n)); }};
}

std::vector<std::function<fmi3Status()>> calls3(fmi3Instance c, Arguments& a, std::array<fmi3FMUState, 2>& states) {
  Choices& choose = a.choose;
  std::vector<std::function<fmi3Status()>> all = integrator_calls3(c, a);
  const std::vector<std::function<fmi3Status()>> others{
      [c, &choose] {
        return fmi3EnterInitializationMode(c, choose.rarely(), choose.number(), 0.1 * choose.number(), false, 0);
      },
      [c] { return fmi3ExitInitializationMode(c); },
      [c] { return fmi3Terminate(c); },
      [c, &a] { return a.t = 0, fmi3Reset(c); },
      [c, &a, &choose] {
        const auto r = a.references();
        return fmi3GetFloat64(c, r.data(), r.size(), a.array(), choose.count(r.size()));
      },
      [c, &a, &choose] {
        const auto r = a.references();
        return fmi3SetFloat64(c, r.data(), r.size(), a.array(), choose.count(r.size()));
      },
      [c, &choose, &states] { return fmi3GetFMUState(c, choose.maybe(&states[choose.below(2)])); },
      [c, &choose, &states] { return fmi3SetFMUState(c, choose.rarely() ? &states : states[choose.below(2)]); },
      [c, &choose, &states] { return fmi3FreeFMUState(c, choose.maybe(&states[choose.below(2)])); },
      [c, &a, &choose, &states] {
        fmi3FMUState state = states[choose.below(2)];
        const fmi3Status sized = fmi3SerializedFMUStateSize(c, state, &a.written);
        a.bytes.resize(std::max(a.bytes.size(), a.written));
        return sized != fmi3OK ? sized : fmi3SerializeFMUState(c, state, a.data(), a.written);
      },
      [c, &choose, &a, &states] {
        if (choose.rarely()) a.bytes[choose.below(256)] ^= 1;
        fmi3FMUState& state = states[choose.below(2)];
        fmi3FreeFMUState(c, &state);
        return fmi3DeserializeFMUState(c, a.data(), a.written, &state);
      },
      [c, &a, &choose] {
        const auto u = a.references(), k = a.references();
        return fmi3GetDirectionalDerivative(c, u.data(), u.size(), k.data(), k.size(), a.array(),
                                            choose.count(k.size()), a.numbers.data() + 32, u.size());
      },
      [c, &a, &choose] {
        const auto u = a.references(), k = a.references();
        return fmi3GetAdjointDerivative(c, u.data(), u.size(), k.data(), k.size(), a.array(), choose.count(u.size()),
                                        a.numbers.data() + 32, k.size());
      },
      [c, &a, &choose] {
        bool b[3] = {};
        double last = 0;
        const double h = a.step();
        const fmi3Status s = fmi3DoStep(c, a.t, h, true, b, b + 1, b + 2, choose.maybe(&last));
        if (s == fmi3OK) a.t += h;
        return s;
      }};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

/// Half of the sequences begin where something can happen.
void version2(Choices& choose, bool steps) {
  static const fmi2CallbackFunctions functions{&hear2, nullptr, nullptr, nullptr, nullptr};
  const fmi2Component c =
      fmi2Instantiate("fuzzed", steps ? fmi2CoSimulation : fmi2ModelExchange, carried().token.c_str(),
                      ("file://" + carried().resources).c_str(), &functions, 0, 0);
  expect(c != nullptr, "no instance");
  if (choose.below(2) == 1) {
    fmi2SetupExperiment(c, 0, 0, 0, 0, 0);
    fmi2EnterInitializationMode(c);
    fmi2ExitInitializationMode(c);
  }
  Arguments arguments(choose);
  std::array<fmi2FMUstate, 2> states{};
  play(choose, calls2(c, arguments, states));
  fmi2FreeInstance(c);
}

void version3(Choices& choose, bool steps) {
  const fmi3Instance c =
      steps ? fmi3InstantiateCoSimulation("fuzzed", carried().token.c_str(), carried().resources.c_str(), false, false,
                                          false, true, nullptr, 0, nullptr, &hear3, nullptr)
            : fmi3InstantiateModelExchange("fuzzed", carried().token.c_str(), carried().resources.c_str(), false, false,
                                           nullptr, &hear3);
  expect(c != nullptr, "no instance");
  if (choose.below(2) == 1) {
    fmi3EnterInitializationMode(c, false, 0, 0, false, 0);
    fmi3ExitInitializationMode(c);
  }
  Arguments arguments(choose);
  std::array<fmi3FMUState, 2> states{};
  play(choose, calls3(c, arguments, states));
  fmi3FreeInstance(c);
}

}  // namespace

void call_an_fmu(std::string_view bytes) {
  Choices choose(bytes);
  const std::size_t which = choose.below(4);
  (which < 2 ? version2 : version3)(choose, which % 2 == 1);
}

}  // namespace withy::fuzz
