/// \file
/// FMI 3.0 on instances.
#include "withy/bindings/fmi/fmi3.h"

#include <algorithm>
#include <cmath>

#include "withy/bindings/fmi/guarded.hpp"
#include "withy/bindings/fmi/resources.hpp"

namespace {

using namespace withy::fmi;  // NOLINT(google-build-using-namespace): the interface to this very namespace
using In = Allowed::In;

/// An instance, and what the version keeps beside it.
class Instance3 : public Instance {
 public:
  using Instance::Instance;
  fmi3IntermediateUpdateCallback update = nullptr;
  fmi3InstanceEnvironment environment = nullptr;
  bool early_return = false;
};

static_assert(fmi3OK == static_cast<int>(Status::ok) && fmi3Fatal == static_cast<int>(Status::fatal));
fmi3Status status(Status s) { return static_cast<fmi3Status>(s); }

constexpr unsigned settled =
    Mode::instantiated | Mode::initialization | Mode::event | Mode::continuous | Mode::step | Mode::terminated;
constexpr unsigned any = settled | Mode::intermediate;
constexpr unsigned evaluated = Mode::initialization | Mode::event | Mode::continuous | Mode::step | Mode::terminated;

template <class Act>
fmi3Status call(fmi3Instance c, const char* function, unsigned modes, In kinds, Act&& act) {
  return status(guarded(c, function, {modes, kinds}, [&](Instance& i) {
    act(static_cast<Instance3&>(i));
    return Status::ok;
  }));
}

/// For functions of which the model description says that they cannot be.
fmi3Status incapable(fmi3Instance c, const char* function, const char* why) {
  return call(c, function, any, In::both, [&](Instance3&) { throw std::invalid_argument(why); });
}

Instance3* instantiate(const char* function, Kind kind, const char* name, const char* token, const char* resources,
                       bool on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback write,
                       const std::function<void()>& check_first) {
  Log log;
  return static_cast<Instance3*>(made(log, function, [&]() -> Instance* {
    log.on = on;
    if (write != nullptr)
      log.write = [write, environment](Status s, const char* category, const char* message) {
        write(environment, status(s), category, message);
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
  return call(c, "fmi3SetDebugLogging", any, In::both, [&](Instance3& i) {
    need(count == 0 || categories != nullptr, "need the names of categories");
    std::set<std::string> wanted;
    for (size_t k = 0; k < count; ++k) {
      need(categories[k] != nullptr, "need the names of categories");
      wanted.insert(categories[k]);
    }
    i.log().on = on;
    i.log().categories = std::move(wanted);
  });
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerated, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean /*stopTimeDefined*/, fmi3Float64 /*stopTime*/) {
  return call(c, "fmi3EnterInitializationMode", static_cast<unsigned>(Mode::instantiated), In::both, [&](Instance3& i) {
    i.set_experiment(tolerated ? std::optional(tolerance) : std::nullopt, start);
    i.enter_initialization();
  });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  return call(c, "fmi3ExitInitializationMode", static_cast<unsigned>(Mode::initialization), In::both,
              [](Instance3& i) { i.exit_initialization(); });
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
  return call(c, "fmi3EnterEventMode", static_cast<unsigned>(Mode::continuous), In::model_exchange,
              [](Instance3& i) { i.enter(Mode::event); });
}

fmi3Status fmi3Terminate(fmi3Instance c) {
  return call(c, "fmi3Terminate", Mode::event | Mode::continuous | Mode::step, In::both,
              [](Instance3& i) { i.enter(Mode::terminated); });
}

fmi3Status fmi3Reset(fmi3Instance c) {
  return call(c, "fmi3Reset", settled, In::both, [](Instance3& i) { i.reset(); });
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Float64 values[], size_t nv) {
  return call(c, "fmi3GetFloat64", any, In::both, [&](Instance3& i) {
    need(nvr == nv && (nvr == 0 || values != nullptr), "need as many values as value references");
    i.get(references(vr, nvr), values);
  });
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Float64 values[],
                          size_t nv) {
  return call(c, "fmi3SetFloat64", any, In::both, [&](Instance3& i) {
    need(nvr == nv && (nvr == 0 || values != nullptr), "need as many values as value references");
    i.set(references(vr, nvr), values);
  });
}

#define WITHY_FMI3_NONE(T)                                                                                          \
  fmi3Status fmi3Get##T(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##T /*v*/[], size_t) {       \
    return call(c, "fmi3Get" #T, any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, #T); });                    \
  }                                                                                                                 \
  fmi3Status fmi3Set##T(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3##T /*v*/[], size_t) { \
    return call(c, "fmi3Set" #T, any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, #T); });                    \
  }
WITHY_FMI3_NONE(Float32)
WITHY_FMI3_NONE(Int8)
WITHY_FMI3_NONE(UInt8)
WITHY_FMI3_NONE(Int16)
WITHY_FMI3_NONE(UInt16)
WITHY_FMI3_NONE(Int32)
WITHY_FMI3_NONE(UInt32)
WITHY_FMI3_NONE(Int64)
WITHY_FMI3_NONE(UInt64)
WITHY_FMI3_NONE(Boolean)
WITHY_FMI3_NONE(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, size_t[], fmi3Binary[], size_t) {
  return call(c, "fmi3GetBinary", any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Binary"); });
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t[], const fmi3Binary[],
                         size_t) {
  return call(c, "fmi3SetBinary", any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Binary"); });
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Clock[]) {
  return call(c, "fmi3GetClock", any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Clock"); });
}
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Clock[]) {
  return call(c, "fmi3SetClock", any, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Clock"); });
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference, size_t*) {
  return incapable(c, "fmi3GetNumberOfVariableDependencies", "no variable is an array");
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference, size_t[], fmi3ValueReference[], size_t[],
                                       fmi3DependencyKind[], size_t) {
  return incapable(c, "fmi3GetVariableDependencies", "no variable is an array");
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call(c, "fmi3GetFMUState", settled, In::both, [&](Instance3& i) {
    need(state != nullptr, "need a place for the state");
    SavedState* saved = i.save();
    if (*state != nullptr) i.forget_if_own(static_cast<const SavedState*>(*state));
    *state = saved;
  });
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
  return call(c, "fmi3SetFMUState", settled, In::both,
              [&](Instance3& i) { i.restore(static_cast<const SavedState*>(state)); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call(c, "fmi3FreeFMUState", settled, In::both, [&](Instance3& i) {
    if (state == nullptr || *state == nullptr) return;
    i.forget(static_cast<const SavedState*>(*state));
    *state = nullptr;
  });
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t* size) {
  return call(c, "fmi3SerializedFMUStateSize", settled, In::both, [&](Instance3& i) {
    need(size != nullptr, "need a place for the size");
    *size = i.serialize(static_cast<const SavedState*>(state)).size();
  });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  return call(c, "fmi3SerializeFMUState", settled, In::both, [&](Instance3& i) {
    const auto found = i.serialize(static_cast<const SavedState*>(state));
    need(bytes != nullptr && size >= found.size(), "need an array as long as fmi3SerializedFMUStateSize says");
    std::copy(found.begin(), found.end(), bytes);
  });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
  return call(c, "fmi3DeserializeFMUState", settled, In::both, [&](Instance3& i) {
    need(bytes != nullptr && state != nullptr, "need the bytes and a place for the state");
    *state = i.deserialize({bytes, size});
  });
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                        const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                        size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities) {
  return call(c, "fmi3GetDirectionalDerivative", evaluated, In::both, [&](Instance3& i) {
    need(seeds == knowns && sensitivities == unknowns, "need a seed for each known, a sensitivity for each unknown");
    need((seeds == 0 || seed != nullptr) && (sensitivities == 0 || sensitivity != nullptr), "need two arrays");
    i.directional(references(unknown, unknowns), references(known, knowns), seed, sensitivity);
  });
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                    const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                    size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities) {
  return call(c, "fmi3GetAdjointDerivative", evaluated, In::both, [&](Instance3& i) {
    need(seeds == unknowns && sensitivities == knowns, "need a seed for each unknown, a sensitivity for each known");
    need((seeds == 0 || seed != nullptr) && (sensitivities == 0 || sensitivity != nullptr), "need two arrays");
    i.adjoint(references(unknown, unknowns), references(known, knowns), seed, sensitivity);
  });
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
  return incapable(c, "fmi3EnterConfigurationMode", "there is no structural parameter");
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
  return incapable(c, "fmi3ExitConfigurationMode", "there is no structural parameter");
}

namespace {
constexpr const char* no_clock = "there is no clock";
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
  return incapable(c, "fmi3GetIntervalDecimal", no_clock);
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3UInt64[], fmi3UInt64[],
                                   fmi3IntervalQualifier[]) {
  return incapable(c, "fmi3GetIntervalFraction", no_clock);
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3Float64[]) {
  return incapable(c, "fmi3GetShiftDecimal", no_clock);
}
fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3UInt64[], fmi3UInt64[]) {
  return incapable(c, "fmi3GetShiftFraction", no_clock);
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
  return incapable(c, "fmi3SetIntervalDecimal", no_clock);
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
  return incapable(c, "fmi3SetIntervalFraction", no_clock);
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
  return incapable(c, "fmi3SetShiftDecimal", no_clock);
}
fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
  return incapable(c, "fmi3SetShiftFraction", no_clock);
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference, fmi3Float64) {
  return incapable(c, "fmi3ActivateModelPartition", no_clock);
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
  return call(c, "fmi3EvaluateDiscreteStates", Mode::initialization | Mode::event, In::model_exchange,
              [](Instance3&) {});
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean* again, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* values_changed, fmi3Boolean* defined,
                                    fmi3Float64* next) {
  return call(c, "fmi3UpdateDiscreteStates", static_cast<unsigned>(Mode::event), In::model_exchange, [&](Instance3& i) {
    need(again != nullptr && terminate != nullptr && nominals_changed != nullptr && values_changed != nullptr &&
             defined != nullptr && next != nullptr,
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
  return call(c, "fmi3EnterContinuousTimeMode", static_cast<unsigned>(Mode::event), In::model_exchange,
              [](Instance3& i) { i.enter(Mode::continuous); });
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean /*noSetFMUStatePriorToCurrentPoint*/,
                                       fmi3Boolean* event, fmi3Boolean* terminate) {
  return call(c, "fmi3CompletedIntegratorStep", static_cast<unsigned>(Mode::continuous), In::model_exchange,
              [&](Instance3&) {
                need(event != nullptr && terminate != nullptr, "need places for both answers");
                *event = *terminate = false;
              });
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
  return call(c, "fmi3SetTime", Mode::event | Mode::continuous, In::model_exchange, [&](Instance3& i) {
    need(std::isfinite(time), "need a finite time");
    i.dynamics().set_time(time);
  });
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t nx) {
  return call(c, "fmi3SetContinuousStates", static_cast<unsigned>(Mode::continuous), In::model_exchange,
              [&](Instance3& i) {
                i.set_continuous({x, nx});
              });
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t nx) {
  return call(c, "fmi3GetContinuousStateDerivatives", evaluated, In::model_exchange,
              [&](Instance3& i) { i.give(i.dynamics().derivatives(), derivatives, nx); });
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t ni) {
  return call(c, "fmi3GetEventIndicators", evaluated, In::model_exchange,
              [&](Instance3& i) { i.give_indicators(indicators, ni); });
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t nx) {
  return call(c, "fmi3GetContinuousStates", evaluated, In::model_exchange,
              [&](Instance3& i) { i.give(i.dynamics().moving(), x, nx); });
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nx) {
  return call(c, "fmi3GetNominalsOfContinuousStates", evaluated, In::model_exchange,
              [&](Instance3& i) { i.give(std::vector<double>(i.variables().states, 1.0), nominals, nx); });
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t* count) {
  return call(c, "fmi3GetNumberOfEventIndicators", settled, In::model_exchange, [&](Instance3& i) {
    need(count != nullptr, "need a place for the count");
    *count = i.dynamics().indicators();
  });
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t* count) {
  return call(c, "fmi3GetNumberOfContinuousStates", settled, In::model_exchange, [&](Instance3& i) {
    need(count != nullptr, "need a place for the count");
    *count = i.variables().states;
  });
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
  return incapable(c, "fmi3EnterStepMode", "there is no event mode in co-simulation to leave");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Int32[],
                                    fmi3Float64[], size_t) {
  return incapable(c, "fmi3GetOutputDerivatives", "derivatives of outputs in time are not given");
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 length, fmi3Boolean /*noSetFMUStatePrior*/,
                      fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* last) {
  return status(guarded(c, "fmi3DoStep", {static_cast<unsigned>(Mode::step), In::co_simulation}, [&](Instance& base) {
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
