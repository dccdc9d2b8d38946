/// \file
/// An instance of an FMU for co-simulation, the same in both versions of the standard.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/bindings/fmu_load/archive.hpp"
#include "withy/bindings/fmu_load/description.hpp"

namespace withy::fmu_load {

/// Value references with the numbers of each.
struct Values {
  std::span<const std::uint32_t> references;
  std::span<const double> numbers;
};

/// Of one thread at a time. What fails throws FmuError with the call, its status and what the FMU said last; the
/// instance is then of no use.
class Instance {
 public:
  Instance() = default;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  virtual ~Instance() = default;

  /// Initializes it for a start at t [s].
  virtual void begin(double t, const Values& parameters, const Values& inputs) = 0;
  /// Sets the inputs, makes one step of h from t on [s], and reads the outputs.
  virtual void step(double t, double h, const Values& inputs, std::span<const std::uint32_t> outputs,
                    std::span<double> values) = 0;
  [[nodiscard]] virtual std::vector<unsigned char> save() = 0;
  virtual void restore(std::span<const unsigned char> bytes) = 0;
};

/// The library of an FMU, loaded from its archive until the last instance is gone.
class Program {
 public:
  /// \throws FmuError where it cannot be loaded.
  Program(std::unique_ptr<const Archive> archive, FmuDescription description);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  [[nodiscard]] const FmuDescription& description() const { return description_; }
  [[nodiscard]] std::string resources() const { return (archive_->folder() / "resources").string(); }
  [[nodiscard]] std::unique_ptr<Instance> instantiate() const;

  /// A function of the library. \throws FmuError where it has none of this name.
  template <class Function>
  [[nodiscard]] Function* function(const char* name) const {
    return reinterpret_cast<Function*>(symbol(name));
  }

 private:
  [[nodiscard]] void* symbol(const char* name) const;

  std::unique_ptr<const Archive> archive_;
  FmuDescription description_;
  void* handle_ = nullptr;
};

std::unique_ptr<Instance> make_instance2(const Program& program);
std::unique_ptr<Instance> make_instance3(const Program& program);

/// "fmi2DoStep: error, 'what it said'", for FmuError.
std::string failed_call(const char* function, int status, const std::string& heard);

}  // namespace withy::fmu_load
