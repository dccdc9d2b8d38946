/// \file
/// FMI 2.0 on instances.
#include "withy/bindings/fmi/fmi2.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/bindings/fmi/guarded.hpp"
#include "withy/bindings/fmi/resources.hpp"

namespace {

using namespace withy::fmi;  // NOLINT(google-build-using-namespace): the interface to this very namespace
using In = Allowed::In;

/// An instance, and what the version keeps beside it.
class Component : public Instance {
 public:
  using Instance::Instance;
  StepEnd last = {};  ///< of the last step
};

static_assert(fmi2OK == static_cast<int>(Status::ok) && fmi2Fatal == static_cast<int>(Status::fatal));
fmi2Status status(Status s) { return static_cast<fmi2Status>(s); }

constexpr unsigned running = Mode::initialization | Mode::event | Mode::continuous | Mode::step | Mode::terminated;
constexpr unsigned any = running | Mode::instantiated;

template <class Act>
fmi2Status call(fmi2Component c, const char* function, unsigned modes, In kinds, Act&& act) {
  return status(guarded(c, function, {modes, kinds}, [&](Instance& i) {
    act(static_cast<Component&>(i));
    return Status::ok;
  }));
}

Log log_of(const char* name, const fmi2CallbackFunctions& functions, bool on) {
  Log log;
  log.on = on;
  if (functions.logger != nullptr)
    log.write = [logger = functions.logger, environment = functions.componentEnvironment, name = std::string(name)](
                    Status s, const char* category, const char* message) {
      logger(environment, name.c_str(), status(s), category, "%s", message);
    };
  return log;
}

/// For functions of which the model description says that they cannot be.
fmi2Status incapable(fmi2Component c, const char* function, const char* why) {
  return call(c, function, any, In::both, [&](Component&) { throw std::invalid_argument(why); });
}

}  // namespace

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/, fmi2Boolean on) {
  if (functions == nullptr) return nullptr;
  Log log;
  return made(log, "fmi2Instantiate", [&]() -> Instance* {
    log = log_of(name == nullptr ? "" : name, *functions, on != fmi2False);
    need(name != nullptr && *name != '\0', "need a name of the instance");
    need(guid != nullptr && resources != nullptr, "need the GUID and the location of the resources");
    need(type == fmi2ModelExchange || type == fmi2CoSimulation, "need model exchange or co-simulation");
    return new Component(type == fmi2ModelExchange ? Kind::model_exchange : Kind::co_simulation, name, guid,
                         folder_of(resources), log);
  });
}

void fmi2FreeInstance(fmi2Component c) { delete static_cast<Component*>(instance_of(c)); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  return call(c, "fmi2SetDebugLogging", any, In::both,
              [&](Component& i) { set_logging(i, on != fmi2False, count, categories); });
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerated, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stops, fmi2Real stop) {
  return call(c, "fmi2SetupExperiment", static_cast<unsigned>(Mode::instantiated), In::both, [&](Component& i) {
    i.set_experiment(tolerated != fmi2False ? std::optional(tolerance) : std::nullopt, start,
                     stops != fmi2False ? std::optional(stop) : std::nullopt);
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return call(c, "fmi2EnterInitializationMode", static_cast<unsigned>(Mode::instantiated), In::both,
              [](Component& i) { i.enter_initialization(); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return call(c, "fmi2ExitInitializationMode", static_cast<unsigned>(Mode::initialization), In::both,
              [](Component& i) { i.exit_initialization(); });
}

fmi2Status fmi2Terminate(fmi2Component c) {
  return call(c, "fmi2Terminate", Mode::event | Mode::continuous | Mode::step, In::both,
              [](Component& i) { i.enter(Mode::terminated); });
}

fmi2Status fmi2Reset(fmi2Component c) {
  return call(c, "fmi2Reset", any, In::both, [](Component& i) {
    i.reset();
    i.last = {};
  });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real values[]) {
  return call(c, "fmi2GetReal", running, In::both, [&](Component& i) {
    need(nvr == 0 || values != nullptr, "need an array of values");
    i.get(references(vr, nvr), values);
  });
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real values[]) {
  return call(c, "fmi2SetReal", any, In::both, [&](Component& i) {
    need(nvr == 0 || values != nullptr, "need an array of values");
    i.set(references(vr, nvr), values);
  });
}

#define WITHY_FMI2_NONE(T)                                                                                   \
  fmi2Status fmi2Get##T(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##T /*values*/[]) {  \
    return call(c, "fmi2Get" #T, any, In::both, [&](Component& i) { none_of(i, vr, nvr, #T); });             \
  }                                                                                                          \
  fmi2Status fmi2Set##T(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##T /*v*/[]) { \
    return call(c, "fmi2Set" #T, any, In::both, [&](Component& i) { none_of(i, vr, nvr, #T); });             \
  }
WITHY_FMI2_NONE(Integer)
WITHY_FMI2_NONE(Boolean)
WITHY_FMI2_NONE(String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return call(c, "fmi2GetFMUstate", any, In::both, [&](Component& i) { save_at(i, state); });
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return call(c, "fmi2SetFMUstate", any, In::both, [&](Component& i) {
    i.restore(static_cast<const SavedState*>(state));
    i.last = {};
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return call(c, "fmi2FreeFMUstate", any, In::both, [&](Component& i) { forget_at(i, state); });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  return call(c, "fmi2SerializedFMUstateSize", any, In::both, [&](Component& i) {
    need(size != nullptr, "need a place for the size");
    *size = i.serialize(static_cast<const SavedState*>(state)).size();
  });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return call(c, "fmi2SerializeFMUstate", any, In::both,
              [&](Component& i) { write_bytes(i, state, bytes, size, "fmi2SerializedFMUstateSize"); });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return call(c, "fmi2DeSerializeFMUstate", any, In::both, [&](Component& i) {
    need(bytes != nullptr && state != nullptr, "need the bytes and a place for the state");
    *state = i.deserialize({reinterpret_cast<const unsigned char*>(bytes), size});
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
  return call(c, "fmi2GetDirectionalDerivative", running, In::both, [&](Component& i) {
    need((knowns == 0 || dvKnown != nullptr) && (unknowns == 0 || dvUnknown != nullptr), "need two arrays of numbers");
    i.directional(references(unknown, unknowns), references(known, knowns), dvKnown, dvUnknown);
  });
}

fmi2Status fmi2EnterEventMode(fmi2Component c) {
  return call(c, "fmi2EnterEventMode", static_cast<unsigned>(Mode::continuous), In::model_exchange, [](Component& i) {
    i.check_stop(i.dynamics().time());
    i.enter(Mode::event);
  });
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) {
  return call(c, "fmi2NewDiscreteStates", static_cast<unsigned>(Mode::event), In::model_exchange, [&](Component& i) {
    need(info != nullptr, "need a place for the event information");
    const EventUpdate update = i.dynamics().update_discrete();
    info->newDiscreteStatesNeeded = update.again;
    info->terminateSimulation = update.terminate;
    info->nominalsOfContinuousStatesChanged = info->valuesOfContinuousStatesChanged = fmi2False;
    info->nextEventTimeDefined = std::isfinite(update.next);
    info->nextEventTime = update.next;
  });
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  return call(c, "fmi2EnterContinuousTimeMode", static_cast<unsigned>(Mode::event), In::model_exchange,
              [](Component& i) { i.enter(Mode::continuous); });
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean /*noSetFMUStatePriorToCurrentPoint*/,
                                       fmi2Boolean* event, fmi2Boolean* terminate) {
  return call(c, "fmi2CompletedIntegratorStep", static_cast<unsigned>(Mode::continuous), In::model_exchange,
              [&](Component& i) {
                need(event != nullptr && terminate != nullptr, "need places for both answers");
                i.check_stop(i.dynamics().time());
                *event = *terminate = fmi2False;
              });
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  return call(c, "fmi2SetTime", Mode::event | Mode::continuous, In::model_exchange, [&](Component& i) {
    need(std::isfinite(time), "need a finite time");
    if (i.is_in(static_cast<unsigned>(Mode::event))) i.check_stop(time);  // integrators may look beyond
    i.dynamics().set_time(time);
  });
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
  return call(c, "fmi2SetContinuousStates", static_cast<unsigned>(Mode::continuous), In::model_exchange,
              [&](Component& i) {
                i.set_continuous({x, nx});
              });
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx) {
  return call(c, "fmi2GetDerivatives", running, In::model_exchange,
              [&](Component& i) { i.give(i.dynamics().derivatives(), derivatives, nx); });
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t ni) {
  return call(c, "fmi2GetEventIndicators", running, In::model_exchange,
              [&](Component& i) { i.give_indicators(indicators, ni); });
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx) {
  return call(c, "fmi2GetContinuousStates", running, In::model_exchange,
              [&](Component& i) { i.give(i.dynamics().moving(), x, nx); });
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t nx) {
  return call(c, "fmi2GetNominalsOfContinuousStates", any, In::model_exchange,
              [&](Component& i) { i.give(std::vector<double>(i.variables().states, 1.0), nominals, nx); });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                       const fmi2Real[]) {
  return incapable(c, "fmi2SetRealInputDerivatives", "inputs are not interpolated by their derivatives");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                        fmi2Real[]) {
  return incapable(c, "fmi2GetRealOutputDerivatives", "derivatives of outputs in time are not given");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean /*noSetFMUStatePrior*/) {
  return status(guarded(c, "fmi2DoStep", {static_cast<unsigned>(Mode::step), In::co_simulation}, [&](Instance& i) {
    StepEnd& last = static_cast<Component&>(i).last;
    last = i.step(from, length, {});
    if (last.reached && !last.terminate) return Status::ok;
    i.say(Status::discard, log_discards, "fmi2DoStep: " + last.reason);
    return Status::discard;
  }));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
  return incapable(c, "fmi2CancelStep", "no step is in progress: steps end before fmi2DoStep returns");
}

fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind /*kind*/, fmi2Status* /*value*/) {
  return incapable(c, "fmi2GetStatus", "no step is in progress: steps end before fmi2DoStep returns");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  return call(c, "fmi2GetRealStatus", Mode::step | Mode::terminated, In::co_simulation, [&](Component& i) {
    need(kind == fmi2LastSuccessfulTime && value != nullptr, "of real numbers there is fmi2LastSuccessfulTime");
    *value = i.dynamics().time();
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind /*kind*/, fmi2Integer* /*value*/) {
  return incapable(c, "fmi2GetIntegerStatus", "there is no status of this type");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  return call(c, "fmi2GetBooleanStatus", Mode::step | Mode::terminated, In::co_simulation, [&](Component& i) {
    need(kind == fmi2Terminated && value != nullptr, "of truth values there is fmi2Terminated");
    *value = i.last.terminate;
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind /*kind*/, fmi2String* /*value*/) {
  return incapable(c, "fmi2GetStringStatus", "no step is in progress: steps end before fmi2DoStep returns");
}
