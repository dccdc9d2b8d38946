#include "withy/bindings/fmi/fmi3.h"
#include "withy/bindings/fmu_load/instance.hpp"

namespace withy::fmu_load {
namespace {

void hear3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String /*category*/, fmi3String message) {
  if (status != fmi3OK && environment != nullptr && message != nullptr)
    *static_cast<std::string*>(environment) = message;
}

class Instance3 final : public Instance {
 public:
  explicit Instance3(const Program& program) : program_(program) {
    const auto instantiate = program.function<decltype(fmi3InstantiateCoSimulation)>("fmi3InstantiateCoSimulation");
    const std::string path = program.resources() + '/';
    c_ = instantiate(program.description().identifier.c_str(), program.description().token.c_str(), path.c_str(), false,
                     false, false, false, nullptr, 0, &heard_, &hear3, nullptr);
    if (c_ == nullptr) throw FmuError(failed_call("fmi3InstantiateCoSimulation", fmi3Error, heard_));
  }
  ~Instance3() override { program_.function<decltype(fmi3FreeInstance)>("fmi3FreeInstance")(c_); }

  void begin(double t, const Values& parameters, const Values& inputs) override {
    set(parameters);
    call<decltype(fmi3EnterInitializationMode)>("fmi3EnterInitializationMode", false, 0.0, t, false, 0.0);
    set(inputs);
    call<decltype(fmi3ExitInitializationMode)>("fmi3ExitInitializationMode");
  }
  void step(double t, double h, const Values& inputs, std::span<const std::uint32_t> outputs,
            std::span<double> values) override {
    set(inputs);
    bool event = false, terminate = false, early = false;
    double reached = t + h;
    call<decltype(fmi3DoStep)>("fmi3DoStep", t, h, true, &event, &terminate, &early, &reached);
    if (terminate) throw FmuError("asks for the end of the simulation" + (heard_.empty() ? heard_ : ": " + heard_));
    if (early) throw FmuError("fmi3DoStep returns before the end of the step, which it was not allowed to");
    if (!outputs.empty())
      call<decltype(fmi3GetFloat64)>("fmi3GetFloat64", outputs.data(), outputs.size(), values.data(), values.size());
  }
  std::vector<unsigned char> save() override {
    State state(*this);
    call<decltype(fmi3GetFMUState)>("fmi3GetFMUState", &state.kept);
    std::size_t size = 0;
    call<decltype(fmi3SerializedFMUStateSize)>("fmi3SerializedFMUStateSize", state.kept, &size);
    std::vector<unsigned char> bytes(size);
    call<decltype(fmi3SerializeFMUState)>("fmi3SerializeFMUState", state.kept, bytes.data(), size);
    return bytes;
  }
  void restore(std::span<const unsigned char> bytes) override {
    State state(*this);
    call<decltype(fmi3DeserializeFMUState)>("fmi3DeserializeFMUState", bytes.data(), bytes.size(), &state.kept);
    call<decltype(fmi3SetFMUState)>("fmi3SetFMUState", state.kept);
  }

 private:
  /// A state that the FMU has given, until the end of a call.
  struct State {
    explicit State(Instance3& of) : owner(of) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      if (kept != nullptr) owner.program_.function<decltype(fmi3FreeFMUState)>("fmi3FreeFMUState")(owner.c_, &kept);
    }
    Instance3& owner;
    fmi3FMUState kept = nullptr;
  };

  template <class Function, class... Arguments>
  void call(const char* name, Arguments... arguments) {
    heard_.clear();
    const fmi3Status status = program_.function<Function>(name)(c_, arguments...);
    if (status != fmi3OK && status != fmi3Warning) throw FmuError(failed_call(name, status, heard_));
  }
  void set(const Values& v) {
    if (!v.references.empty())
      call<decltype(fmi3SetFloat64)>("fmi3SetFloat64", v.references.data(), v.references.size(), v.numbers.data(),
                                     v.numbers.size());
  }

  const Program& program_;
  std::string heard_;
  fmi3Instance c_ = nullptr;
};

}  // namespace

std::unique_ptr<Instance> make_instance3(const Program& program) { return std::make_unique<Instance3>(program); }

}  // namespace withy::fmu_load
