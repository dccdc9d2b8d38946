#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmu_load/instance_of.hpp"

namespace withy::fmu_load {
namespace {

struct Version2 {
  using Status = fmi2Status;
  using Component = fmi2Component;
  using State = fmi2FMUstate;
  using Byte = fmi2Byte;
  static constexpr Status ok = fmi2OK, warning = fmi2Warning;
  static constexpr Named<decltype(fmi2FreeInstance)> free_instance{"fmi2FreeInstance"};
  static constexpr Named<decltype(fmi2GetFMUstate)> get_state{"fmi2GetFMUstate"};
  static constexpr Named<decltype(fmi2SetFMUstate)> set_state{"fmi2SetFMUstate"};
  static constexpr Named<decltype(fmi2FreeFMUstate)> free_state{"fmi2FreeFMUstate"};
  static constexpr Named<decltype(fmi2SerializedFMUstateSize)> size_of_state{"fmi2SerializedFMUstateSize"};
  static constexpr Named<decltype(fmi2SerializeFMUstate)> write_state{"fmi2SerializeFMUstate"};
  static constexpr Named<decltype(fmi2DeSerializeFMUstate)> read_state{"fmi2DeSerializeFMUstate"};
};

constexpr Named<decltype(fmi2Instantiate)> instantiate2{"fmi2Instantiate"};
constexpr Named<decltype(fmi2SetupExperiment)> set_up2{"fmi2SetupExperiment"};
constexpr Named<decltype(fmi2EnterInitializationMode)> enter2{"fmi2EnterInitializationMode"};
constexpr Named<decltype(fmi2ExitInitializationMode)> exit2{"fmi2ExitInitializationMode"};
constexpr Named<decltype(fmi2DoStep)> do_step2{"fmi2DoStep"};
constexpr Named<decltype(fmi2GetReal)> get2{"fmi2GetReal"};
constexpr Named<decltype(fmi2SetReal)> set2{"fmi2SetReal"};

void hear(fmi2ComponentEnvironment environment, fmi2String /*name*/, fmi2Status status, fmi2String /*category*/,
          fmi2String format, ...) {
  if (status == fmi2OK || environment == nullptr || format == nullptr) return;
  char text[1000] = {};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  *static_cast<std::string*>(environment) = text;
}

class Instance2 final : public InstanceOf<Version2> {
 public:
  explicit Instance2(const Program& program) : InstanceOf(program) {
    const std::string uri = "file://" + program.resources();
    take(function(instantiate2)(program.description().identifier.c_str(), fmi2CoSimulation,
                                program.description().token.c_str(), uri.c_str(), &callbacks_, fmi2False, fmi2False),
         instantiate2.name, fmi2Error);
  }
  Instance2(const Instance2&) = delete;
  Instance2& operator=(const Instance2&) = delete;
  ~Instance2() override { release(); }

  void begin(double t, const Values& parameters, const Values& inputs) override {
    call(set_up2, fmi2False, 0.0, t, fmi2False, 0.0);
    set(parameters);
    call(enter2);
    set(inputs);
    call(exit2);
  }
  void step(double t, double h, const Values& inputs, std::span<const std::uint32_t> outputs,
            std::span<double> values) override {
    set(inputs);
    call(do_step2, t, h, fmi2True);
    if (!outputs.empty()) call(get2, outputs.data(), outputs.size(), values.data());
  }

 private:
  void set(const Values& v) {
    if (!v.references.empty()) call(set2, v.references.data(), v.references.size(), v.numbers.data());
  }

  const fmi2CallbackFunctions callbacks_{&hear, &std::calloc, &std::free, nullptr, &heard_};
};

}  // namespace

std::unique_ptr<Instance> make_instance2(const Program& program) { return std::make_unique<Instance2>(program); }

}  // namespace withy::fmu_load
