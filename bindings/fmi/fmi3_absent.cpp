/// \file
/// Functions of FMI 3.0 for what these FMUs have not: variables that are no real numbers, arrays, structural
/// parameters, clocks, an event mode of co-simulation. The model description says so; a call is an error with that
/// sentence.
#include "withy/bindings/fmi/fmi3_call.hpp"

namespace {

using namespace withy::fmi;  // NOLINT(google-build-using-namespace): the interface to this very namespace
using In = Allowed::In;

constexpr const char* no_clock = "there is no clock";

fmi3Status incapable3(fmi3Instance c, const char* function, const char* why) {
  return call3(c, function, any_mode, In::both, [&](Instance3&) { throw std::invalid_argument(why); });
}

}  // namespace

#define WITHY_FMI3_NONE(T)                                                                                          \
  fmi3Status fmi3Get##T(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3##T /*v*/[], size_t) {       \
    return call3(c, "fmi3Get" #T, any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, #T); });              \
  }                                                                                                                 \
  fmi3Status fmi3Set##T(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3##T /*v*/[], size_t) { \
    return call3(c, "fmi3Set" #T, any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, #T); });              \
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
  return call3(c, "fmi3GetBinary", any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Binary"); });
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const size_t[], const fmi3Binary[],
                         size_t) {
  return call3(c, "fmi3SetBinary", any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Binary"); });
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, fmi3Clock[]) {
  return call3(c, "fmi3GetClock", any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Clock"); });
}
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t nvr, const fmi3Clock[]) {
  return call3(c, "fmi3SetClock", any_mode, In::both, [&](Instance3& i) { none_of(i, vr, nvr, "Clock"); });
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference, size_t*) {
  return incapable3(c, "fmi3GetNumberOfVariableDependencies", "no variable is an array");
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference, size_t[], fmi3ValueReference[], size_t[],
                                       fmi3DependencyKind[], size_t) {
  return incapable3(c, "fmi3GetVariableDependencies", "no variable is an array");
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
  return incapable3(c, "fmi3EnterConfigurationMode", "there is no structural parameter");
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
  return incapable3(c, "fmi3ExitConfigurationMode", "there is no structural parameter");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
  return incapable3(c, "fmi3GetIntervalDecimal", no_clock);
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3UInt64[], fmi3UInt64[],
                                   fmi3IntervalQualifier[]) {
  return incapable3(c, "fmi3GetIntervalFraction", no_clock);
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3Float64[]) {
  return incapable3(c, "fmi3GetShiftDecimal", no_clock);
}
fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference[], size_t, fmi3UInt64[], fmi3UInt64[]) {
  return incapable3(c, "fmi3GetShiftFraction", no_clock);
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
  return incapable3(c, "fmi3SetIntervalDecimal", no_clock);
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
  return incapable3(c, "fmi3SetIntervalFraction", no_clock);
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
  return incapable3(c, "fmi3SetShiftDecimal", no_clock);
}
fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
  return incapable3(c, "fmi3SetShiftFraction", no_clock);
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference, fmi3Float64) {
  return incapable3(c, "fmi3ActivateModelPartition", no_clock);
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
  return incapable3(c, "fmi3EnterStepMode", "there is no event mode in co-simulation to leave");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference[], size_t, const fmi3Int32[],
                                    fmi3Float64[], size_t) {
  return incapable3(c, "fmi3GetOutputDerivatives", "derivatives of outputs in time are not given");
}
