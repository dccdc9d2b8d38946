/// \file
/// FMI 3.0 on instances: their life, modes, values, states and steps. What they have not is in fmi3_absent.cpp.
#include <algorithm>
#include <cmath>

#include "withy/bindings/fmi/fmi3_call.hpp"
#include "withy/bindings/fmi/resources.hpp"

namespace {

using namespace withy::fmi;  // NOLINT(google-build-using-namespace): the interface to this very namespace
using In = Allowed::In;

constexpr unsigned evaluated = Mode::initialization | Mode::event | Mode::continuous | Mode::step | Mode::terminated;

Instance3* instantiate(const char* function, Kind kind, const char* name, const char* token, const char* resources,
                       bool on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback write,
                       const std::function<void()>& check_first) {
  Log log;
  return static_cast<Instance3*>(made(log, function, [&]() -> Instance* {
    log.on = on;
    if (write != nullptr)
      log.write = [write, environment](Status s, const char* category, const char* message) {
        write(environment, status3(s), category, message);
      };
    need(name != nullptr && *name != '\0', "need a name of the instance");
    need(token != nullptr && resources != nullptr, "need the instantiation token and the path of the resources");
    check_first();
    return new Instance3(kind, name, token, folder_of(resources), log);
  }));
}

}  // namespace

const char* fmi3GetVersion() { return "3.0"; }

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean /*visible*/, fmi3Boolean on, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
  return static_cast<Instance*>(instantiate("fmi3InstantiateModelExchange", Kind::model_exchange, name, token,
                                            resources, on, environment, log, [] {}));
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean /*visible*/, fmi3Boolean on, fmi3Boolean events,
                                         fmi3Boolean early_return, const fmi3ValueReference /*required*/[],
                                         size_t /*nRequired*/, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
  Instance3* made =
      instantiate("fmi3InstantiateCoSimulation", Kind::co_simulation, name, token, resources, on, environment, log,
                  [&] { need(!events, "there is no event mode in co-simulation: hasEventMode is false"); });
  if (made == nullptr) return nullptr;
  made->update = update;
  made->environment = environment;
  made->early_return = early_return;
  return static_cast<Instance*>(made);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String /*name*/, fmi3String /*token*/, fmi3String /*resources*/,
                                               fmi3Boolean /*visible*/, fmi3Boolean /*on*/,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback /*clockUpdate*/,
                                               fmi3LockPreemptionCallback /*lock*/,
                                               fmi3UnlockPreemptionCallback /*unlock*/) {
  if (log != nullptr)
    log(environment, fmi3Error, log_errors, "fmi3InstantiateScheduledExecution: the FMU has no scheduled execution");
  return nullptr;
}

void fmi3FreeInstance(fmi3Instance c) {
  Instance* instance = instance_of(c);
  // Its step is under way: the host frees it from inside its own callback.
  if (instance != nullptr && !instance->is_in(static_cast<unsigned>(Mode::intermediate))) delete instance;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
  return call3(c, "fmi3SetDebugLogging", any_mode, In::both,
               [&](Instance3& i) { set_logging(i, on, count, categories); });
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerated, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean stops, fmi3Float64 stop) {
  return call3(c, "fmi3EnterInitializationMode", static_cast<unsigned>(Mode::instantiated), In::both,
               [&](Instance3& i) {
                 i.set_experiment(tolerated ? std::optional(tolerance) : std::nullopt, start,
                                  stops ? std::optional(stop) : std::nullopt);
                 i.enter_initialization();
               });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  return call3(c, "fmi3ExitInitializationMode", static_cast<unsigned>(Mode::initialization), In::both,
               [](Instance3& i) { i.exit_initialization(); });
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
  return call3(c, "fmi3EnterEventMode", static_cast<unsigned>(Mode::continuous), In::model_exchange, [](Instance3& i) {
    i.check_stop(i.dynamics().time());
    i.enter(Mode::event);
  });
}

fmi3Status fmi3Terminate(fmi3Instance c) {
  return call3(c, "fmi3Terminate", Mode::event | Mode::continuous | Mode::step, In::both,
               [](Instance3& i) { i.enter(Mode::terminated); });
}

fmi3Status fmi3Reset(fmi3Instance c) {
  return call3(c, "fmi3Reset", settled, In::both, [](Instance3& i) { i.reset(); });
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Float64 values[], size_t nv) {
  return call3(c, "fmi3GetFloat64", any_mode, In::both, [&](Instance3& i) {
    need(nvr == nv && (nvr == 0 || values != nullptr), "need as many values as value references");
    i.get(references(vr, nvr), values);
  });
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Float64 values[],
                          size_t nv) {
  return call3(c, "fmi3SetFloat64", any_mode, In::both, [&](Instance3& i) {
    need(nvr == nv && (nvr == 0 || values != nullptr), "need as many values as value references");
    i.set(references(vr, nvr), values);
  });
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call3(c, "fmi3GetFMUState", settled, In::both, [&](Instance3& i) { save_at(i, state); });
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
  return call3(c, "fmi3SetFMUState", settled, In::both,
               [&](Instance3& i) { i.restore(static_cast<const SavedState*>(state)); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call3(c, "fmi3FreeFMUState", settled, In::both, [&](Instance3& i) { forget_at(i, state); });
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t* size) {
  return call3(c, "fmi3SerializedFMUStateSize", settled, In::both, [&](Instance3& i) {
    need(size != nullptr, "need a place for the size");
    *size = i.serialize(static_cast<const SavedState*>(state)).size();
  });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  return call3(c, "fmi3SerializeFMUState", settled, In::both,
               [&](Instance3& i) { write_bytes(i, state, bytes, size, "fmi3SerializedFMUStateSize"); });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
  return call3(c, "fmi3DeserializeFMUState", settled, In::both, [&](Instance3& i) {
    need(bytes != nullptr && state != nullptr, "need the bytes and a place for the state");
    *state = i.deserialize({bytes, size});
  });
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                        const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                        size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities) {
  return call3(c, "fmi3GetDirectionalDerivative", evaluated, In::both, [&](Instance3& i) {
    need(seeds == knowns && sensitivities == unknowns, "need a seed for each known, a sensitivity for each unknown");
    need((seeds == 0 || seed != nullptr) && (sensitivities == 0 || sensitivity != nullptr), "need two arrays");
    i.directional(references(unknown, unknowns), references(known, knowns), seed, sensitivity);
  });
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                    const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                    size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities) {
  return call3(c, "fmi3GetAdjointDerivative", evaluated, In::both, [&](Instance3& i) {
    need(seeds == unknowns && sensitivities == knowns, "need a seed for each unknown, a sensitivity for each known");
    need((seeds == 0 || seed != nullptr) && (sensitivities == 0 || sensitivity != nullptr), "need two arrays");
    i.adjoint(references(unknown, unknowns), references(known, knowns), seed, sensitivity);
  });
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
  return call3(c, "fmi3EvaluateDiscreteStates", Mode::initialization | Mode::event, In::model_exchange,
               [](Instance3&) {});
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean* again, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* values_changed, fmi3Boolean* defined,
                                    fmi3Float64* next) {
  return call3(c, "fmi3UpdateDiscreteStates", static_cast<unsigned>(Mode::event), In::model_exchange,
               [&](Instance3& i) {
                 need(again != nullptr && terminate != nullptr && nominals_changed != nullptr &&
                          values_changed != nullptr && defined != nullptr && next != nullptr,
                      "need places for all answers");
                 const EventUpdate update = i.dynamics().update_discrete();
                 *again = update.again;
                 *terminate = update.terminate;
                 *nominals_changed = *values_changed = false;
                 *defined = std::isfinite(update.next);
                 *next = update.next;
               });
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) {
  return call3(c, "fmi3EnterContinuousTimeMode", static_cast<unsigned>(Mode::event), In::model_exchange,
               [](Instance3& i) { i.enter(Mode::continuous); });
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean /*noSetFMUStatePriorToCurrentPoint*/,
                                       fmi3Boolean* event, fmi3Boolean* terminate) {
  return call3(c, "fmi3CompletedIntegratorStep", static_cast<unsigned>(Mode::continuous), In::model_exchange,
               [&](Instance3& i) {
                 need(event != nullptr && terminate != nullptr, "need places for both answers");
                 i.check_stop(i.dynamics().time());
                 *event = *terminate = false;
               });
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
  return call3(c, "fmi3SetTime", Mode::event | Mode::continuous, In::model_exchange, [&](Instance3& i) {
    need(std::isfinite(time), "need a finite time");
    if (i.is_in(static_cast<unsigned>(Mode::event))) i.check_stop(time);  // integrators may look beyond
    i.dynamics().set_time(time);
  });
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t nx) {
  return call3(c, "fmi3SetContinuousStates", static_cast<unsigned>(Mode::continuous), In::model_exchange,
               [&](Instance3& i) {
                 i.set_continuous({x, nx});
               });
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t nx) {
  return call3(c, "fmi3GetContinuousStateDerivatives", evaluated, In::model_exchange,
               [&](Instance3& i) { i.give(i.dynamics().derivatives(), derivatives, nx); });
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t ni) {
  return call3(c, "fmi3GetEventIndicators", evaluated, In::model_exchange,
               [&](Instance3& i) { i.give_indicators(indicators, ni); });
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t nx) {
  return call3(c, "fmi3GetContinuousStates", evaluated, In::model_exchange,
               [&](Instance3& i) { i.give(i.dynamics().moving(), x, nx); });
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nx) {
  return call3(c, "fmi3GetNominalsOfContinuousStates", evaluated, In::model_exchange,
               [&](Instance3& i) { i.give(std::vector<double>(i.variables().states, 1.0), nominals, nx); });
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t* count) {
  return call3(c, "fmi3GetNumberOfEventIndicators", settled, In::model_exchange, [&](Instance3& i) {
    need(count != nullptr, "need a place for the count");
    *count = i.dynamics().indicators();
  });
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t* count) {
  return call3(c, "fmi3GetNumberOfContinuousStates", settled, In::model_exchange, [&](Instance3& i) {
    need(count != nullptr, "need a place for the count");
    *count = i.variables().states;
  });
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 length, fmi3Boolean /*noSetFMUStatePrior*/,
                      fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* last) {
  return status3(guarded(c, "fmi3DoStep", {static_cast<unsigned>(Mode::step), In::co_simulation}, [&](Instance& base) {
    auto& i = static_cast<Instance3&>(base);
    need(event != nullptr && terminate != nullptr && early != nullptr && last != nullptr,
         "need places for all answers");
    need(length > 0, "a step is longer than 0 s");
    BetweenSteps between;
    if (i.update != nullptr)
      between = [&i](double time) -> std::optional<double> {
        fmi3Boolean requested = false;
        fmi3Float64 when = time;
        i.update(i.environment, time, false, true, true, i.early_return, &requested, &when);
        return requested && i.early_return ? std::optional(when) : std::nullopt;
      };
    const StepEnd end = i.step(from, length, between);
    *event = false;
    *terminate = end.terminate;
    *early = !end.reached && !end.terminate;
    *last = i.dynamics().time();
    if (end.terminate && !end.failed) i.say(Status::ok, log_events, "fmi3DoStep: " + end.reason);
    if (!end.failed) return Status::ok;
    i.say(Status::discard, log_discards, "fmi3DoStep: " + end.reason);
    return Status::discard;
  }));
}
