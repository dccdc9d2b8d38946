#include "withy/bindings/fmi/fmi3.h"
#include "withy/bindings/fmu_load/instance_of.hpp"

namespace withy::fmu_load {
namespace {

struct Version3 {
  using Status = fmi3Status;
  using Component = fmi3Instance;
  using State = fmi3FMUState;
  using Byte = fmi3Byte;
  static constexpr Status ok = fmi3OK, warning = fmi3Warning;
  static constexpr Named<decltype(fmi3FreeInstance)> free_instance{"fmi3FreeInstance"};
  static constexpr Named<decltype(fmi3GetFMUState)> get_state{"fmi3GetFMUState"};
  static constexpr Named<decltype(fmi3SetFMUState)> set_state{"fmi3SetFMUState"};
  static constexpr Named<decltype(fmi3FreeFMUState)> free_state{"fmi3FreeFMUState"};
  static constexpr Named<decltype(fmi3SerializedFMUStateSize)> size_of_state{"fmi3SerializedFMUStateSize"};
  static constexpr Named<decltype(fmi3SerializeFMUState)> write_state{"fmi3SerializeFMUState"};
  static constexpr Named<decltype(fmi3DeserializeFMUState)> read_state{"fmi3DeserializeFMUState"};
};

constexpr Named<decltype(fmi3InstantiateCoSimulation)> instantiate3{"fmi3InstantiateCoSimulation"};
constexpr Named<decltype(fmi3EnterInitializationMode)> enter3{"fmi3EnterInitializationMode"};
constexpr Named<decltype(fmi3ExitInitializationMode)> exit3{"fmi3ExitInitializationMode"};
constexpr Named<decltype(fmi3DoStep)> do_step3{"fmi3DoStep"};
constexpr Named<decltype(fmi3GetFloat64)> get3{"fmi3GetFloat64"};
constexpr Named<decltype(fmi3SetFloat64)> set3{"fmi3SetFloat64"};

void hear3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String /*category*/, fmi3String message) {
  if (status != fmi3OK && environment != nullptr && message != nullptr)
    *static_cast<std::string*>(environment) = message;
}

class Instance3 final : public InstanceOf<Version3> {
 public:
  explicit Instance3(const Program& program) : InstanceOf(program) {
    const std::string path = program.resources() + '/';
    take(function(instantiate3)(program.description().identifier.c_str(), program.description().token.c_str(),
                                path.c_str(), false, false, false, false, nullptr, 0, &heard_, &hear3, nullptr),
         instantiate3.name, fmi3Error);
  }
  Instance3(const Instance3&) = delete;
  Instance3& operator=(const Instance3&) = delete;
  ~Instance3() override { release(); }

  void begin(double t, const Values& parameters, const Values& inputs) override {
    set(parameters);
    call(enter3, false, 0.0, t, false, 0.0);
    set(inputs);
    call(exit3);
  }
  void step(double t, double h, const Values& inputs, std::span<const std::uint32_t> outputs,
            std::span<double> values) override {
    set(inputs);
    bool event = false, terminate = false, early = false;
    double reached = t + h;
    call(do_step3, t, h, true, &event, &terminate, &early, &reached);
    if (terminate) throw FmuError("asks for the end of the simulation" + (heard_.empty() ? heard_ : ": " + heard_));
    if (early) throw FmuError("fmi3DoStep returns before the end of the step, which it was not allowed to");
    if (!outputs.empty()) call(get3, outputs.data(), outputs.size(), values.data(), values.size());
  }

 private:
  void set(const Values& v) {
    if (!v.references.empty()) call(set3, v.references.data(), v.references.size(), v.numbers.data(), v.numbers.size());
  }
};

}  // namespace

std::unique_ptr<Instance> make_instance3(const Program& program) { return std::make_unique<Instance3>(program); }

}  // namespace withy::fmu_load
