#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmu_load/instance.hpp"

namespace withy::fmu_load {
namespace {

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

class Instance2 final : public Instance {
 public:
  explicit Instance2(const Program& program) : program_(program) {
    const auto instantiate = program.function<decltype(fmi2Instantiate)>("fmi2Instantiate");
    const std::string uri = "file://" + program.resources();
    c_ = instantiate(program.description().identifier.c_str(), fmi2CoSimulation, program.description().token.c_str(),
                     uri.c_str(), &callbacks_, fmi2False, fmi2False);
    if (c_ == nullptr) throw FmuError(failed_call("fmi2Instantiate", fmi2Error, heard_));
  }
  ~Instance2() override { program_.function<decltype(fmi2FreeInstance)>("fmi2FreeInstance")(c_); }

  void begin(double t, const Values& parameters, const Values& inputs) override {
    call<decltype(fmi2SetupExperiment)>("fmi2SetupExperiment", fmi2False, 0.0, t, fmi2False, 0.0);
    set(parameters);
    call<decltype(fmi2EnterInitializationMode)>("fmi2EnterInitializationMode");
    set(inputs);
    call<decltype(fmi2ExitInitializationMode)>("fmi2ExitInitializationMode");
  }
  void step(double t, double h, const Values& inputs, std::span<const std::uint32_t> outputs,
            std::span<double> values) override {
    set(inputs);
    call<decltype(fmi2DoStep)>("fmi2DoStep", t, h, fmi2True);
    if (!outputs.empty()) call<decltype(fmi2GetReal)>("fmi2GetReal", outputs.data(), outputs.size(), values.data());
  }
  std::vector<unsigned char> save() override {
    State state(*this);
    call<decltype(fmi2GetFMUstate)>("fmi2GetFMUstate", &state.kept);
    std::size_t size = 0;
    call<decltype(fmi2SerializedFMUstateSize)>("fmi2SerializedFMUstateSize", state.kept, &size);
    std::vector<unsigned char> bytes(size);
    call<decltype(fmi2SerializeFMUstate)>("fmi2SerializeFMUstate", state.kept,
                                          reinterpret_cast<fmi2Byte*>(bytes.data()), size);
    return bytes;
  }
  void restore(std::span<const unsigned char> bytes) override {
    State state(*this);
    call<decltype(fmi2DeSerializeFMUstate)>("fmi2DeSerializeFMUstate", reinterpret_cast<const fmi2Byte*>(bytes.data()),
                                            bytes.size(), &state.kept);
    call<decltype(fmi2SetFMUstate)>("fmi2SetFMUstate", state.kept);
  }

 private:
  /// A state that the FMU has given, until the end of a call.
  struct State {
    explicit State(Instance2& of) : owner(of) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      if (kept != nullptr) owner.program_.function<decltype(fmi2FreeFMUstate)>("fmi2FreeFMUstate")(owner.c_, &kept);
    }
    Instance2& owner;
    fmi2FMUstate kept = nullptr;
  };

  template <class Function, class... Arguments>
  void call(const char* name, Arguments... arguments) {
    heard_.clear();
    const fmi2Status status = program_.function<Function>(name)(c_, arguments...);
    if (status != fmi2OK && status != fmi2Warning) throw FmuError(failed_call(name, status, heard_));
  }
  void set(const Values& v) {
    if (!v.references.empty())
      call<decltype(fmi2SetReal)>("fmi2SetReal", v.references.data(), v.references.size(), v.numbers.data());
  }

  const Program& program_;
  std::string heard_;
  const fmi2CallbackFunctions callbacks_{&hear, &std::calloc, &std::free, nullptr, &heard_};
  fmi2Component c_ = nullptr;
};

}  // namespace

std::unique_ptr<Instance> make_instance2(const Program& program) { return std::make_unique<Instance2>(program); }

}  // namespace withy::fmu_load
